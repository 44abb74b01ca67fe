#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/results/skeleton_store.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/skeleton_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <optional>

namespace slipmode::cli {
namespace {

struct OrbitSkeletonArguments {
  std::string scene, output, model = "full", compare_with;
  double duration = 0.0, transient = -1.0;
  orbits::SkeletonOptions search = {};
};

/// A model, its record and the stretch of it that is drawn.
struct Recorded {
  dynamics::HybridSystem system;
  std::optional<pod::Basis> basis;
  std::string title;
  orbits::Attractor attractor;
  Eigen::MatrixXd portrait;
};

/// The basis of a reduced model's file. @param option  for messages
pod::Basis basis_of(const std::string& model, const std::string& option, Eigen::Index size) {
  const std::optional<std::string> file = results::reduced_file(model);
  if (!file) {
    throw InvalidInput(fmt::format("{} {}: expected {}rom:FILE with a result of 'slipmode reduce'", option, model,
                                   option == "--model" ? "full, or " : ""));
  }
  return results::reduced_basis(*file, size);
}

/// How long is recorded: two hundred times what a run of the scene keeps, unless the user says.
orbits::AttractorOptions record_options(const Session& session, const OrbitSkeletonArguments& arguments,
                                        const scene::Scene& scene) {
  constexpr double kRecords = 200.0;
  constexpr double kSamples = 5000.0;
  orbits::AttractorOptions options;
  options.transient = arguments.transient >= 0.0 ? arguments.transient : scene.time.transient;
  options.duration =
      arguments.duration > 0.0 ? arguments.duration : kRecords * (scene.time.duration - scene.time.transient);
  options.sample = options.duration / kSamples;
  options.flow.method = scene.flow.method;
  options.stop = session.stop;
  return options;
}

Recorded record(const Session& session, const OrbitSkeletonArguments& arguments, const scene::Scene& scene,
                const std::optional<pod::Basis>& basis, const std::optional<orbits::Metric>& metric) {
  const dynamics::HybridSystem full = scene::build_system(scene);
  const dynamics::HybridSystem system = basis ? rom::reduce(full, *basis) : full;
  dynamics::State start = scene::initial_state(scene, full);
  if (basis) start = rom::restrict_state(full.structure(), *basis, start);
  orbits::AttractorOptions options = record_options(session, arguments, scene);
  options.basis = basis;
  options.metric = metric;
  orbits::Attractor attractor = orbits::record_attractor(system, start, options);

  const auto& passages = attractor.passages;
  const double interval = attractor.section.is_stroboscopic() ? attractor.period
                                                              : (passages.back().time - passages.front().time) /
                                                                    static_cast<double>(passages.size() - 1);
  constexpr double kShown = 150.0;  // passages
  constexpr double kPerPassage = 60.0;
  const dynamics::Trajectory run = dynamics::simulate(system, start,
                                                      {.duration = options.transient + kShown * interval,
                                                       .transient = options.transient,
                                                       .sample = interval / kPerPassage,
                                                       .output = dynamics::SimulateOptions::Output::kContacts,
                                                       .flow = options.flow});
  Eigen::MatrixXd portrait(2, run.contact_q.cols());
  portrait << run.contact_q.row(0), run.contact_v.row(0);
  const std::string title = basis ? fmt::format("reduced model, {} modes", basis->modes())
                                  : fmt::format("full model, {} degrees of freedom", full.size());
  return {system, basis, title, std::move(attractor), std::move(portrait)};
}

/// Runs a search with progress; one that was interrupted ends the verb.
template <class Search>
orbits::Skeleton with_progress(const Session& session, const OrbitSkeletonArguments& arguments, const std::string& what,
                               const Search& search) {
  orbits::SkeletonOptions options = arguments.search;
  options.parallel = session.run_options().parallel(what);
  orbits::Skeleton skeleton = search(options);
  if (skeleton.interrupted) throw Interrupted();
  return skeleton;
}

orbits::Skeleton found_in(const Session& session, const OrbitSkeletonArguments& arguments, const Recorded& model,
                          const std::string& what) {
  return with_progress(session, arguments, what, [&](const orbits::SkeletonOptions& options) {
    return orbits::find_skeleton(model.system, model.attractor, options);
  });
}

/// Skeletons of both models, each also tried from the other's orbits.
struct Pair {
  orbits::Skeleton full, reduced;
};

Pair found_in_both(const Session& session, const OrbitSkeletonArguments& arguments, const Recorded& full,
                   const Recorded& reduced) {
  const Eigen::Index segment = arguments.search.passages_per_segment;
  const pod::Basis& basis = *reduced.basis;
  const Pair own{found_in(session, arguments, full, "skeleton, full"),
                 found_in(session, arguments, reduced, "skeleton, reduced")};
  const auto down = [&](const dynamics::State& state) {
    return rom::restrict_state(full.system.structure(), basis, state);
  };
  const auto up = [&](const dynamics::State& state) { return rom::lift(basis, state); };
  const auto to_reduced = orbits::transferred_candidates(full.system, own.full, down, segment);
  const auto to_full = orbits::transferred_candidates(reduced.system, own.reduced, up, segment);
  const auto extended = [&](const Recorded& model, const orbits::Skeleton& known,
                            const std::vector<orbits::Candidate>& more, const std::string& what) {
    return with_progress(session, arguments, what, [&](const orbits::SkeletonOptions& options) {
      return orbits::extended_skeleton(model.system, model.attractor, known, options, more);
    });
  };
  return {extended(full, own.full, to_full, "full, from the reduced model's orbits"),
          extended(reduced, own.reduced, to_reduced, "reduced, from the full model's orbits")};
}

results::ModelSkeleton shown(const Recorded& model, orbits::Skeleton skeleton) {
  return {model.title, std::move(skeleton), model.portrait};
}

results::StoreWriter begin_store(const OrbitSkeletonArguments& arguments, const scene::Scene& scene) {
  results::StoreWriter writer(arguments.output, scene.units);
  results::save(
      writer,
      results::provenance_of(
          scene, fmt::format("slipmode orbit skeleton --model {}{}", arguments.model,
                             arguments.compare_with.empty() ? "" : " --compare-with " + arguments.compare_with)));
  return writer;
}

Report run_one(const Session& session, const OrbitSkeletonArguments& arguments, const scene::Scene& scene,
               const std::optional<pod::Basis>& basis) {
  const Recorded model = record(session, arguments, scene, basis, {});
  const results::ModelSkeleton found = shown(model, found_in(session, arguments, model, "skeleton"));
  results::StoreWriter writer = begin_store(arguments, scene);
  results::store_skeleton(writer, basis ? "reduced" : "full", found, results::Units::of(scene.units));
  writer.commit();
  Report report;
  report.data = {
      {"verb", "orbit skeleton"}, {"file", arguments.output}, {basis ? "reduced" : "full", skeleton_json(found)}};
  report.text = skeleton_text(found) + fmt::format("Skeleton: {}\n", arguments.output);
  return report;
}

Report run_pair(const Session& session, const OrbitSkeletonArguments& arguments, const scene::Scene& scene,
                const pod::Basis& basis) {
  const Recorded full = record(session, arguments, scene, {}, {});
  const Recorded reduced = record(session, arguments, scene, basis, full.attractor.metric);
  Pair pair = found_in_both(session, arguments, full, reduced);
  const orbits::SkeletonComparison comparison =
      orbits::compare_skeletons(pair.full, pair.reduced, full.attractor.metric);
  const results::ModelSkeleton of_full = shown(full, std::move(pair.full));
  const results::ModelSkeleton of_reduced = shown(reduced, std::move(pair.reduced));
  const results::Units units = results::Units::of(scene.units);
  results::StoreWriter writer = begin_store(arguments, scene);
  results::store_skeleton(writer, "full", of_full, units);
  results::store_skeleton(writer, "reduced", of_reduced, units);
  results::store_comparison(writer, comparison);
  writer.commit();
  Report report;
  report.data = {{"verb", "orbit skeleton"},
                 {"file", arguments.output},
                 {"full", skeleton_json(of_full)},
                 {"reduced", skeleton_json(of_reduced)},
                 {"comparison", comparison_json(comparison)}};
  report.text = skeleton_text(of_full) + '\n' + skeleton_text(of_reduced) + '\n' +
                comparison_text(comparison, of_full.skeleton, of_reduced.skeleton) +
                fmt::format("Skeletons: {}\n", arguments.output);
  return report;
}

Report run(const Session& session, const OrbitSkeletonArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  if (arguments.compare_with.empty()) {
    std::optional<pod::Basis> basis;
    if (arguments.model != "full") basis = basis_of(arguments.model, "--model", scene.size());
    return run_one(session, arguments, scene, basis);
  }
  if (arguments.model != "full") {
    throw InvalidInput(
        fmt::format("--model {}: --compare-with compares with the full model; leave --model out", arguments.model));
  }
  return run_pair(session, arguments, scene, basis_of(arguments.compare_with, "--compare-with", scene.size()));
}

}  // namespace

Verb add_orbit_skeleton(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("skeleton", "the unstable periodic orbits of a chaotic motion");
  const auto arguments = std::make_shared<OrbitSkeletonArguments>();
  orbits::SkeletonOptions& search = arguments->search;
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--model", arguments->model, "full, or rom:FILE with a result of 'slipmode reduce'");
  command->add_option("--compare-with", arguments->compare_with,
                      "rom:FILE: the skeleton of that reduced model too, and both compared");
  command->add_option("--duration", arguments->duration, "time recorded; 0: 200 times what [time] keeps")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--transient", arguments->transient, "time left out before it; default: as [time] says")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--max-length", search.returns.max_length, "longest orbits looked for, in passages of the section")
      ->check(CLI::PositiveNumber);
  command->add_option("--per-length", search.returns.per_length, "candidates of each length")
      ->check(CLI::PositiveNumber);
  command->add_option("--threshold", search.returns.threshold, "largest distance of a close return")
      ->check(CLI::PositiveNumber);
  command->add_option("--apart", search.returns.apart, "candidates of one length differ by this at least")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--radius", search.radius, "distance within which the attractor counts as near an orbit")
      ->check(CLI::PositiveNumber);
  command->add_option("--tolerance", search.shooting.tolerance, "bound on an orbit's relative mismatch after a period")
      ->check(CLI::PositiveNumber);
  command->footer(
      "Distances are in the attractor's metric: two independent points of it are about 1.4 apart. Sections: onsets of\n"
      "stick of the first contact on a belt, periods of the drive otherwise.\n"
      "Example:\n  slipmode orbit skeleton datasets/chain10/scene.toml -o skeleton.h5\n"
      "  slipmode orbit skeleton datasets/chain10/scene.toml --compare-with rom:rom6.h5 -o skeletons.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
