#include <slipmode/core/files.hpp>
#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/figures/trade_figures.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/trade_store.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/trade/variants.hpp>
#include "cli/trade_report.hpp"
#include "cli/trade_request.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>

namespace slipmode::cli {
namespace {

constexpr double kLimit = 1.0;  // percent, where none is asked for

struct TradeArguments {
  std::string scene, output, figures, axes, budget, error, write;
  std::string measure = "dE";
  bool product = false;
};

trade::Wish wish_of(const TradeArguments& arguments, const scene::Scene& scene) {
  trade::Wish wish{.measure = parse_measure(arguments.measure), .duration = scene.time.duration};
  if (!arguments.error.empty()) wish.limit = parse_percent("--error", arguments.error);
  if (!arguments.budget.empty()) wish.budget = parse_duration("--budget", arguments.budget);
  if (!arguments.write.empty() && !wish.limit && !wish.budget) wish.limit = kLimit;
  return wish;
}

/// The scene as it stands first; --axes decides about the others.
std::vector<trade::Variant> variants_of(const scene::Scene& scene, const std::vector<trade::Axis>& axes,
                                        const std::vector<trade::OfferedBasis>& bases, bool product) {
  std::vector<trade::Variant> all = {trade::as_it_stands(scene)};
  for (const trade::Axis axis : axes) std::ranges::move(trade::along(axis, scene, bases), std::back_inserter(all));
  if (product) std::ranges::move(trade::product(all), std::back_inserter(all));
  return all;
}

Report run(const Session& session, const TradeArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  if (!arguments.write.empty()) require_writable(arguments.write);
  if (!arguments.figures.empty()) figures::require_gnuplot();
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  const trade::Wish wish = wish_of(arguments, scene);
  const std::vector<trade::Axis> available = trade::axes_of(scene);
  const std::vector<trade::Axis> axes =
      arguments.axes.empty() ? available : trade::parse_axes(arguments.axes, available);
  trade::Schedule schedule = trade::schedule_of(scene);
  const bool reduces = std::ranges::find(axes, trade::Axis::kModes) != axes.end();
  const auto bases =
      reduces ? studies::offered_bases(scene, session.run_options()) : std::vector<trade::OfferedBasis>();
  session.check_interrupt();
  const double limit = wish.limit.value_or(kLimit);

  const std::vector<trade::Variant> variants = variants_of(scene, axes, bases, arguments.product);
  std::string identity;
  for (const trade::Axis axis : axes) identity += trade::to_string(axis);
  studies::ResultFile file(arguments.output, scene, results::FileKind::kTrade,
                           fmt::format("slipmode trade{}", arguments.product ? " --product" : ""), identity,
                           session.division(), studies::Pieces{variants.size(), "configurations known beforehand"},
                           studies::Unfinished::kKept);
  trade::StudyOptions options{.schedule = schedule};
  options.parallel = session.run_options().parallel("trade");
  if (file.journal() != nullptr) results::keep_in(*file.journal(), options);
  if (!arguments.product) {
    options.more = [&](const std::vector<trade::Row>& rows) { return trade::worth_combining(rows, limit); };
  }
  const trade::Study done = trade::study(scene, trade::reference_of(scene), variants, bases, options);
  file.finish([&](results::StoreWriter& writer) { results::store_study(writer, done, scene); });
  if (session.has_a_share()) return part_made(session, file, arguments.output, "configurations");

  Report report;
  const std::vector<std::string> advice = recommendations(done, limit);
  report.data = {{"verb", "trade"}, {"trade", to_json(done, scene)}, {"recommendations", advice}};
  report.text = study_text(done, scene);
  for (const std::string& sentence : advice) report.text += sentence + '\n';
  tell_resumed(session, file.resumed(), "configurations", report);
  if (!arguments.output.empty()) {
    report.data["file"] = arguments.output;
    report.text += fmt::format("Result: {}\n", arguments.output);
  }
  if (!arguments.figures.empty()) {
    report.data["figures"] = figures::save_trade_figures(done, scene, arguments.figures);
    report.text += fmt::format("Figures: {}\n", arguments.figures);
  }
  if (!wish.limit && !wish.budget) return report;
  const trade::Choice choice = trade::choose(done, wish);
  const trade::Row& row = done.rows[choice.row];
  report.data["choice"] = {{"name", row.variant.name}, {"sentence", choice.sentence}};
  report.text += choice.sentence + '\n';
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
  command->add_option("--axes", arguments->axes,
                      "what is varied: modes, flow, theory, elements, law, load; default: all the scene has");
  command->add_flag("--product", arguments->product,
                    "every reduced model with every flow, not only the promising ones");
  command->add_option("--measure", arguments->measure, "what --error limits: dX, dE, points, spread, energy, stick");
  command->add_option("--error", arguments->error, "pick the cheapest that keeps to it, e.g. 1%");
  command->add_option("--budget", arguments->budget,
                      "pick the most accurate whose run of [time] takes no more processor time, e.g. 10s");
  command->add_option("--write", arguments->write, "write what was picked as a scene (TOML)");
  command->footer(
      "Example:\n  slipmode trade datasets/chain10/scene.toml -o trade.h5 --figures out/trade\n"
      "  slipmode trade datasets/chain10/scene.toml --error 1% --write fast.toml");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
