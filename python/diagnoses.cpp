#include <slipmode/results/series_store.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/exponent_sweep.hpp>
#include <slipmode/studies/exponents.hpp>
#include <slipmode/studies/pipeline.hpp>
#include "python/call.hpp"
#include "python/module.hpp"
#include "python/result.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace slipmode::python {
namespace {

using scene::Scene;

/// What is asked of the reduced models, and of all.
struct Beside {
  Eigen::Index modes = 0;
  bool verdict = false;
  static constexpr auto fields() {
    return std::tuple{
        optional("modes", &Beside::modes, "", "of the bases given; 0: as [reduction] chooses", kFromZero),
        optional("verdict", &Beside::verdict, "", "dimensions, delay, embedding, spectrum and stick side by side too")};
  }
};

std::vector<results::StoreReader> readers_of(const Keywords& keywords, const py::args& bases) {
  std::vector<results::StoreReader> stores;
  for (const py::handle basis : bases) {
    if (!py::isinstance<Result>(basis)) keywords.refuse("models", basis, "results of pod, ensemble or reduce");
    stores.push_back(basis.cast<const Result&>().reader());
  }
  return stores;
}

Result exponents(const Scene& scene, const py::args& bases, const py::kwargs& given) {
  Keywords keywords("exponents", given);
  Beside own;
  studies::ExponentRequest request;
  keywords.read(own);
  keywords.read(request);
  const std::vector<results::StoreReader> stores = readers_of(keywords, bases);
  Call call(keywords);
  return call([&] {
    const Scene timed = scene::with_own_times(scene);
    const studies::Subjects subjects = studies::subjects_of(timed, stores, own.modes);
    return Result(studies::content_of(timed, std::make_shared<const studies::ModelDiagnosis>(studies::diagnose_models(
                                                 timed, subjects, request, own.verdict, call.options()))));
  });
}

/// How values of a key follow each other, and the modes of what stands beside the full model there.
struct AlongKey {
  Eigen::Index modes = 0;
  bool follow = false;
  static constexpr auto fields() {
    return std::tuple{
        optional("modes", &AlongKey::modes, "", "of the basis given; 0: as [reduction] chooses", kFromZero),
        optional("follow", &AlongKey::follow, "", "start each value where the one before it ended")};
  }
};

Result exponent_sweep(const Scene& scene, const std::string& over, const std::vector<double>& values,
                      const py::args& bases, const py::kwargs& given) {
  Keywords keywords("exponent_sweep", given);
  AlongKey own;
  studies::ExponentRequest request;
  keywords.read(own);
  keywords.read(request);
  const std::string output = keywords.output();
  const std::vector<results::StoreReader> stores = readers_of(keywords, bases);
  Call call(keywords);
  return call([&] {
    const Scene timed = scene::with_own_times(scene);
    const studies::Over key{over, values};
    const auto models = studies::swept_models(timed, key, stores, own.modes);
    studies::ExponentSweepOptions options =
        studies::exponent_sweep_options(timed, models, request, own.follow, call.options());
    studies::ResultFile file(output, timed, results::FileKind::kExponentSweep,
                             studies::command_of(key, models, options), studies::identity_of(models));
    options.journal = file.journal();
    auto done = std::make_shared<const std::vector<studies::ExponentSweep>>(
        studies::exponent_sweeps(models, values, options, call.options()));
    return Result(file.finish([models, done](results::StoreWriter& writer) { studies::store(writer, models, *done); }));
  });
}

/// A record in memory, in a file, or the samples themselves.
results::SeriesInput record_of(const Keywords& keywords, const py::object& record, const std::string& series,
                               const results::SeriesRequest& request) {
  if (py::isinstance<Result>(record)) return read_series(record.cast<const Result&>().reader(), series, request);
  if (py::isinstance<py::str>(record))
    return results::read_series(record.cast<std::string>() + (series.empty() ? "" : ":" + series), request);
  py::detail::make_caster<Eigen::VectorXd> samples;
  if (!samples.load(record, true)) keywords.refuse("record", record, "a result, a file's path, or an array of samples");
  return results::series_of(static_cast<Eigen::VectorXd&>(samples), series.empty() ? "record" : series, request);
}

Result diagnose(const py::object& record, const py::kwargs& given) {
  Keywords keywords("diagnose", given);
  const std::string series = keywords.text("series"), unit = keywords.text("unit", "bits");
  if (unit != "bits" && unit != "nats") keywords.refuse("unit", py::str(unit), "\"bits\" or \"nats\"");
  results::SeriesRequest request;
  request.time = keywords.text("time");
  keywords.read(request);
  diagnostics::StudyOptions study;
  keywords.read(study);
  if (const py::object tools = keywords.take("tools"))
    study.tools = diagnostics::series_tools(tools.cast<std::vector<std::string>>());
  if (const py::object bins = keywords.take("bins")) study.bins = bins.cast<std::vector<int>>();
  if (const py::object seed = keywords.take("seed")) study.seed = seed.cast<std::uint64_t>();
  const results::SeriesInput input = record_of(keywords, record, series, request);
  if (!study.strobe) study.strobe = input.drive_period;
  Call call(keywords);
  study.run = call.options().parallel("diagnose");
  return call([&] {
    return Result(results::content_of(
        std::make_shared<const diagnostics::SeriesStudy>(diagnostics::study_series(input.series, study)), input,
        unit == "bits"));
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
              "    *bases (Result): of those models\n" +
              options_text<Beside>() + options_text<studies::ExponentRequest>() + call_text())
                 .c_str());
  module.def("exponent_sweep", &exponent_sweep, py::arg("scene"), py::arg("over"), py::arg("values"),
             ("Leading Lyapunov exponents over values of a key, below the bifurcation diagram where a belt drives: of\n"
              "the full model, and of a reduced one beside it (a result of `pod`, `ensemble` or `reduce`).\n\n"
              "    over: key of the scene, e.g. \"drive.speed\"\n"
              "    *bases (Result): at most one\n"
              "    output (str): result file; an interrupted call goes on from there\n" +
              options_text<AlongKey>() + options_text<studies::ExponentRequest>() + call_text())
                 .c_str());
  module.def(
      "diagnose", &diagnose, py::arg("record"),
      ("What a record is: periodic, quasi-periodic, chaotic; exponents, dimensions, and every curve behind them.\n\n"
       "    record: a result (by default the velocity farthest from the contacts), a file's path, or an array of\n"
       "        samples, `interval` apart\n"
       "    series (str): which record of a result or a file, e.g. \"v/3\"; of samples their name\n"
       "    time (str): column or dataset with the instants, when not called time\n" +
       options_text<results::SeriesRequest>() +
       "    tools (list[str]): only these, e.g. [\"information\", \"wolf\"]; by default all that mean something for "
       "it\n"
       "    unit (str): of exponents and information: \"bits\" or \"nats\" (default \"bits\")\n"
       "    bins (list[int]): of equal width for mutual information, e.g. [5, 10, 20]\n"
       "    seed (int): of the surrogates (default 1)\n" +
       options_text<diagnostics::StudyOptions>() + call_text())
          .c_str());
  module.def(
      "run", &run, py::arg("scene"), py::arg("folder"),
      ("The whole pipeline, from the scene to files and figures in a folder, whose names it gives. An interrupted\n"
       "call goes on from there.\n\n" +
       call_text())
          .c_str());
}

}  // namespace slipmode::python
