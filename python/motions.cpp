#include <slipmode/diagnostics/model.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/ensemble.hpp>
#include <slipmode/studies/natural_modes.hpp>
#include <slipmode/studies/reduction.hpp>
#include <slipmode/studies/simulation.hpp>
#include <slipmode/studies/validation.hpp>
#include "python/call.hpp"
#include "python/errors.hpp"
#include "python/model.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <pybind11/eigen.h>

#include <optional>
#include <utility>
#include <variant>

namespace slipmode::python {
namespace {

using scene::Scene;

Result simulate(const Scene& scene, const py::kwargs& given) {
  Keywords keywords("simulate", given);
  const ModelChoice choice(keywords);
  Call call(keywords);
  auto [failure, result] = call([&] {
    const studies::Family model(scene, {}, choice.basis(scene, call.options()));
    const auto run = std::make_shared<const studies::Simulation>(studies::simulate(model, call.options()));
    return std::pair(run->failure, Result::unread(studies::content_of(scene, run, choice.word())));
  });
  if (failure) raise(*failure, py::cast(std::move(result)));
  return std::move(result);
}

Result ensemble(const Scene& scene, const py::kwargs& given) {
  Keywords keywords("ensemble", given);
  Call call(keywords);
  return call([&] {
    return Result(studies::content_of(
        scene, std::make_shared<const diagnostics::EnsembleRun>(studies::ensemble(scene, call.options()))));
  });
}

Result modes(const Scene& scene, Eigen::Index count) {
  const py::gil_scoped_release unlocked;
  const auto sets =
      std::make_shared<const studies::ModeSets>(studies::natural_modes(scene, scene::build_system(scene), count));
  return Result(studies::content_of(scene, sets));
}

Result pod(const Result& motion, Eigen::Index modes) {
  const results::StoreReader reader = motion.reader();
  const py::gil_scoped_release unlocked;
  return Result(
      studies::content_of(std::make_shared<const studies::MotionModes>(studies::motion_modes(reader, modes))));
}

/// Vectors are taken about where a belt holds the structure, as natural modes are.
Result reduce(const Scene& scene, const std::variant<std::string, const Result*, Eigen::MatrixXd>& basis,
              Eigen::Index modes) {
  std::optional<results::StoreReader> reader;
  if (const auto* result = std::get_if<const Result*>(&basis)) reader.emplace((*result)->store());
  const py::gil_scoped_release unlocked;
  const dynamics::HybridSystem full = scene::build_system(scene);
  pod::NamedBasis source;
  std::string name = "array";
  if (reader) {
    name = reader->path().string();
    source = studies::load_basis(scene, full, *reader);
  } else if (const auto* vectors = std::get_if<Eigen::MatrixXd>(&basis)) {
    source = {.name = "user",
              .basis = {.vectors = *vectors,
                        .mean = diagnostics::resting_place(full),
                        .energy = {},
                        .provenance = "an array, about the sliding equilibrium"}};
    if (modes == 0) modes = vectors->cols();
  } else {
    name = std::get<std::string>(basis);
    source = studies::load_basis(scene, full, name);
  }
  return Result(studies::content_of(
      scene, std::make_shared<const studies::Reduction>(studies::reduce(scene, full, source, name, modes))));
}

Result validate(const Scene& scene, const Result& basis, const py::kwargs& given) {
  Keywords keywords("validate", given);
  studies::ValidationRequest request;
  keywords.read(request);
  const std::string output = keywords.output();
  Call call(keywords);
  const results::StoreReader reader = basis.reader();
  return call([&] { return Result(studies::validate(scene, reader, request, output, call.options()).content); });
}

}  // namespace

void add_motions(py::module_& module) {
  module.def("simulate", &simulate, py::arg("scene"),
             ("One run, from [initial] as [time] says; of a reduced model lifted to all degrees of freedom.\n\n" +
              model_text() + call_text())
                 .c_str());
  module.def("ensemble", &ensemble, py::arg("scene"), ("The runs that [ensemble] asks for.\n\n" + call_text()).c_str());
  module.def("modes", &modes, py::arg("scene"), py::arg("count") = 0,
             "Natural modes, contacts slipping, sticking and held by their springs.\n\n"
             "    count: modes of each set at most; 0: the lowest 20\n");
  module.def("pod", &pod, py::arg("motion"), py::arg("modes") = 0,
             "Proper orthogonal modes of a run or an ensemble.\n\n    modes: kept; 0: all there are\n");
  module.def(
      "reduce", &reduce, py::arg("scene"), py::arg("basis"), py::arg("modes") = 0,
      "A scene's model projected on a basis.\n\n"
      "    basis: of `pod` or of a reduced model; the word \"lnm\", under a shaker also \"lnm+static\"; or an array,\n"
      "           dof x mode, taken about where a belt holds the structure\n"
      "    modes: how many; 0: as [reduction] says, of an array all\n");
  module.def("validate", &validate, py::arg("scene"), py::arg("basis"),
             ("Reduced models on a basis compared with the full one, as [validation] says.\n\n"
              "    basis: of `pod`, of a reduced model, or a motion\n"
              "    output (str): result file; an interrupted call goes on from there\n" +
              options_text<studies::ValidationRequest>() + call_text())
                 .c_str());
}

}  // namespace slipmode::python
