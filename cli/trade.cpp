#include <slipmode/core/files.hpp>
#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/figures/trade_figures.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/trade_off.hpp>
#include "cli/field_options.hpp"
#include "cli/trade_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

struct TradeArguments {
  std::string scene, output, figures, write;
  studies::TradeWords words;
};

Report run(const Session& session, const TradeArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  if (!arguments.write.empty()) require_writable(arguments.write);
  if (!arguments.figures.empty()) figures::require_gnuplot();
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  studies::TradeRequest request = studies::trade_request(arguments.words, scene);
  if (!arguments.write.empty() && !request.chooses()) request.wish.limit = request.limit();
  const studies::TradePlan plan = studies::trade_plan(scene, request, session.run_options());
  studies::ResultFile file(arguments.output, scene, results::FileKind::kTrade, studies::command_of(request),
                           studies::identity_of(request), session.division(),
                           studies::Pieces{plan.variants.size(), "configurations known beforehand"},
                           studies::Unfinished::kKept);
  const studies::TradeFound found = studies::trade_off(scene, request, plan, session.run_options(), file.journal());
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, scene, request, found); });
  if (session.has_a_share()) return part_made(session, file.progress(), arguments.output, "configurations");

  const trade::Study& done = found.study;
  Report report;
  const std::vector<std::string> advice = found.recommendations(request.limit());
  report.data = {{"verb", "trade"}, {"trade", to_json(done, scene)}, {"recommendations", advice}};
  report.text = study_text(done, scene);
  if (found.orbits) {
    report.data["orbits"] = to_json(*found.orbits);
    report.text += orbits_text(*found.orbits);
  }
  for (const std::string& sentence : advice) report.text += sentence + '\n';
  tell_resumed(session, file.resumed(), "configurations", report);
  tell_file("Result", arguments.output, report);
  if (!arguments.figures.empty()) {
    report.data["figures"] = figures::save_trade_figures(done, scene, arguments.figures);
    report.text += fmt::format("Figures: {}\n", arguments.figures);
  }
  if (!request.chooses()) return report;
  const trade::Choice choice = trade::choose(done, request.wish);
  const trade::Row& row = done.rows[choice.row];
  report.data["choice"] = {{"name", row.variant.name}, {"sentence", choice.sentence}};
  if (std::ranges::find(advice, choice.sentence) == advice.end()) report.text += choice.sentence + '\n';
  if (arguments.write.empty()) return report;
  write_renamed(arguments.write, trade::scene_text(row.variant));
  report.data["scene"] = arguments.write;
  report.text += fmt::format("Scene: {}\n{}", arguments.write, how_to_run(row.variant, arguments.write));
  return report;
}

}  // namespace

Verb add_trade(CLI::App& app) {
  CLI::App* command = app.add_subcommand("trade", "speed against accuracy: what is how wrong, and how costly");
  const auto arguments = std::make_shared<TradeArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)");
  command->add_option("--figures", arguments->figures, "folder for a Pareto front of each measure; made if missing");
  add_fields(*command, arguments->words);
  command->add_option("--write", arguments->write, "write what was picked as a scene (TOML)");
  command->footer(
      "Example:\n  slipmode trade datasets/chain10/scene.toml -o trade.h5 --figures out/trade\n"
      "  slipmode trade datasets/chain10/scene.toml --error 1% --write fast.toml");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
