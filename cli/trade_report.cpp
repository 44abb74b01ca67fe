#include "cli/trade_report.hpp"

#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::cli {
namespace {

using trade::Measure;
using trade::Row;
using trade::Study;

/// Values that are not finite have no number in JSON.
Json row_json(const Study& study, const Row& row, double duration) {
  Json errors = Json::object(), noise = Json::object();
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const std::string name(trade::to_string(static_cast<Measure>(m)));
    errors[name] = json_number(row.error[m]);
    noise[name] = json_number(row.noise[m]);
  }
  Json out = {{"name", row.variant.name},
              {"axis", trade::to_string(row.variant.axis)},
              {"error_percent", errors},
              {"noise_percent", noise},
              {"basis_s", row.basis_seconds},
              {"speed_up", json_number(trade::speed_up(study, row))},
              {"break_even_runs", json_number(trade::break_even(study, row, duration))}};
  out.update(fields_json(row.cost));
  if (!row.failure.empty()) out["failure"] = row.failure;
  return out;
}

std::string milliseconds(const trade::RunCost& cost) {
  if (std::isnan(cost.cpu)) return "–";
  const double spread = 50.0 * (cost.cpu_high - cost.cpu_low) / cost.cpu;
  return fmt::format("{:.3g} ± {:.0f} %", 1e3 * cost.cpu, spread);
}

std::string runs_text(double runs) {
  if (std::isnan(runs)) return "–";
  if (std::isinf(runs)) return "never";
  return runs == 0.0 ? "" : fmt::format("{:.0f}", std::ceil(runs));
}

std::string elsewhere_text(const Study& study) {
  if (study.elsewhere == 0) return "";
  return fmt::format(
      "{} of {} runs from other starts end on another motion than the scene's own start does; the scatter is "
      "that of the latter.\n",
      study.elsewhere, study.schedule.runs - 1);
}

}  // namespace

Json to_json(const Study& study, const scene::Scene& scene) {
  Json rows = Json::array();
  for (const Row& row : study.rows) rows.push_back(row_json(study, row, scene.time.duration));
  Json fronts = Json::object();
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    Json names = Json::array();
    for (const std::size_t i : trade::pareto_front(study.offers(measure))) names.push_back(study.rows[i].variant.name);
    fronts[std::string(trade::to_string(measure))] = names;
  }
  return merged(
      {{"reference", row_json(study, study.reference, scene.time.duration)}}, fields_json(study.schedule),
      Json{{"elsewhere", study.elsewhere}, {"dies_out", study.dies_out}, {"candidates", rows}, {"fronts", fronts}});
}

std::string study_text(const Study& study, const scene::Scene& scene) {
  std::vector<std::string> header = {"configuration"};
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    header.push_back(fmt::format("{} %", trade::to_string(static_cast<Measure>(m))));
  }
  for (const char* word : {"time ms", "faster", "set-up ms", "basis s", "pays after"}) header.emplace_back(word);
  TextTable table(std::move(header));
  std::vector<std::string> scatter = {"scatter of the reference"};
  for (const double value : study.reference.noise) scatter.push_back(trade::percent_text(value));
  scatter.push_back(milliseconds(study.reference.cost));
  table.add(std::move(scatter));
  for (const Row& row : study.rows) {
    if (!row.failure.empty()) continue;
    std::vector<std::string> cells = {row.variant.name};
    for (const double value : row.error) cells.push_back(trade::percent_text(value));
    cells.push_back(milliseconds(row.cost));
    cells.push_back(fixed(trade::speed_up(study, row), 2));
    cells.push_back(fmt::format("{:.2g}", 1e3 * row.cost.setup));
    cells.push_back(row.basis_seconds > 0.0 ? fmt::format("{:.2g}", row.basis_seconds) : "");
    if (row.variant.reduction) cells.push_back(runs_text(trade::break_even(study, row, scene.time.duration)));
    table.add(std::move(cells));
  }
  const std::string starts = study.dies_out ? fmt::format("the scene's start and {} about it", study.shared_starts - 1)
                                            : fmt::format("{} shared starts", study.shared_starts);
  const std::string others = study.dies_out ? "the motion dies out, statistics have nothing to be of"
                                            : fmt::format("the others over {:g}", study.schedule.duration);
  return fmt::format(
      "{}\nErrors against the {}; one axis varied at a time, reduced models in every basis and size.\n"
      "dX, dE up to {:g} from {}; {}; times are processor time of {:g}.\n{}{}{}",
      scene.name(), study.reference.variant.name, study.schedule.horizon, starts, others, study.schedule.timed,
      table.str(), failures_text(study), elsewhere_text(study));
}

Json to_json(const trade::OrbitStudy& study) {
  const auto row_of = [](const trade::OrbitRow& row) {
    return merged(fields_json(row), Json{{"axis", trade::to_string(row.axis)}});
  };
  Json rows = Json::array();
  for (const trade::OrbitRow& row : study.rows) rows.push_back(row_of(row));
  return {{"regimes", study.word}, {"reference", row_of(study.reference)}, {"rows", rows}};
}

std::string orbits_text(const trade::OrbitStudy& study) {
  TextTable table({"way to the periodic orbit", "error %", "time ms", "faster", ""});
  const auto add = [&](const trade::OrbitRow& row) {
    table.add({row.name, trade::percent_text(row.error),
               milliseconds({.cpu = row.cpu, .cpu_low = row.cpu_low, .cpu_high = row.cpu_high}),
               fixed(study.reference.cpu / row.cpu, 2), row.other.empty() ? "" : "another orbit: " + row.other});
  };
  add(study.reference);
  std::string failures;
  for (const trade::OrbitRow& row : study.rows) {
    if (row.failure.empty())
      add(row);
    else
      failures += fmt::format("  {}: {}\n", row.name, row.failure);
  }
  if (!study.reference.failure.empty()) failures += "  shooting: " + study.reference.failure + "\n";
  return fmt::format(
      "Periodic orbit \"{}\": error of the contacts' displacements over a period, of a half range; times from "
      "nothing.\n{}{}",
      study.word, table.str(), failures.empty() ? "" : "Without an error:\n" + failures);
}

std::string failures_text(const Study& study) {
  std::vector<std::pair<std::string, std::string>> reasons;  // each with those that it holds for, a line each
  for (const Row& row : study.rows) {
    if (row.failure.empty()) continue;
    auto known = std::ranges::find(reasons, row.failure, &std::pair<std::string, std::string>::first);
    if (known == reasons.end()) known = reasons.insert(known, {row.failure, ""});
    known->second += fmt::format("  {}\n", row.variant.name);
  }
  std::string text;
  for (const auto& [reason, names] : reasons) text += fmt::format("Could not be run: {}\n{}", reason, names);
  return text;
}

std::string how_to_run(const trade::Variant& variant, const std::string& path) {
  if (!variant.reduction) return fmt::format("  slipmode simulate {} -o run.h5\n", path);
  return fmt::format(
      "  [reduction] says the reduced model; 'slipmode run {} -o DIR' makes it, or step by step\n"
      "  slipmode simulate {} -o ensemble.h5; slipmode pod ensemble.h5 -o pod.h5; "
      "slipmode reduce {} pod.h5 -o reduced.h5\n",
      path, path, path);
}

}  // namespace slipmode::cli
