#include <slipmode/core/files.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/advice.hpp>
#include <slipmode/studies/result_file.hpp>
#include "cli/field_options.hpp"
#include "cli/json_values.hpp"
#include "cli/text_table.hpp"
#include "cli/trade_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <utility>

namespace slipmode::cli {
namespace {

struct AdviseArguments {
  std::string scene, output, write;
  studies::AdviceWords words;
};

constexpr std::array kQuestions = {trade::Question::kMotion, trade::Question::kStatistics};

std::string error_cell(const trade::Judgement& judgement) {
  return std::isnan(judgement.error) ? "–" : trade::error_text(judgement);
}

std::string time_cell(const studies::Advice& advice, const trade::Row& row) {
  return fixed(trade::time_share(advice.study, row), 2);
}

/// Row by row what was tried to be left out, each together with all before it.
std::string steps_text(const studies::Advice& advice) {
  if (advice.lean->steps.empty()) return "";
  TextTable table({"left out together, in this order", "", "furthest off", "time of a run"});
  for (const trade::Step& step : advice.lean->steps) {
    const trade::Row& row = advice.study.rows[step.row];
    table.add({advice.effects[step.effect].name, step.left_out ? "left out" : "stays",
               error_cell(trade::judge(row, advice.asked.ask)), time_cell(advice, row)});
  }
  if (advice.lean->verified) {
    const trade::Row& row = advice.study.rows[*advice.lean->verified];
    table.add(
        {"the whole, measured once more", "", error_cell(trade::judge(row, advice.asked.ask)), time_cell(advice, row)});
  }
  std::string text = table.str();
  for (const std::size_t effect : advice.lean->put_back) {
    text += fmt::format("{}: given back, as the whole did not keep to the bound.\n", advice.effects[effect].name);
  }
  return text;
}

std::string effects_text(const studies::Advice& advice) {
  TextTable table({"each alone", "for the motion", "off by", "for the statistics", "off by", "time of a run"});
  for (std::size_t e = 0; e < advice.effects.size(); ++e) {
    const trade::Row& row = advice.study.rows[advice.lean->alone[e]];
    std::vector<std::string> cells = {row.variant.name};
    for (const trade::Question question : kQuestions) {
      const trade::Judgement judgement = studies::judged(advice, e, question);
      const bool nothing = judgement.verdict == trade::Verdict::kUnclear && std::isnan(judgement.error);
      cells.emplace_back(nothing ? "–" : trade::to_string(judgement.verdict));
      cells.push_back(error_cell(judgement));
    }
    cells.push_back(time_cell(advice, row));
    table.add(std::move(cells));
  }
  const trade::Schedule& schedule = advice.study.schedule;
  return fmt::format(
      "Motion: dX, dE up to {:g} from {} shared starts. Statistics: points, spread, energy, stick over "
      "{:g}, mean of runs.\n{}{}",
      schedule.horizon, schedule.starts * schedule.runs, schedule.duration, table.str(), failures_text(advice.study));
}

Json judgement_json(const trade::Judgement& judgement) {
  return {{"verdict", trade::to_string(judgement.verdict)},
          {"measure", trade::to_string(judgement.measure)},
          {"error_percent", json_number(judgement.error)},
          {"noise_percent", json_number(judgement.noise)}};
}

Json effect_json(const studies::Advice& advice, std::size_t e) {
  const trade::Effect& effect = advice.effects[e];
  const trade::Row& row = advice.study.rows[advice.lean->alone[e]];
  Json out = merged({{"effect", effect.name}, {"kind", trade::to_string(effect.kind)}, {"row", row.variant.name}},
                    judgement_json(studies::judged(advice, e, advice.asked.ask.question)),
                    Json{{"time_share", json_number(trade::time_share(advice.study, row))}});
  for (const trade::Question question : kQuestions) {
    out[std::string(trade::to_string(question))] = judgement_json(studies::judged(advice, e, question));
  }
  return out;
}

Json step_json(const studies::Advice& advice, const trade::Step& step) {
  const trade::Row& row = advice.study.rows[step.row];
  return merged({{"effect", advice.effects[step.effect].name}, {"left_out", step.left_out}},
                judgement_json(trade::judge(row, advice.asked.ask)),
                Json{{"time_share", json_number(trade::time_share(advice.study, row))}});
}

Json lean_json(const studies::Advice& advice) {
  Json names = Json::array(), back = Json::array();
  for (const std::size_t e : advice.lean->left_out) names.push_back(advice.effects[e].name);
  for (const std::size_t e : advice.lean->put_back) back.push_back(advice.effects[e].name);
  Json out = {{"left_out", names}, {"given_back", back}};
  if (!advice.lean->verified) return out;
  const trade::Row& row = advice.study.rows[*advice.lean->verified];
  out.update(judgement_json(trade::judge(row, advice.asked.ask)));
  out["time_share"] = json_number(trade::time_share(advice.study, row));
  return out;
}

Report report_of(const studies::Advice& advice, const scene::Scene& scene) {
  const studies::Asked& asked = advice.asked;
  const std::string sentences = studies::advice_text(scene, advice);
  Report report;
  report.text = fmt::format("{}\n{}\n{}\n{}", scene.name(), sentences, steps_text(advice), effects_text(advice));
  Json effects = Json::array(), steps = Json::array();
  for (std::size_t e = 0; e < advice.effects.size(); ++e) effects.push_back(effect_json(advice, e));
  for (const trade::Step& step : advice.lean->steps) steps.push_back(step_json(advice, step));
  report.data = {{"verb", "advise"},
                 {"sentence", sentences},
                 {"question", trade::to_string(asked.ask.question)},
                 {"limit_percent", asked.ask.bound},
                 {"exponent", asked.exponent ? json_number(*asked.exponent) : Json()},
                 {"exponent_error", asked.exponent ? json_number(asked.exponent_error) : Json()},
                 {"parting_percent", asked.parting ? json_number(*asked.parting) : Json()},
                 {"lean", lean_json(advice)},
                 {"steps", steps},
                 {"effects", effects},
                 {"study", to_json(advice.study, scene)}};
  return report;
}

Report run(const Session& session, const AdviseArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  if (!arguments.write.empty()) require_writable(arguments.write);
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  const studies::AdviceRequest request = studies::advice_request(arguments.words);
  std::vector<trade::Effect> effects = trade::effects_of(scene);
  studies::ResultFile file(arguments.output, scene, results::FileKind::kTrade, studies::command_of(request),
                           studies::identity_of(request), session.division(),
                           studies::Pieces{effects.size(), "effects"}, studies::Unfinished::kKept);
  const studies::Advice advice =
      studies::advise(scene, std::move(effects), request, session.run_options(), file.journal());
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, scene, advice); });
  if (session.has_a_share()) return part_made(session, file.progress(), arguments.output, "configurations");

  Report report = report_of(advice, scene);
  tell_resumed(session, file.resumed(), "configurations", report);
  tell_file("Result", arguments.output, report);
  if (arguments.write.empty()) return report;
  const trade::Variant lean = studies::lean_variant(scene, advice);
  write_renamed(arguments.write, trade::scene_text(lean));
  report.data["scene"] = arguments.write;
  report.text += fmt::format("Scene: {}\n{}", arguments.write, how_to_run(lean, arguments.write));
  return report;
}

}  // namespace

Verb add_advise(CLI::App& app) {
  CLI::App* command = app.add_subcommand("advise", "what a scene requires, and what it can do without");
  const auto arguments = std::make_shared<AdviseArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)");
  add_fields(*command, arguments->words);
  command->add_option("--write", arguments->write, "write the scene with only what it requires (TOML)");
  command->footer(
      "Example:\n  slipmode advise datasets/chain10/scene.toml --error 2% --write lean.toml\n"
      "  slipmode advise datasets/beam_12hz/scene.toml --question statistics --error 5%");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
