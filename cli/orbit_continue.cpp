#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/balance_search.hpp>
#include <slipmode/studies/bases.hpp>
#include "cli/balance_report.hpp"
#include "cli/field_options.hpp"
#include "cli/json_values.hpp"
#include "cli/orbit_curves.hpp"
#include "cli/orbit_report.hpp"
#include "cli/orbit_search.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <memory>
#include <utility>

namespace slipmode::cli {
namespace {

struct OrbitContinueArguments {
  OrbitSearchArguments search;
  BalanceArguments balance;
  std::optional<int> every;  ///< else 1
  std::string over, along, point, output;
  studies::ContinuationRequest request;
};

Json branch_json(const results::NamedBranch& named) {
  const orbits::Branch& branch = named.branch;
  Json special = Json::array();
  for (const orbits::SpecialPoint& point : branch.special) {
    special.push_back(merged({{"kind", orbits::to_string(point.kind)},
                              {"multiplier", {point.multiplier.real(), point.multiplier.imag()}},
                              {"parameter", point.parameter}},
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
               {"complete", orbits::is_complete(branch.end)},
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
    const double first = branch.points.front().parameter, last = branch.points.back().parameter;
    const auto [least, most] = std::ranges::minmax(branch.points, {}, &orbits::BranchPoint::parameter);
    text += fmt::format(" from {:.10g} to {:.10g}", first, last);
    if (least.parameter < std::min(first, last) || most.parameter > std::max(first, last))
      text += fmt::format(" by way of {:.10g} … {:.10g}", least.parameter, most.parameter);
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
  if (branch.points.front().balance)
    text += "  ± is of the balance's own equations; by how much its orders miss such a point is not in it\n";
  return text;
}

/// What is continued, and where its branches go.
struct Followed {
  scene::Scene scene;
  std::string key;
  std::optional<pod::NamedBasis> basis;
  studies::ContinuationRequest request;
};

studies::BalanceContinuation balances_of(const Session& session, const OrbitContinueArguments& arguments,
                                         const Followed& followed, const studies::BalanceSearch& search) {
  const studies::OrbitSearch& own = arguments.search.search;
  return studies::continue_balance(followed.scene, followed.key, followed.basis, search, followed.request,
                                   arguments.every, {.segments = own.segments, .tolerance = own.tolerance},
                                   session.run_options());
}

studies::BalanceSearch balance_search_of(const OrbitContinueArguments& arguments) {
  return studies::balance_search(arguments.balance.words, arguments.search.start, arguments.search.search.order);
}

std::string balance_command(const OrbitContinueArguments& arguments, const Followed& followed) {
  return studies::command_of(followed.key, arguments.search.model, arguments.search.search, arguments.balance.words,
                             arguments.search.start, arguments.every, followed.request);
}

/// Where Newton's method found no balance to begin with.
Report no_balance(const Followed& followed, const studies::BalanceContinuation& found) {
  const studies::Family at_start(scene::set_key(followed.scene, followed.key, found.start), {}, followed.basis);
  return balance_report("orbit continue", at_start, found.found);
}

/// The branches stored and told; exit 3 where the main one was lost on its way, 130 where one was interrupted.
Report store_and_tell(const OrbitContinueArguments& arguments, const Followed& followed, const std::string& command,
                      double start, const std::shared_ptr<const std::vector<results::NamedBranch>>& branches) {
  const studies::Family model(followed.scene, {followed.key}, followed.basis);
  studies::content_of(model, start, branches, command).save(arguments.output);

  Report report;
  Json list = Json::array();
  for (const results::NamedBranch& branch : *branches) {
    list.push_back(branch_json(branch));
    report.text += branch_text(branch);
  }
  report.data = {
      {"verb", "orbit continue"},      {"model", model.title()},    {"file", arguments.output}, {"key", followed.key},
      {"from", followed.request.from}, {"to", followed.request.to}, {"start", start},           {"branches", list}};
  report.text += fmt::format("Branches: {}\n", arguments.output);
  if (studies::is_interrupted(*branches)) {
    incomplete(report, kInterrupted, "interrupted; what was found is kept");
  } else if (branches->front().branch.end == orbits::BranchEnd::kLost) {
    incomplete(report, kNumericalFailure, "the branch was lost before the end of its range; what was found is kept");
  }
  return report;
}

Report run_balance(const Session& session, const OrbitContinueArguments& arguments, const Followed& followed) {
  const studies::BalanceContinuation found = balances_of(session, arguments, followed, balance_search_of(arguments));
  if (found.branch.points.empty()) return no_balance(followed, found);
  const int harmonics = found.found.balance.harmonics;
  Report report = store_and_tell(arguments, followed, balance_command(arguments, followed), found.start,
                                 studies::branches_of(found));
  report.data["by"] = "balance";
  report.data["harmonics"] = harmonics;
  if (!found.certificate) return report;
  const orbits::BranchCertificate& certificate = *found.certificate;
  report.data["certificate"] = {
      {"certified", certificate.certified}, {"behind", certificate.behind}, {"worst", certificate.worst}};
  report.text += fmt::format(
      "Certificate: true error at most {:.3g} of a half range at the {} of {} points looked at "
      "that have an orbit behind\n",
      certificate.worst, certificate.behind, certificate.certified);
  Json trials = Json::array();
  for (const orbits::OrderTrial& trial : found.trials) trials.push_back(fields_json(trial));
  if (!trials.empty()) report.data["trials"] = trials;
  if (!found.found.met) {
    report.exit_code = kNumericalFailure;
    report.text = studies::not_met(found.trials) + "; what was found is kept\n" + report.text;
    report.data["message"] = report.text;
  }
  return report;
}

Report run_curves(const Session& session, const OrbitContinueArguments& arguments, const Followed& followed) {
  if (arguments.along.empty() || arguments.point.empty())
    throw InvalidInput(
        fmt::format("{0} needs {1} too: KIND of special point and second key, e.g. --point fold --along "
                    "drive.amplitude=0.5:2",
                    arguments.along.empty() ? "--point" : "--along", arguments.along.empty() ? "--along" : "--point"));
  const OrbitRange along = parse_range("--along", arguments.along, "drive.amplitude=0.5:2");
  studies::CurveRequest curve{.along = along.key, .from = along.from, .to = along.to};
  studies::read_point(arguments.point, curve);
  const studies::CurvePlane plane =
      studies::curve_plane(followed.scene, followed.key, followed.basis, followed.request, curve);
  const Followed there{plane.scene, followed.key, followed.basis, followed.request};
  const auto report = [&](std::vector<results::NamedBranch> branches, double start,
                          const orbits::ShootingOptions& shooting, const std::string& command) {
    const auto found = std::make_shared<const studies::SpecialCurves>(studies::special_curves(
        plane, std::move(branches), start, followed.request, curve, shooting, session.run_options()));
    Report out = curves_report(studies::plane_of(followed.scene, followed.key, followed.basis, curve, *found), found,
                               followed.request, curve, studies::command_of(command, curve), arguments.output);
    out.data["by"] = arguments.balance.by;
    return out;
  };
  if (arguments.balance.by == "balance") {
    const studies::BalanceSearch search = balance_search_of(arguments);
    studies::require_no_certificate(search);
    const studies::BalanceContinuation found = balances_of(session, arguments, there, search);
    if (found.branch.points.empty()) return no_balance(there, found);
    return report(*studies::branches_of(found), found.start, {.tolerance = arguments.search.search.tolerance},
                  balance_command(arguments, followed));
  }
  const studies::OrbitSearch search = search_of(arguments.search, there.scene);
  studies::Continuation found =
      studies::continue_orbit(there.scene, there.key, there.basis, search, there.request, session.run_options());
  if (!found.found.converged()) return not_found("orbit continue", found.found);
  return report(std::move(found.branches), found.start, studies::shooting_options(plane.family, search),
                studies::command_of(there.key, arguments.search.model, search, there.request));
}

Report run(const Session& session, const OrbitContinueArguments& arguments) {
  require_writable(arguments.output);
  const OrbitRange range = parse_range("--over", arguments.over, "drive.omega=1.8:0.3");
  const scene::Scene scene = session.load(arguments.search.scene);
  const studies::RunOptions run_options = session.run_options();
  Followed followed{scene, range.key, studies::model_basis(scene, arguments.search.model, run_options),
                    arguments.request};
  followed.request.from = range.from;
  followed.request.to = range.to;
  const bool curves = !arguments.along.empty() || !arguments.point.empty();
  const bool balances = arguments.balance.by == "balance";
  if (!balances) {
    require_no_balance_options(arguments.balance);
    if (arguments.every) throw InvalidInput("--every: of a balance's certificates; add --by balance --certify");
  }
  if (curves) return run_curves(session, arguments, followed);
  if (balances) return run_balance(session, arguments, followed);
  const studies::OrbitSearch search = search_of(arguments.search, scene);
  studies::Continuation found =
      studies::continue_orbit(scene, range.key, followed.basis, search, followed.request, run_options);
  if (!found.found.converged()) return not_found("orbit continue", found.found);
  return store_and_tell(arguments, followed,
                        studies::command_of(range.key, arguments.search.model, search, followed.request), found.start,
                        std::make_shared<const std::vector<results::NamedBranch>>(std::move(found.branches)));
}

}  // namespace

Verb add_orbit_continue(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("continue", "follow an orbit over one key of the scene");
  const auto arguments = std::make_shared<OrbitContinueArguments>();
  add_search_options(*command, arguments->search);
  add_balance_options(*command, arguments->balance, {"shooting", "balance"});
  command->add_option("--every", arguments->every, "with --certify: every so many points, and the last")
      ->check(within(kCount, true));
  command->add_option("--over", arguments->over, "key and range: KEY=FROM:TO")->required();
  command->add_option(
      "--point", arguments->point,
      fmt::format("special points to follow over --along too: {}; KIND:VALUE: only the one nearest to a "
                  "value of --over",
                  fmt::join(studies::followed_words(), ", ")));
  command->add_option("--along", arguments->along, "second key and range of --point: KEY=FROM:TO");
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  add_fields(*command, arguments->request);
  command->footer(
      "The branch starts at the scene's own value of the key when that lies in the range, and is then followed both "
      "ways; else at FROM.\n"
      "Example:\n  slipmode orbit continue datasets/backlash_sdof/scene.toml --over drive.omega=1.8:0.5 --start 2.5,0 "
      "--switch -o branch.h5\n  slipmode plot branch.h5 -o response.svg\n"
      "  slipmode orbit continue datasets/play_oscillator/scene.toml --over drive.omega=0.9:1.1 --by balance "
      "--harmonics 9 --certify -o balances.h5\n"
      "  slipmode orbit continue datasets/backlash_sdof/scene.toml --over drive.omega=0.9:1.8 --start 2.5,0 --point "
      "fold "
      "--along drive.amplitude=0.2:2 -o folds.h5\n"
      "  slipmode orbit continue datasets/play_oscillator/scene.toml --over drive.omega=0.9:1.3 --by balance --point "
      "fold --along drive.amplitude=0.5:2 -o folds.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
