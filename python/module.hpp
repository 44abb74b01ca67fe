#pragma once

#include <pybind11/pybind11.h>

namespace slipmode::python {

// Each adds its part to the module.
void add_errors(pybind11::module_& module);
void add_scene(pybind11::module_& module);
void add_result(pybind11::module_& module);
void add_motions(pybind11::module_& module);    ///< runs, modes, bases, reduced models, their comparison
void add_orbits(pybind11::module_& module);     ///< periodic orbits and branches
void add_sweeps(pybind11::module_& module);     ///< over keys and over starts
void add_trades(pybind11::module_& module);     ///< speed against accuracy, what a scene requires
void add_figures(pybind11::module_& module);    ///< what figures of a result show
void add_diagnoses(pybind11::module_& module);  ///< exponents, the whole pipeline

}  // namespace slipmode::python
