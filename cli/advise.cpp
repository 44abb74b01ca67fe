#include <slipmode/results/trade_store.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/trade/effects.hpp>
#include <slipmode/trade/variants.hpp>
#include "cli/text_table.hpp"
#include "cli/trade_report.hpp"
#include "cli/trade_request.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <optional>

namespace slipmode::cli {
namespace {

struct AdviseArguments {
  std::string scene, output, measure, error = "1%";
};

std::vector<trade::Variant> variants_of(const scene::Scene& scene, const std::vector<trade::Effect>& effects) {
  std::vector<trade::Variant> all = {trade::as_it_stands(scene)};
  for (const trade::Effect& effect : effects) all.push_back(effect.without);
  return all;
}

std::string names_of(const std::vector<trade::Effect>& effects, const std::vector<trade::EffectAdvice>& advice,
                     trade::Verdict verdict) {
  std::string names;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (advice[i].verdict == verdict) names += (names.empty() ? "" : ", ") + effects[i].name;
  }
  return names;
}

/// What all effects come to, verdict by verdict.
std::string summary(const std::vector<trade::Effect>& effects, const std::vector<trade::EffectAdvice>& advice) {
  std::string text;
  const auto add = [&](trade::Verdict verdict, const std::string& words) {
    const std::string names = names_of(effects, advice, verdict);
    if (!names.empty()) text += fmt::format("{}: {}\n", words, names);
  };
  add(trade::Verdict::kNeeded, "The scene needs");
  add(trade::Verdict::kSpare, "It could leave out");
  add(trade::Verdict::kUnclear, "Not to be told from scatter");
  add(trade::Verdict::kFailed, "It does not run without");
  return text;
}

Json effect_json(const trade::Effect& effect, const trade::EffectAdvice& advice) {
  return {{"effect", effect.name},
          {"verdict", trade::to_string(advice.verdict)},
          {"measure", trade::to_string(advice.measure)},
          {"time_share", advice.time_share},
          {"sentence", advice.sentence}};
}

Report run(const Session& session, const AdviseArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  const double limit = parse_percent("--error", arguments.error);
  std::optional<trade::Measure> only;
  if (!arguments.measure.empty()) only = parse_measure(arguments.measure);
  const trade::Schedule schedule = trade::schedule_of(scene);
  const std::vector<trade::Effect> effects = trade::effects_of(scene);
  const std::vector<trade::Variant> variants = variants_of(scene, effects);
  std::optional<studies::ResultFile> file;
  if (!arguments.output.empty()) {
    file.emplace(arguments.output, scene, results::FileKind::kTrade, "slipmode advise", "", session.division(),
                 studies::Pieces{variants.size(), "configurations"});
  }
  trade::StudyOptions options{.schedule = schedule};
  options.parallel = session.run_options().parallel("advise");
  if (file) results::keep_in(*file->journal(), options);
  const trade::Study done = trade::study(scene, trade::as_it_stands(scene), variants, {}, options);
  if (file) file->finish([&](results::StoreWriter& writer) { results::store_study(writer, done, scene); });
  if (session.has_a_share()) return part_made(session, *file, arguments.output, "configurations");

  Report report;
  std::vector<trade::EffectAdvice> advice;
  Json list = Json::array();
  report.text = study_text(done, scene);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    advice.push_back(trade::advise(effects[i], done.rows.front(), done.rows[i + 1], limit, only));
    list.push_back(effect_json(effects[i], advice.back()));
    report.text += advice.back().sentence + '\n';
  }
  report.text += summary(effects, advice);
  report.data = {{"verb", "advise"}, {"limit_percent", limit}, {"effects", list}, {"study", to_json(done, scene)}};
  if (!file) return report;
  report.data["file"] = arguments.output;
  tell_resumed(session, file->resumed(), "configurations", report);
  report.text += fmt::format("Result: {}\n", arguments.output);
  return report;
}

}  // namespace

Verb add_advise(CLI::App& app) {
  CLI::App* command = app.add_subcommand("advise", "what a scene needs, and what it could leave out");
  const auto arguments = std::make_shared<AdviseArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)");
  command->add_option("--measure", arguments->measure,
                      "the one output that counts: dX, dE, points, spread, energy, stick; default: all");
  command->add_option("--error", arguments->error, "change of an output that matters; default 1%");
  command->footer("Example:\n  slipmode advise datasets/beam_12hz/scene.toml");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
