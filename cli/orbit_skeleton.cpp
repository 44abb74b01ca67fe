#include <slipmode/results/reduced_file.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/skeletons.hpp>
#include "cli/field_options.hpp"
#include "cli/skeleton_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <memory>

namespace slipmode::cli {
namespace {

struct OrbitSkeletonArguments {
  std::string scene, output, model = "full", compare_with;
  studies::SkeletonRequest request;
};

Report run_one(const Session& session, const OrbitSkeletonArguments& arguments, const studies::Family& model) {
  const auto found = std::make_shared<const results::ModelSkeleton>(
      studies::skeleton(model, arguments.request, session.run_options()));
  studies::content_of(model, found, arguments.model, arguments.request).save(arguments.output);
  Report report;
  report.data = {{"verb", "orbit skeleton"},
                 {"file", arguments.output},
                 {model.basis() ? "reduced" : "full", skeleton_json(*found)}};
  report.text = skeleton_text(*found) + fmt::format("Skeleton: {}\n", arguments.output);
  return report;
}

Report run_pair(const Session& session, const OrbitSkeletonArguments& arguments, const studies::Family& reduced) {
  const auto pair = std::make_shared<const studies::SkeletonPair>(
      studies::skeletons(studies::Family(reduced.scene()), reduced, arguments.request, session.run_options()));
  studies::content_of(reduced, pair, arguments.compare_with, arguments.request).save(arguments.output);
  Report report;
  report.data = {{"verb", "orbit skeleton"},
                 {"file", arguments.output},
                 {"full", skeleton_json(pair->full)},
                 {"reduced", skeleton_json(pair->reduced)},
                 {"comparison", comparison_json(pair->comparison)}};
  report.text = skeleton_text(pair->full) + '\n' + skeleton_text(pair->reduced) + '\n' +
                comparison_text(pair->comparison, pair->full.skeleton, pair->reduced.skeleton) +
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
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--model", arguments->model, "full, or rom:FILE with a result of 'slipmode reduce'");
  command->add_option("--compare-with", arguments->compare_with,
                      "rom:FILE: the skeleton of that reduced model too, and both compared");
  add_fields(*command, arguments->request);
  command->footer(
      "Distances are in the attractor's metric: two independent points of it are about 1.4 apart. Sections: onsets of\n"
      "stick of the first contact on a belt, periods of the drive otherwise.\n"
      "Example:\n  slipmode orbit skeleton datasets/chain10/scene.toml -o skeleton.h5\n"
      "  slipmode orbit skeleton datasets/chain10/scene.toml --compare-with rom:rom6.h5 -o skeletons.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
