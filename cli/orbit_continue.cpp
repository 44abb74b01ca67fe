#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/orbit_search.hpp>
#include "cli/json_values.hpp"
#include "cli/orbit_report.hpp"
#include "cli/orbit_search.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>

namespace slipmode::cli {
namespace {

struct OrbitContinueArguments {
  OrbitSearchArguments search;
  std::string over, output;
  studies::ContinuationRequest request;
};

/// KEY=FROM:TO, a range followed without steps.
struct OrbitRange {
  std::string key;
  double from = 0.0, to = 0.0;
};

OrbitRange parse_range(const std::string& text) {
  const auto complain = [&text](const std::string& what) {
    return InvalidInput(fmt::format("--over {}: {}; expected KEY=FROM:TO, e.g. drive.omega=1.8:0.3", text, what));
  };
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || equals == 0) throw complain("no KEY=");
  if (colon == std::string::npos) throw complain("no range FROM:TO");
  const auto number = [&](std::size_t begin, std::size_t end) {
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc() || stopped != text.data() + end || !std::isfinite(value)) {
      throw complain(fmt::format("'{}' is not a number", text.substr(begin, end - begin)));
    }
    return value;
  };
  OrbitRange range{text.substr(0, equals), number(equals + 1, colon), number(colon + 1, text.size())};
  if (range.from == range.to) throw complain("the range has no length");
  return range;
}

Json branch_json(const results::NamedBranch& named) {
  const orbits::Branch& branch = named.branch;
  Json special = Json::array();
  for (const orbits::SpecialPoint& point : branch.special) {
    special.push_back(merged(
        {{"kind", orbits::to_string(point.kind)}, {"multiplier", {point.multiplier.real(), point.multiplier.imag()}}},
        fields_json(point)));
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
  const scene::Scene scene = session.load(arguments.search.scene);
  const studies::RunOptions run_options = session.run_options();
  const auto basis = studies::model_basis(scene, arguments.search.model, run_options);
  studies::ContinuationRequest request = arguments.request;
  request.from = range.from;
  request.to = range.to;
  const studies::Continuation found =
      studies::continue_orbit(scene, range.key, basis, search_of(arguments.search, scene), request, run_options);
  if (!found.found.converged()) return not_found("orbit continue", found.found);
  const studies::Family model(scene, {range.key}, basis);
  results::StoreWriter writer(arguments.output, results::FileKind::kBranches, scene.units);
  const std::string command =
      fmt::format("slipmode orbit continue --over {} --model {}", arguments.over, arguments.search.model);
  results::save(writer, results::provenance_of(scene::set_key(scene, range.key, found.start), command));
  results::store_branches(writer, range.key, found.branches, model.systems());
  writer.commit();

  Report report;
  Json list = Json::array();
  for (const results::NamedBranch& branch : found.branches) {
    list.push_back(branch_json(branch));
    report.text += branch_text(branch);
  }
  report.data = {{"verb", "orbit continue"}, {"model", model.title()}, {"file", arguments.output}, {"key", range.key},
                 {"from", range.from},       {"to", range.to},         {"start", found.start},     {"branches", list}};
  report.text += fmt::format("Branches: {}\n", arguments.output);
  if (found.branches.front().branch.end == orbits::BranchEnd::kLost) {
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
  command->add_flag("--switch", arguments->request.switches,
                    "also follow the branches that leave at symmetry breakings and period doublings");
  command->add_flag("--sequential", arguments->request.sequential,
                    "step the key itself instead of the arc length: a fold ends the branch");
  command
      ->add_option("--step", arguments->request.step,
                   "first step along the branch; 1 is the range, or the orbit's size")
      ->check(CLI::PositiveNumber);
  command->add_option("--max-step", arguments->request.max_step, "largest step")->check(CLI::PositiveNumber);
  command->add_option("--points", arguments->request.max_points, "orbits per branch at most")
      ->check(CLI::Range(2, 10'000'000));
  command->footer(
      "The branch starts at the scene's own value of the key when that lies in the range, and is then followed both "
      "ways; else at FROM.\n"
      "Example:\n  slipmode orbit continue datasets/backlash_sdof/scene.toml --over drive.omega=1.8:0.5 --start 2.5,0 "
      "--switch -o branch.h5\n  slipmode plot branch.h5 -o response.svg");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
