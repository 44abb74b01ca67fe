#include "cli/trade_report.hpp"

#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include "cli/json_values.hpp"
#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::cli {
namespace {

using trade::Measure;
using trade::Row;
using trade::Study;

/// The scene's model and the reference first, then all others.
std::vector<Row> all_rows(const Study& study) {
  std::vector<Row> rows = {study.reference};
  rows.insert(rows.end(), study.rows.begin(), study.rows.end());
  return rows;
}

template <class Value>
std::vector<double> numbers(const std::vector<Row>& rows, const Value& value) {
  std::vector<double> out;
  for (const Row& row : rows) out.push_back(static_cast<double>(value(row)));
  return out;
}

template <class Value>
std::vector<std::string> texts(const std::vector<Row>& rows, const Value& value) {
  std::vector<std::string> out;
  for (const Row& row : rows) out.push_back(std::string(value(row)));
  return out;
}

results::Table candidate_table(const Study& study, const scene::Scene& scene) {
  const std::vector<Row> rows = all_rows(study);
  results::Table table{.description = "configurations: errors against the first one, the reference, and times",
                       .columns = {}};
  auto& columns = table.columns;
  columns.push_back({"name", {"", "the configuration"}, texts(rows, [](const Row& r) { return r.variant.name; })});
  columns.push_back({"axis", {"", "in what it differs from the scene"}, texts(rows, [](const Row& r) {
                       return trade::to_string(r.variant.axis);
                     })});
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    const std::string name(trade::to_string(measure));
    columns.push_back({name, {"%", std::string(trade::describe(measure))}, numbers(rows, [&](const Row& r) {
                         return trade::at(r.error, measure);
                       })});
    columns.push_back({name + "_noise", {"%", "scatter of it"}, numbers(rows, [&](const Row& r) {
                         return trade::at(r.noise, measure);
                       })});
  }
  const auto add = [&](const std::string& name, const std::string& what, const auto& value) {
    columns.push_back({name, {"s", what, results::Meaning::Of::kClock}, numbers(rows, value)});
  };
  add("time", "processor time of a timed run, median", [](const Row& r) { return r.cost.cpu; });
  add("time_low", "its least", [](const Row& r) { return r.cost.cpu_low; });
  add("time_high", "its largest", [](const Row& r) { return r.cost.cpu_high; });
  add("wall", "time of the clock, median", [](const Row& r) { return r.cost.wall; });
  add("setup", "building, projection and modal data, once", [](const Row& r) { return r.cost.setup; });
  add("basis", "making the basis, once", [](const Row& r) { return r.basis_seconds; });
  columns.push_back({"break_even",
                     {"1", "runs of [time] after which basis and projection are paid for"},
                     numbers(rows, [&](const Row& r) { return trade::break_even(study, r, scene.time.duration); })});
  columns.push_back(
      {"failure", {"", "why it has no errors; empty: it has"}, texts(rows, [](const Row& r) { return r.failure; })});
  return table;
}

/// Values that are not finite have no number in JSON.
Json json_of(const Study& study, const Row& row, double duration) {
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
              {"time_s", json_number(row.cost.cpu)},
              {"time_low_s", row.cost.cpu_low},
              {"time_high_s", row.cost.cpu_high},
              {"wall_s", json_number(row.cost.wall)},
              {"setup_s", row.cost.setup},
              {"basis_s", row.basis_seconds},
              {"speed_up", json_number(trade::speed_up(study, row))},
              {"break_even_runs", json_number(trade::break_even(study, row, duration))}};
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

}  // namespace

void store_study(results::StoreWriter& writer, const Study& study, const scene::Scene& scene) {
  const std::string group = kTradeGroup;
  const std::string time = results::Units::of(scene.units).time;
  writer.describe_group(group, "speed against accuracy");
  results::save(writer, group + "/candidates", candidate_table(study, scene));
  writer.write(group + "/reference", study.reference.variant.name, {"", "what errors are measured against"});
  writer.write(group + "/timed", study.schedule.timed, {time, "simulated by a timed run"});
  writer.write(group + "/recorded", study.schedule.duration, {time, "recorded of a settled motion"});
  writer.write(group + "/horizon", study.schedule.horizon, {time, "of dX and dE"});
}

std::vector<std::string> recommendations(const Study& study, double limit) {
  std::vector<std::string> out;
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    out.push_back(trade::recommendation(study, static_cast<Measure>(m), limit));
  }
  return out;
}

Json to_json(const Study& study, const scene::Scene& scene) {
  Json rows = Json::array();
  for (const Row& row : study.rows) rows.push_back(json_of(study, row, scene.time.duration));
  Json fronts = Json::object();
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    Json names = Json::array();
    for (const std::size_t i : trade::pareto_front(study.offers(measure))) names.push_back(study.rows[i].variant.name);
    fronts[std::string(trade::to_string(measure))] = names;
  }
  return {{"reference", json_of(study, study.reference, scene.time.duration)},
          {"timed", study.schedule.timed},
          {"recorded", study.schedule.duration},
          {"horizon", study.schedule.horizon},
          {"candidates", rows},
          {"fronts", fronts}};
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
  std::string failures;
  for (const Row& row : study.rows) {
    if (!row.failure.empty()) {
      failures += fmt::format("  {}: {}\n", row.variant.name, row.failure);
      continue;
    }
    std::vector<std::string> cells = {row.variant.name};
    for (const double value : row.error) cells.push_back(trade::percent_text(value));
    cells.push_back(milliseconds(row.cost));
    cells.push_back(fixed(trade::speed_up(study, row), 2));
    cells.push_back(fmt::format("{:.2g}", 1e3 * row.cost.setup));
    cells.push_back(row.basis_seconds > 0.0 ? fmt::format("{:.2g}", row.basis_seconds) : "");
    if (row.variant.reduction) cells.push_back(runs_text(trade::break_even(study, row, scene.time.duration)));
    table.add(std::move(cells));
  }
  std::string text = fmt::format(
      "{}\nErrors against the {}; one axis varied at a time, reduced models in every basis and size.\n"
      "dX, dE up to {:g} from {} shared starts; the others over {:g}; times are processor time of {:g}.\n{}",
      scene.title, study.reference.variant.name, study.schedule.horizon, study.schedule.starts * study.schedule.runs,
      study.schedule.duration, study.schedule.timed, table.str());
  if (!failures.empty()) text += "Could not be run:\n" + failures;
  return text;
}

}  // namespace slipmode::cli
