#include "cli/diagnose_model.hpp"
#include "cli/exponents_report.hpp"

#include <slipmode/diagnostics/validation/shared_starts.hpp>
#include <slipmode/figures/exponents_figures.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/own_times.hpp>
#include "cli/diagnose_subjects.hpp"
#include "cli/diagnose_sweep.hpp"
#include "cli/validation_setup.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <mutex>

namespace slipmode::cli {
namespace {

namespace fs = std::filesystem;

/// Progress over several models that are measured side by side.
class SharedProgress {
 public:
  SharedProgress(ProgressLine& line, std::size_t models) : update_(line.callback()), done_(models), total_(models) {}

  [[nodiscard]] ProgressCallback of(std::size_t model) {
    return [this, model](std::size_t done, std::size_t total) {
      const std::scoped_lock lock(mutex_);
      done_[model] = static_cast<double>(done) / static_cast<double>(total);
      double sum = 0.0;
      for (const double share : done_) sum += share;
      constexpr double kThousand = 1000.0;
      update_(static_cast<std::size_t>(kThousand * sum), total_ * 1000);
    };
  }

 private:
  ProgressCallback update_;
  std::vector<double> done_;
  std::size_t total_;
  std::mutex mutex_;
};

std::vector<results::ModelExponents> measure_models(const Session& session, const DiagnoseSubjects& subjects,
                                                    const diagnostics::TangentOptions& options) {
  const std::size_t count = subjects.candidates.size() + 1;
  std::vector<results::ModelExponents> models(count);
  ProgressLine line("exponents", session.progress_mode());
  SharedProgress progress(line, count);
  const ParallelOptions parallel{.threads = session.threads, .stop = session.stop, .progress = {}};
  rethrow_first(parallel_for(count, parallel, [&](std::size_t i) {
    results::ModelExponents& model = models[i];
    diagnostics::TangentOptions own = options;
    own.progress = progress.of(i);
    try {
      if (i == 0) {
        model.name = "full";
        model.spectrum = diagnostics::lyapunov_spectrum(subjects.full, subjects.start, own);
        return;
      }
      const diagnostics::VerdictCandidate& candidate = subjects.candidates[i - 1];
      model.name = candidate.name;
      const dynamics::HybridSystem reduced = rom::reduce(subjects.full, candidate.basis);
      dynamics::State start = diagnostics::on_subspace(subjects.full.structure(), candidate.basis, subjects.start);
      start.time = subjects.start.time;
      own.exponents = std::min(own.exponents, 2 * reduced.size() + reduced.internal_size());
      model.spectrum = diagnostics::lyapunov_spectrum(reduced, start, own);
    } catch (const NumericalFailure& failure) {
      if (count == 1) throw;
      model.failure = fmt::format("at time {:g}: {}", failure.time, failure.what());
    }
  }));
  return models;
}

diagnostics::VerdictTable judge_models(const Session& session, const scene::Scene& scene,
                                       const DiagnoseSubjects& subjects, const diagnostics::TangentOptions& options) {
  constexpr double kSamplesPerPeriod = 16.0;
  const std::optional<double> period = subjects.full.drive().period();
  ProgressLine line("verdict", session.progress_mode());
  diagnostics::ModelVerdictOptions judging = verdict_options(scene);
  judging.tangent = options;
  if (period) judging.sample = *period / kSamplesPerPeriod;
  judging.parallel = session.parallel(line);
  return diagnostics::model_verdict(subjects.full, subjects.start, subjects.candidates, judging);
}

/// The file figures are drawn from: the one asked for, or one in their folder.
std::string model_file(const DiagnoseRequest& request) {
  if (!request.output.empty() || request.figures.empty()) return request.output;
  return (fs::path(request.figures) / "diagnosis.h5").string();
}

void check_diagnosis_outputs(const DiagnoseRequest& request) {
  if (!request.output.empty()) require_writable(request.output);
  if (request.figures.empty()) return;
  figures::require_gnuplot();
  fs::create_directories(request.figures);
  require_writable(fs::path(request.figures) / "diagnosis.h5");
}

void draw_diagnosis(const DiagnoseRequest& request, const std::string& file, Report& report) {
  if (request.figures.empty()) return;
  report.data["figures"] =
      figures::save_all(figures::exponents_figures_of(results::StoreReader(file)), request.figures);
  report.text += fmt::format("Figures: {}\n", request.figures);
}

Report diagnose_scene(const Session& session, const DiagnoseRequest& request, const ModelRequest& models) {
  const scene::Scene scene = scene::with_own_times(session.load(request.input));
  check_diagnosis_outputs(request);
  if (!models.over.empty()) {
    if (models.verdict) throw InvalidInput("--verdict and --over: expected one of them");
    DiagnoseRequest with_file = request;
    with_file.output = model_file(request);
    Report report = diagnose_over(session, scene, with_file, models);
    draw_diagnosis(request, with_file.output, report);
    return report;
  }
  const DiagnoseSubjects subjects = diagnose_subjects(scene, models);
  const diagnostics::TangentOptions options = tangent_options(session, scene, subjects.full, models);
  if (options.exponents > 2 * subjects.full.size() + subjects.full.internal_size())
    throw InvalidInput(fmt::format("--exponents {}: the model has {} directions", options.exponents,
                                   2 * subjects.full.size() + subjects.full.internal_size()));
  std::optional<diagnostics::VerdictTable> verdict;
  if (models.verdict) verdict = judge_models(session, scene, subjects, options);
  const std::vector<results::ModelExponents> spectra =
      verdict ? results::exponents_of(*verdict) : measure_models(session, subjects, options);
  if (verdict && !verdict->models.front().failure.empty())
    throw NumericalFailure("the full model failed " + verdict->models.front().failure, options.transient, {}, 0.0);

  Report report;
  report.data = {{"verb", "diagnose"}, {"scene", request.input}, {"exponents", exponents_json(spectra)}};
  report.text = exponents_text(spectra, request.bits);
  if (verdict) {
    report.data["verdict"] = verdict_json(*verdict);
    report.text += verdict_text(*verdict, request.bits);
  }
  const std::string file = model_file(request);
  if (file.empty()) return report;
  const results::Units units = results::Units::of(scene.units);
  results::StoreWriter writer(file, scene.units);
  results::save(writer,
                results::provenance_of(scene, models.verdict ? "slipmode diagnose --verdict" : "slipmode diagnose"));
  results::store_exponents(writer, spectra, units);
  if (verdict) results::store_verdict(writer, *verdict, units);
  writer.commit();
  report.data["file"] = file;
  report.text += fmt::format("Numbers and histories: {}\n", file);
  draw_diagnosis(request, file, report);
  return report;
}

}  // namespace

ModelDiagnosis add_model_diagnosis(CLI::App& command) {
  constexpr const char* kGroup = "Of a model (INPUT is a scene, .toml)";
  const auto models = std::make_shared<ModelRequest>();
  command
      .add_option("MODELS", models->files,
                  "of a scene: reduced models beside the full one; a POD, an ensemble, or a "
                  "result of 'slipmode reduce' each")
      ->group(kGroup);
  command
      .add_flag("--verdict", models->verdict,
                "one table: exponents, dimensions, delay, embedding, spectrum, stick, full and reduced side by side")
      ->group(kGroup);
  command.add_option("--modes", models->modes, "of MODELS; else as [reduction] chooses")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command
      .add_option("--exponents", models->exponents,
                  "how many, the largest; else all, eight of more than 64, four with --over")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command.add_option("--transient", models->transient, "time run first; else that of [time]")
      ->check(CLI::NonNegativeNumber)
      ->group(kGroup);
  command
      .add_option("--duration", models->duration,
                  "time measured; else that of [time], 500 periods of a drive, with --over a quarter")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command
      .add_option("--renormalise", models->interval,
                  "time between renormalisations; else a thousandth of the duration, or the drive's period")
      ->check(CLI::PositiveNumber)
      ->group(kGroup);
  command.add_option("--over", models->over, "exponents against a key: KEY=FROM:TO:STEP")->group(kGroup);
  command.add_flag("--follow", models->follow, "with --over: start each value where the one before it ended")
      ->group(kGroup);
  return [models](const Session& session, const DiagnoseRequest& request) {
    return diagnose_scene(session, request, *models);
  };
}

}  // namespace slipmode::cli
