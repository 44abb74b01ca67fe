#include <slipmode/core/kernels/kernels.hpp>

#include "cli/json_values.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"
#include "selftest/cases.hpp"
#include "selftest/scene_properties.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct Request {
  bool extremes = false, with_long = false;
  std::uint64_t scenes = 0, first = 0;
};

/// 300 scenes at a time, so that Ctrl-C is heard and progress seen.
constexpr std::uint64_t kBlock = 300;
/// Without options: a short look.
constexpr std::uint64_t kDefaultScenes = 300;

Json result_json(const selftest::ExtremeResult& result) {
  Json row = {{"case", result.name},
              {"law", result.law},
              {"measured", json_number(result.measured)},
              {"limit", result.limit},
              {"ok", result.holds}};
  if (!result.note.empty()) row["note"] = result.note;
  return row;
}

/// Adds the table of extremes. @return how many do not hold
int add_extremes(const Session& session, const Request& request, Report& out) {
  const auto cases = selftest::extreme_cases();
  ProgressLine line("extremes", session.progress_mode());
  TextTable table({"case", "measured", "limit", "ok", "law"});
  Json rows = Json::array();
  int failed = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    session.run_options().check_interrupt();
    line.update(i, cases.size());
    if (cases[i].is_long && !request.with_long) continue;
    const selftest::ExtremeResult result = selftest::run_case(cases[i]);
    failed += result.holds ? 0 : 1;
    table.add({result.name, fmt::format("{:.2g}", result.measured), fmt::format("{:.2g}", result.limit),
               result.holds ? "yes" : "NO", result.note.empty() ? result.law : result.law + ": " + result.note});
    rows.push_back(result_json(result));
  }
  line.update(cases.size(), cases.size());
  out.text += table.str() + fmt::format("{} of {} cases hold\n", static_cast<int>(rows.size()) - failed, rows.size());
  out.data["extremes"] = std::move(rows);
  return failed;
}

/// Adds the survey of random scenes. @return how many have a violation
int add_scenes(const Session& session, const Request& request, Report& out) {
  const std::uint64_t seed = session.seed.value_or(1);
  ProgressLine line("random scenes", session.progress_mode());
  selftest::SceneSurvey all;
  for (std::uint64_t done = 0; done < request.scenes; done += kBlock) {
    line.update(done, request.scenes);
    all.merge(selftest::survey_random_scenes(seed, request.first + done, std::min(kBlock, request.scenes - done),
                                             {.threads = session.threads, .stop = session.stop}));
  }
  line.update(request.scenes, request.scenes);
  Json failed = Json::array();
  for (const selftest::SceneCheck& check : all.failed) {
    for (const selftest::Violation& violation : check.violations) {
      failed.push_back({{"scene", check.index}, {"property", violation.property}, {"what", violation.what}});
      out.text += fmt::format("scene {}: {}: {}\n", check.index, violation.property, violation.what);
    }
  }
  std::int64_t refused = 0;
  std::string reasons;
  for (const auto& [reason, count] : all.refused) {
    refused += count;
    reasons += fmt::format("{}{} {}", reasons.empty() ? " (" : ", ", count, reason);
  }
  if (!reasons.empty()) reasons += ")";
  out.text += fmt::format(
      "{} random scenes of seed {}: {} with a violation, {} refused with a message{}, {} in which nothing moves, {} in "
      "which rounding says what follows\n"
      "  {} events; guards looked at {} times, deepest {:.1g} below zero; forces off their law by {:.1g}\n"
      "  equations of motion to {:.1g}, energy to {:.1g}, runs taken up at an event to {:.1g}, cut in two to {:.1g}, "
      "all modes to {:.1g}\n"
      "  digest {:016x}, the same for any number of threads\n",
      all.scenes, seed, all.failed.size(), refused, reasons, all.still, all.coasting, all.scan.events, all.scan.samples,
      all.scan.guard, all.scan.law, all.scan.motion, all.energy, all.restart, all.cut, all.reduction, all.digest);
  out.data["scenes"] = {{"seed", seed},
                        {"first", request.first},
                        {"count", all.scenes},
                        {"refused", refused},
                        {"refusals", all.refused},
                        {"still", all.still},
                        {"coasting", all.coasting},
                        {"events", all.scan.events},
                        {"samples", all.scan.samples},
                        {"guard", all.scan.guard},
                        {"law", all.scan.law},
                        {"motion", all.scan.motion},
                        {"energy", all.energy},
                        {"restart", all.restart},
                        {"cut", all.cut},
                        {"reduction", all.reduction},
                        {"digest", fmt::format("{:016x}", all.digest)},
                        {"violations", std::move(failed)}};
  return static_cast<int>(all.failed.size());
}

Report selftest(const Session& session, Request request) {
  static_cast<void>(kernels::kernels());  // one that is refused is no violation of each scene
  if (!request.extremes && request.scenes == 0) request.scenes = kDefaultScenes;
  Report report;
  int failed = 0;
  if (request.extremes) failed += add_extremes(session, request, report);
  if (request.scenes > 0) failed += add_scenes(session, request, report);
  report.data["failed"] = failed;
  if (failed > 0) report.exit_code = kNumericalFailure;
  return report;
}

}  // namespace

Verb add_selftest(CLI::App& app) {
  CLI::App* command = app.add_subcommand("selftest", "check this build at the extremes and on random scenes");
  const auto request = std::make_shared<Request>();
  command->add_flag("--extremes", request->extremes, "the table of extremes, each beside its expected law");
  command->add_flag("--long", request->with_long, "with it those that take more than a few seconds");
  command->add_option("--scenes", request->scenes, "random scenes to check (default 300 without --extremes)");
  command->add_option("--first", request->first, "index of the first of them; --seed says which (default 1)");
  command->footer(
      "Exit code 3 if a case does not hold or a scene has a violation.\n"
      "Example:\n  slipmode selftest --extremes\n  slipmode selftest --scenes 100000 --seed 1");
  return {.command = command,
          .run = [request](const Session& session) { return selftest(session, *request); },
          .reads_scene = false};
}

}  // namespace slipmode::cli
