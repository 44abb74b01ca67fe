#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/bases.hpp>
#include "cli/orbit_range.hpp"
#include "cli/orbit_report.hpp"
#include "cli/orbit_search.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

using orbits::SpecialKind;

struct OrbitContinueArguments {
  OrbitSearch search;
  std::string over, output;
  bool sequential = false, switches = false;
  double step = 0.01, max_step = 0.02;
  int points = 2000;
};

orbits::ContinuationOptions continuation_options(const OrbitContinueArguments& arguments, const OrbitRange& range,
                                                 double start, const orbits::ShootingOptions& shooting) {
  return {.from = range.from,
          .to = range.to,
          .direction = range.to > range.from ? 1 : -1,
          .both_ways = start != range.from && start != range.to,
          .step = arguments.step,
          .max_step = arguments.max_step,
          .max_points = arguments.points,
          .arclength = !arguments.sequential,
          .shooting = shooting};
}

/// The branch that leaves at a special point, of two mirror images one.
results::NamedBranch switched(const orbits::SystemFamily& family, const orbits::SpecialPoint& special,
                              orbits::ContinuationOptions options) {
  results::NamedBranch side{
      .title = fmt::format("from {} at {:.8g}", orbits::to_string(special.kind), special.parameter), .branch = {}};
  try {
    const orbits::BranchPoint first = orbits::switch_branch(family, special, options).front();
    options.direction = first.parameter >= special.parameter ? 1 : -1;
    options.both_ways = false;
    options.shooting.half_period = false;
    if (special.kind == SpecialKind::kPeriodDoubling) {
      options.shooting.order *= 2;
      options.shooting.period *= 2.0;
    }
    side.branch = orbits::continue_orbit(family, first.orbit, first.parameter, options);
  } catch (const NumericalFailure& failure) {
    side.branch.end = orbits::BranchEnd::kLost;
    side.branch.reason = failure.what();
  }
  return side;
}

std::vector<results::NamedBranch> follow(const orbits::SystemFamily& family, const orbits::PeriodicOrbit& orbit,
                                         double start, const orbits::ContinuationOptions& options, bool switches) {
  std::vector<results::NamedBranch> branches = {
      {.title = "main branch", .branch = orbits::continue_orbit(family, orbit, start, options)}};
  if (!switches) return branches;
  const std::vector<orbits::SpecialPoint> special = branches.front().branch.special;
  for (const orbits::SpecialPoint& point : special) {
    if (point.kind != SpecialKind::kSymmetryBreaking && point.kind != SpecialKind::kPeriodDoubling) continue;
    if (point.orbit.crossings == 0) continue;  // in one regime: a floating structure's shift, which breaks nothing
    branches.push_back(switched(family, point, options));
  }
  return branches;
}

Json branch_json(const results::NamedBranch& named) {
  const orbits::Branch& branch = named.branch;
  Json special = Json::array();
  for (const orbits::SpecialPoint& point : branch.special) {
    special.push_back({{"kind", orbits::to_string(point.kind)},
                       {"parameter", point.parameter},
                       {"uncertainty", point.uncertainty},
                       {"multiplier", {point.multiplier.real(), point.multiplier.imag()}},
                       {"note", point.note}});
  }
  std::size_t stable = 0;
  for (const orbits::BranchPoint& point : branch.points) {
    stable += point.orbit.stability == orbits::Stability::kStable ? 1 : 0;
  }
  Json data = {{"title", named.title},
               {"points", branch.points.size()},
               {"stable", stable},
               {"end", orbits::to_string(branch.end)},
               {"complete", branch.end != orbits::BranchEnd::kLost},
               {"reason", branch.reason},
               {"special", special}};
  if (!branch.points.empty()) {
    data["first"] = branch.points.front().parameter;
    data["last"] = branch.points.back().parameter;
  }
  return data;
}

std::string branch_text(const results::NamedBranch& named) {
  const orbits::Branch& branch = named.branch;
  std::string text = fmt::format("{}: {} orbits", named.title, branch.points.size());
  if (!branch.points.empty()) {
    text += fmt::format(" from {:.10g} to {:.10g}", branch.points.front().parameter, branch.points.back().parameter);
  }
  text +=
      fmt::format(", end: {}{}{}\n", orbits::to_string(branch.end), branch.reason.empty() ? "" : ", ", branch.reason);
  if (branch.special.empty()) return text;
  constexpr std::size_t kShown = 40;
  TextTable table({"special point", "at", "±", "multiplier", "note"});
  for (std::size_t k = 0; k < std::min(kShown, branch.special.size()); ++k) {
    const orbits::SpecialPoint& point = branch.special[k];
    const bool critical = point.multiplier != std::complex<double>{};
    table.add({orbits::to_string(point.kind), fmt::format("{:.12g}", point.parameter),
               fmt::format("{:.1g}", point.uncertainty),
               critical ? multipliers_text(Eigen::VectorXcd::Constant(1, point.multiplier)) : "–", point.note});
  }
  text += table.str();
  if (branch.special.size() > kShown) text += fmt::format("  and {} more\n", branch.special.size() - kShown);
  return text;
}

Report run(const Session& session, const OrbitContinueArguments& arguments) {
  require_writable(arguments.output);
  const OrbitRange range = parse_range(arguments.over);
  scene::Scene scene = session.load(arguments.search.scene);
  const double own = scene::get_continuous_key(scene, range.key);
  const double start = range.holds(own) ? own : range.from;
  if (start != own) scene = scene::set_key(scene, range.key, start);
  const studies::Family model(scene, {range.key},
                              studies::model_basis(scene, arguments.search.model, session.run_options()));
  const orbits::SystemFamily family = systems_over(model, range, session);
  const SearchStart search = search_start(arguments.search, model);
  const orbits::ShootingResult found = orbits::shoot(family(start), search.guess, search.options);
  if (!found.converged()) return not_found("orbit continue", found);

  const orbits::ContinuationOptions options = continuation_options(arguments, range, start, search.options);
  const std::vector<results::NamedBranch> branches = follow(family, found.orbit, start, options, arguments.switches);
  results::StoreWriter writer(arguments.output, scene.units);
  results::save(writer,
                results::provenance_of(scene, fmt::format("slipmode orbit continue --over {}", arguments.over)));
  results::store_branches(writer, range.key, branches, family);
  writer.commit();

  Report report;
  Json list = Json::array();
  for (const results::NamedBranch& branch : branches) {
    list.push_back(branch_json(branch));
    report.text += branch_text(branch);
  }
  report.data = {{"verb", "orbit continue"}, {"model", model.title()}, {"file", arguments.output}, {"key", range.key},
                 {"from", range.from},       {"to", range.to},         {"start", start},           {"branches", list}};
  report.text += fmt::format("Branches: {}\n", arguments.output);
  if (branches.front().branch.end == orbits::BranchEnd::kLost) {
    report.exit_code = kNumericalFailure;
    report.text = "the branch was lost before the end of its range; what was found is kept\n" + report.text;
    report.data["message"] = report.text;
    report.data["incomplete"] = true;
  }
  return report;
}

}  // namespace

Verb add_orbit_continue(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("continue", "follow an orbit over one key of the scene");
  const auto arguments = std::make_shared<OrbitContinueArguments>();
  add_search_options(*command, arguments->search);
  command->add_option("--over", arguments->over, "key and range: KEY=FROM:TO")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_flag("--switch", arguments->switches,
                    "also follow the branches that leave at symmetry breakings and period doublings");
  command->add_flag("--sequential", arguments->sequential,
                    "step the key itself instead of the arc length: a fold ends the branch");
  command->add_option("--step", arguments->step, "first step along the branch; 1 is the range, or the orbit's size")
      ->check(CLI::PositiveNumber);
  command->add_option("--max-step", arguments->max_step, "largest step")->check(CLI::PositiveNumber);
  command->add_option("--points", arguments->points, "orbits per branch at most")->check(CLI::Range(2, 10'000'000));
  command->footer(
      "The branch starts at the scene's own value of the key when that lies in the range, and is then followed both "
      "ways; else at FROM.\n"
      "Example:\n  slipmode orbit continue datasets/backlash_sdof/scene.toml --over drive.omega=1.8:0.5 --start 2.5,0 "
      "--switch -o branch.h5\n  slipmode plot branch.h5 -o response.svg");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
