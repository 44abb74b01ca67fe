#include "python/module.hpp"

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/results/provenance.hpp>

PYBIND11_MODULE(_slipmode, module) {
  module.doc() = "slipmode's studies for Python; see the package slipmode";
  module.attr("__version__") = slipmode::results::version();
  module.attr("git_commit") = slipmode::results::git_commit();
  module.attr("compiler") = slipmode::results::compiler();
  module.attr("kernels") = slipmode::kernels::kernels().name;
  slipmode::python::add_errors(module);
  slipmode::python::add_scene(module);
  slipmode::python::add_result(module);
  slipmode::python::add_motions(module);
  slipmode::python::add_orbits(module);
  slipmode::python::add_sweeps(module);
  slipmode::python::add_trades(module);
  slipmode::python::add_diagnoses(module);
  slipmode::python::add_figures(module);
}
