#include <slipmode/studies/exponents.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/bases.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <mutex>
#include <utility>

namespace slipmode::studies {
namespace {

constexpr double kUsualPeriods = 500.0, kUsualIntervals = 1000.0;

/// Above so many directions the leading ones only are measured unless more are asked for.
constexpr Eigen::Index kAllUpTo = 64, kLeading = 8;

/// Progress over several models that are measured side by side.
class SharedProgress {
 public:
  SharedProgress(ProgressCallback update, std::size_t models)
      : update_(std::move(update)), done_(models), total_(models) {}

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

}  // namespace

Subjects subjects_of(const scene::Scene& scene, const std::vector<results::StoreReader>& bases, Eigen::Index modes) {
  Subjects subjects{.full = scene::build_system(scene), .start = {}, .bases = {}};
  subjects.start = scene::initial_state(scene, subjects.full);
  for (const results::StoreReader& store : bases) {
    for (pod::NamedBasis& basis : load_chosen_bases(scene, subjects.full, store, modes))
      subjects.bases.push_back(std::move(basis));
  }
  return subjects;
}

diagnostics::TangentOptions tangent_options(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                            const ExponentRequest& request, const RunOptions& run) {
  diagnostics::TangentOptions options;
  const std::optional<double> period = full.drive().period();
  const double usual = period ? kUsualPeriods * *period : std::max(scene.time.duration, scene.time.transient);
  options.transient = request.transient.value_or(scene.time.transient);
  options.duration = request.duration.value_or(usual);
  options.interval = request.interval.value_or(period ? *period : options.duration / kUsualIntervals);
  const bool many = 2 * full.size() + full.internal_size() > kAllUpTo;
  options.exponents = request.exponents == 0 && many ? kLeading : request.exponents;
  options.seed = scene.ensemble.seed;
  options.flow = scene::uncertified(scene.flow);
  options.flow.audit = false;
  options.stop = run.stop;
  return options;
}

std::vector<results::ModelExponents> model_exponents(const Subjects& subjects,
                                                     const diagnostics::TangentOptions& options,
                                                     const RunOptions& run) {
  const std::size_t count = subjects.bases.size() + 1;
  std::vector<results::ModelExponents> models(count);
  ParallelOptions parallel = run.parallel("exponents");
  const bool shown = static_cast<bool>(parallel.progress);
  SharedProgress progress(std::exchange(parallel.progress, {}), count);
  rethrow_first(parallel_for(count, parallel, [&](std::size_t i) {
    results::ModelExponents& model = models[i];
    diagnostics::TangentOptions own = options;
    if (shown) own.progress = progress.of(i);
    try {
      if (i == 0) {
        model.name = "full";
        model.spectrum = diagnostics::lyapunov_spectrum(subjects.full, subjects.start, own);
        return;
      }
      const pod::NamedBasis& basis = subjects.bases[i - 1];
      model.name = basis.name;
      const dynamics::HybridSystem reduced = rom::reduce(subjects.full, basis.basis);
      const dynamics::State start = rom::restrict_state(subjects.full.structure(), basis.basis, subjects.start);
      own.exponents = std::min(own.exponents, 2 * reduced.size() + reduced.internal_size());
      model.spectrum = diagnostics::lyapunov_spectrum(reduced, start, own);
    } catch (const NumericalFailure& failure) {
      if (count == 1) throw;
      model.failure = fmt::format("at time {:g}: {}", failure.time, failure.what());
    }
  }));
  return models;
}

diagnostics::VerdictTable model_verdict(const scene::Scene& scene, const Subjects& subjects,
                                        const diagnostics::TangentOptions& options, const RunOptions& run) {
  constexpr double kSamplesPerPeriod = 16.0;
  const std::optional<double> period = subjects.full.drive().period();
  diagnostics::ModelVerdictOptions judging = scene::verdict_options(scene);
  judging.tangent = options;
  if (period) judging.sample = *period / kSamplesPerPeriod;
  judging.parallel = run.parallel("verdict");
  return diagnostics::model_verdict(subjects.full, subjects.start, subjects.bases, judging);
}

ModelDiagnosis diagnose_models(const scene::Scene& scene, const Subjects& subjects, const ExponentRequest& request,
                               bool with_verdict, const RunOptions& run) {
  const diagnostics::TangentOptions options = tangent_options(scene, subjects.full, request, run);
  const Eigen::Index directions = 2 * subjects.full.size() + subjects.full.internal_size();
  if (options.exponents > directions)
    throw InvalidInput(fmt::format("--exponents {}: the model has {} directions", options.exponents, directions));
  if (!with_verdict) return {.exponents = model_exponents(subjects, options, run), .verdict = {}};
  diagnostics::VerdictTable verdict = model_verdict(scene, subjects, options, run);
  if (const std::string& failure = verdict.models.front().failure; !failure.empty())
    throw NumericalFailure("the full model failed " + failure, options.transient, {}, 0.0);
  std::vector<results::ModelExponents> exponents = results::exponents_of(verdict);
  return {.exponents = std::move(exponents), .verdict = std::move(verdict)};
}

results::Content content_of(const scene::Scene& scene, std::shared_ptr<const ModelDiagnosis> diagnosis) {
  const bool judged = diagnosis->verdict.has_value();
  return {.kind = judged ? results::FileKind::kVerdict : results::FileKind::kExponents,
          .unit_system = scene.units,
          .write = [scene, diagnosis = std::move(diagnosis)](results::StoreWriter& writer) {
            const results::Units units = results::Units::of(scene.units);
            const bool verdict = diagnosis->verdict.has_value();
            results::save(writer,
                          results::provenance_of(scene, verdict ? "slipmode diagnose --verdict" : "slipmode diagnose"));
            results::store_exponents(writer, diagnosis->exponents, units);
            if (verdict) results::store_verdict(writer, *diagnosis->verdict, units);
          }};
}

}  // namespace slipmode::studies
