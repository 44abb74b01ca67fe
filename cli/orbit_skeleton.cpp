#include <slipmode/results/provenance.hpp>
#include <slipmode/results/reduced_file.hpp>
#include <slipmode/results/skeleton_store.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/skeletons.hpp>
#include "cli/skeleton_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct OrbitSkeletonArguments {
  std::string scene, output, model = "full", compare_with;
  studies::SkeletonRequest request;
};

results::StoreWriter begin_store(const OrbitSkeletonArguments& arguments, const scene::Scene& scene) {
  results::StoreWriter writer(arguments.output, results::FileKind::kSkeleton, scene.units);
  results::save(
      writer,
      results::provenance_of(
          scene, fmt::format("slipmode orbit skeleton --model {}{}", arguments.model,
                             arguments.compare_with.empty() ? "" : " --compare-with " + arguments.compare_with)));
  return writer;
}

Report run_one(const Session& session, const OrbitSkeletonArguments& arguments, const studies::Family& model) {
  const results::ModelSkeleton found = studies::skeleton(model, arguments.request, session.run_options());
  const std::string role = model.basis() ? "reduced" : "full";
  results::StoreWriter writer = begin_store(arguments, model.scene());
  results::store_skeleton(writer, role, found, results::Units::of(model.scene().units));
  writer.commit();
  Report report;
  report.data = {{"verb", "orbit skeleton"}, {"file", arguments.output}, {role, skeleton_json(found)}};
  report.text = skeleton_text(found) + fmt::format("Skeleton: {}\n", arguments.output);
  return report;
}

Report run_pair(const Session& session, const OrbitSkeletonArguments& arguments, const studies::Family& reduced) {
  const scene::Scene& scene = reduced.scene();
  const auto [of_full, of_reduced, comparison] =
      studies::skeletons(studies::Family(scene), reduced, arguments.request, session.run_options());
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
    return run_one(session, arguments,
                   studies::Family(scene, {}, studies::model_basis(scene, arguments.model, session.run_options())));
  }
  if (arguments.model != "full") {
    throw InvalidInput(
        fmt::format("--model {}: --compare-with compares with the full model; leave --model out", arguments.model));
  }
  if (!results::reduced_file(arguments.compare_with)) {
    throw InvalidInput(
        fmt::format("--compare-with {}: expected rom:FILE with a result of 'slipmode reduce'", arguments.compare_with));
  }
  const auto basis = studies::model_basis(scene, arguments.compare_with, session.run_options());
  return run_pair(session, arguments, studies::Family(scene, {}, basis));
}

}  // namespace

Verb add_orbit_skeleton(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("skeleton", "the unstable periodic orbits of a chaotic motion");
  const auto arguments = std::make_shared<OrbitSkeletonArguments>();
  orbits::SkeletonOptions& search = arguments->request.search;
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--model", arguments->model, "full, or rom:FILE with a result of 'slipmode reduce'");
  command->add_option("--compare-with", arguments->compare_with,
                      "rom:FILE: the skeleton of that reduced model too, and both compared");
  command->add_option("--duration", arguments->request.duration, "time recorded; 0: 200 times what [time] keeps")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--transient", arguments->request.transient, "time left out before it; default: as [time] says")
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
