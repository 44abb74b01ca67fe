#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/exponents.hpp>
#include <slipmode/studies/pipeline.hpp>
#include "python/call.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace slipmode::python {
namespace {

using scene::Scene;

Result exponents(const Scene& scene, const py::args& bases, const py::kwargs& given) {
  Keywords keywords("exponents", given);
  struct Own {
    bool verdict = false;
    Eigen::Index modes = 0;
    static constexpr auto fields() {
      return std::tuple{optional("verdict", &Own::verdict, "", ""), optional("modes", &Own::modes, "", "", kCount)};
    }
  } own;
  studies::ExponentRequest request;
  keywords.read(own);
  keywords.read(request);
  std::vector<results::StoreReader> stores;
  for (const py::handle basis : bases) {
    if (!py::isinstance<Result>(basis)) keywords.refuse("models", basis, "results of pod, ensemble or reduce");
    stores.push_back(basis.cast<const Result&>().reader());
  }
  Call call(keywords);
  return call([&] {
    const Scene timed = scene::with_own_times(scene);
    const studies::Subjects subjects = studies::subjects_of(timed, stores, own.modes);
    return Result(studies::content_of(timed, std::make_shared<const studies::ModelDiagnosis>(studies::diagnose_models(
                                                 timed, subjects, request, own.verdict, call.options()))));
  });
}

std::vector<std::string> run(const Scene& scene, const std::filesystem::path& folder, const py::kwargs& given) {
  Keywords keywords("run", given);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) keywords.refuse("folder", py::cast(folder), "a folder that can be made: " + error.message());
  Call call(keywords);
  return call([&] {
    const studies::PipelineResult done = studies::pipeline(scene, folder, call.options());
    std::vector<std::string> names = done.files;
    names.insert(names.end(), done.figures.begin(), done.figures.end());
    return names;
  });
}

}  // namespace

void add_diagnoses(py::module_& module) {
  module.def("exponents", &exponents, py::arg("scene"),
             ("Lyapunov exponents of the full model, and of reduced models beside it (results of `pod`, `ensemble` or\n"
              "`reduce`).\n\n"
              "    modes: of the bases given; by default as [reduction] chooses\n"
              "    verdict: dimensions, delay, embedding, spectrum and stick side by side too\n" +
              options_text<studies::ExponentRequest>() + call_text())
                 .c_str());
  module.def(
      "run", &run, py::arg("scene"), py::arg("folder"),
      ("The whole pipeline, from the scene to files and figures in a folder, whose names it gives. An interrupted\n"
       "call goes on from there.\n\n" +
       call_text())
          .c_str());
}

}  // namespace slipmode::python
