#include <slipmode/studies/skeletons.hpp>

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/studies/command.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::studies {
namespace {

/// A model, its record and the stretch of it that is drawn.
struct Recorded {
  const Family& family;
  orbits::Attractor attractor;
  Eigen::MatrixXd portrait;
};

/// How long is recorded: two hundred times what a run of the scene keeps, unless it is said.
orbits::AttractorOptions record_options(const scene::Scene& scene, const SkeletonRequest& request,
                                        const RunOptions& run) {
  constexpr double kRecords = 200.0;
  constexpr double kSamples = 5000.0;
  orbits::AttractorOptions options;
  options.transient = request.transient.value_or(scene.time.transient);
  options.duration =
      request.duration > 0.0 ? request.duration : kRecords * (scene.time.duration - scene.time.transient);
  options.sample = options.duration / kSamples;
  options.flow.method = scene.flow.method;
  options.stop = run.stop;
  return options;
}

Recorded record(const Family& family, const SkeletonRequest& request, const std::optional<orbits::Metric>& metric,
                const RunOptions& run) {
  orbits::AttractorOptions options = record_options(family.scene(), request, run);
  if (family.basis()) options.basis = family.basis()->basis;
  options.metric = metric;
  orbits::Attractor attractor = orbits::record_attractor(family.own(), family.start(), options);

  const auto& passages = attractor.passages;
  const double interval = attractor.section.is_stroboscopic() ? attractor.period
                                                              : (passages.back().time - passages.front().time) /
                                                                    static_cast<double>(passages.size() - 1);
  constexpr double kShown = 150.0;  // passages
  constexpr double kPerPassage = 60.0;
  const dynamics::Trajectory shown = dynamics::simulate(family.own(), family.start(),
                                                        {.duration = options.transient + kShown * interval,
                                                         .transient = options.transient,
                                                         .sample = interval / kPerPassage,
                                                         .output = dynamics::SimulateOptions::Output::kContacts,
                                                         .flow = options.flow});
  Eigen::MatrixXd portrait(2, shown.contact_q.cols());
  portrait << shown.contact_q.row(0), shown.contact_v.row(0);
  return {family, std::move(attractor), std::move(portrait)};
}

/// Runs a search with progress; one that was interrupted ends the study.
template <class Search>
orbits::Skeleton with_progress(const SkeletonRequest& request, const RunOptions& run, const std::string& what,
                               const Search& search) {
  orbits::SkeletonOptions options{.shooting = {.tolerance = request.tolerance}, .radius = request.radius};
  options.returns.max_length = request.max_length;
  options.returns.per_length = request.per_length;
  options.returns.threshold = request.threshold;
  options.returns.apart = request.apart;
  options.parallel = run.parallel(what);
  orbits::Skeleton skeleton = search(options);
  if (skeleton.interrupted) throw Interrupted();
  return skeleton;
}

orbits::Skeleton found_in(const SkeletonRequest& request, const RunOptions& run, const Recorded& model,
                          const std::string& what) {
  return with_progress(request, run, what, [&](const orbits::SkeletonOptions& options) {
    return orbits::find_skeleton(model.family.own(), model.attractor, options);
  });
}

/// Skeletons of both models, each also tried from the other's orbits.
struct SkeletonsOfBoth {
  orbits::Skeleton full, reduced;
};

SkeletonsOfBoth found_in_both(const SkeletonRequest& request, const RunOptions& run, const Recorded& full,
                              const Recorded& reduced) {
  const Eigen::Index segment = orbits::SkeletonOptions{}.passages_per_segment;
  const pod::Basis& basis = reduced.family.basis()->basis;
  const SkeletonsOfBoth own{found_in(request, run, full, "skeleton, full"),
                            found_in(request, run, reduced, "skeleton, reduced")};
  const auto down = [&](const dynamics::State& state) { return reduced.family.own_state(state); };
  const auto up = [&](const dynamics::State& state) { return rom::lift(basis, state); };
  const auto to_reduced = orbits::transferred_candidates(full.family.own(), own.full, down, segment);
  const auto to_full = orbits::transferred_candidates(reduced.family.own(), own.reduced, up, segment);
  const auto extended = [&](const Recorded& model, const orbits::Skeleton& known,
                            const std::vector<orbits::Candidate>& more, const std::string& what) {
    return with_progress(request, run, what, [&](const orbits::SkeletonOptions& options) {
      return orbits::extended_skeleton(model.family.own(), model.attractor, known, options, more);
    });
  };
  return {extended(full, own.full, to_full, "full, from the reduced model's orbits"),
          extended(reduced, own.reduced, to_reduced, "reduced, from the full model's orbits")};
}

template <class Write>
results::Content content(const scene::Scene& scene, const std::string& options, Write write) {
  return {.kind = results::FileKind::kSkeleton,
          .unit_system = scene.units,
          .write = [provenance = results::provenance_of(scene, "slipmode orbit skeleton" + options),
                    write = std::move(write)](results::StoreWriter& writer) {
            results::save(writer, provenance);
            write(writer);
          }};
}

results::ModelSkeleton shown(const Recorded& model, orbits::Skeleton skeleton) {
  return {model.family.title(), std::move(skeleton), model.portrait};
}

}  // namespace

results::ModelSkeleton skeleton(const Family& model, const SkeletonRequest& request, const RunOptions& run) {
  const Recorded recorded = record(model, request, {}, run);
  return shown(recorded, found_in(request, run, recorded, "skeleton"));
}

SkeletonPair skeletons(const Family& full, const Family& reduced, const SkeletonRequest& request,
                       const RunOptions& run) {
  const Recorded of_full = record(full, request, {}, run);
  const Recorded of_reduced = record(reduced, request, of_full.attractor.metric, run);
  SkeletonsOfBoth both = found_in_both(request, run, of_full, of_reduced);
  orbits::SkeletonComparison comparison = orbits::compare_skeletons(both.full, both.reduced, of_full.attractor.metric);
  return {shown(of_full, std::move(both.full)), shown(of_reduced, std::move(both.reduced)), std::move(comparison)};
}

results::Content content_of(const Family& model, std::shared_ptr<const results::ModelSkeleton> skeleton,
                            const std::string& model_word, const SkeletonRequest& request) {
  return content(model.scene(), model_option(model_word) + options_text(request),
                 [role = model.basis() ? "reduced" : "full", skeleton = std::move(skeleton),
                  units = results::Units::of(model.scene().units)](results::StoreWriter& writer) {
                   results::store_skeleton(writer, role, *skeleton, units);
                 });
}

results::Content content_of(const Family& reduced, std::shared_ptr<const SkeletonPair> pair,
                            const std::string& model_word, const SkeletonRequest& request) {
  return content(
      reduced.scene(), " --compare-with " + model_word + options_text(request),
      [pair = std::move(pair), units = results::Units::of(reduced.scene().units)](results::StoreWriter& writer) {
        results::store_skeleton(writer, "full", pair->full, units);
        results::store_skeleton(writer, "reduced", pair->reduced, units);
        results::store_comparison(writer, pair->comparison);
      });
}

}  // namespace slipmode::studies
