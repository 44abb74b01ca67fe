#include <slipmode/studies/bases.hpp>
#include "cli/balance_report.hpp"
#include "cli/orbit_report.hpp"
#include "cli/orbit_search.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <memory>

namespace slipmode::cli {
namespace {

struct OrbitFindArguments {
  OrbitSearchArguments search;
  BalanceArguments balance;
  std::string output;
};

Report with_nothing_kept(Report report) {
  report.text += "Nothing was kept: -o orbit.h5 keeps it, for plot, info, report and orbit spectrum\n";
  return report;
}

Report run_balance(const OrbitFindArguments& arguments, const studies::Family& model) {
  const studies::OrbitSearch& search = arguments.search.search;
  const auto found = std::make_shared<const studies::BalanceFound>(studies::find_balance(
      model, studies::balance_search(arguments.balance.words, arguments.search.start, search.order),
      {.segments = search.segments, .tolerance = search.tolerance}));
  Report report = balance_report("orbit find", model, *found);
  if (!found->balance.converged) return report;
  if (arguments.output.empty()) return with_nothing_kept(report);
  studies::content_of(model, found).save(arguments.output);
  tell_file("Balance", arguments.output, report);
  return report;
}

Report run_mixed(const OrbitFindArguments& arguments, const studies::Family& model) {
  const studies::OrbitSearch& search = arguments.search.search;
  const studies::BalanceWords& words = arguments.balance.words;
  if (!arguments.output.empty() && !words.certify && !words.error)
    throw InvalidInput(fmt::format("-o {}: what is kept of a mixed orbit is the exact orbit behind it; add --certify",
                                   arguments.output));
  const auto found = std::make_shared<const studies::MixedFound>(
      studies::find_mixed(model, studies::mixed_search(words, arguments.search.start, search.order),
                          {.segments = search.segments, .tolerance = search.tolerance}));
  Report report = mixed_report(model, *found);
  if (arguments.output.empty()) return report;
  if (!found->certificate || !found->certificate->behind) {
    report.text += fmt::format("Nothing was kept in {}: no exact orbit was found\n", arguments.output);
    return report;
  }
  studies::content_of(model, found).save(arguments.output);
  tell_file("Exact orbit", arguments.output, report);
  return report;
}

Report run(const Session& session, const OrbitFindArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.search.scene);
  const studies::Family model(scene, {}, studies::model_basis(scene, arguments.search.model, session.run_options()));
  if (arguments.balance.by == "balance") return run_balance(arguments, model);
  if (arguments.balance.by == "mixed") return run_mixed(arguments, model);
  require_no_balance_options(arguments.balance);
  const dynamics::HybridSystem& system = model.own();
  const studies::OrbitSearch search = search_of(arguments.search, scene);
  session.run_options().check_interrupt();
  const orbits::ShootingResult result = studies::find_orbit(model, search);
  if (!result.converged()) return not_found("orbit find", result);

  const std::vector<orbits::Amplitude> amplitudes = orbits::contact_amplitudes(system, result.orbit);
  Report report;
  report.data = {{"verb", "orbit find"}, {"title", scene.title}, {"model", model.title()}};
  report.data.update(orbit_json(system, result.orbit, amplitudes));
  report.text = fmt::format("{}, {}: {}", scene.name(), model.title(), orbit_text(system, result.orbit, amplitudes));
  if (arguments.output.empty()) return with_nothing_kept(report);
  studies::content_of(model, std::make_shared<const orbits::PeriodicOrbit>(result.orbit)).save(arguments.output);
  tell_file("Orbit", arguments.output, report);
  return report;
}

}  // namespace

Verb add_orbit_find(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("find", "a periodic orbit, its multipliers and what it does");
  const auto arguments = std::make_shared<OrbitFindArguments>();
  add_search_options(*command, arguments->search);
  add_balance_options(*command, arguments->balance, {"shooting", "balance", "mixed"});
  command->add_option("-o,--output", arguments->output, "also store the orbit and one period of it (HDF5)");
  command->footer(
      "Example:\n  slipmode orbit find datasets/backlash_sdof/scene.toml --json\n"
      "  slipmode orbit find datasets/backlash_sdof/scene.toml --start 1.2,0.1 -o orbit.h5\n"
      "  slipmode orbit find datasets/chain10/scene.toml --set drive.speed=0.45\n"
      "  slipmode orbit find datasets/play_oscillator/scene.toml --by balance --harmonics auto --error 1e-4\n"
      "  slipmode orbit find datasets/jenkins_chain/scene.toml --by mixed --harmonics auto --error 1e-6");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
