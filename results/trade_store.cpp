#include <slipmode/results/trade_store.hpp>

#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/trade/advice.hpp>
#include "results/internal/field_record.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::results {
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
  out.reserve(rows.size());
  for (const Row& row : rows) out.push_back(static_cast<double>(value(row)));
  return out;
}

template <class Own, class Value>
std::vector<std::string> texts(const std::vector<Own>& rows, const Value& value) {
  std::vector<std::string> out;
  out.reserve(rows.size());
  for (const Own& row : rows) out.push_back(std::string(value(row)));
  return out;
}

Table candidate_table(const Study& study, const scene::Scene& scene) {
  const std::vector<Row> rows = all_rows(study);
  Table table{.description = "configurations: errors against the first one, the reference, and times", .columns = {}};
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
  std::ranges::move(columns_of(rows, &Row::cost), std::back_inserter(columns));
  columns.push_back({"basis", {"s", "making the basis, once", Meaning::Of::kClock}, numbers(rows, [](const Row& r) {
                       return r.basis_seconds;
                     })});
  columns.push_back({"break_even",
                     {"1", "runs of [time] after which basis and projection are paid for"},
                     numbers(rows, [&](const Row& r) { return trade::break_even(study, r, scene.time.duration); })});
  columns.push_back(
      {"failure", {"", "why it has no errors; empty: it has"}, texts(rows, [](const Row& r) { return r.failure; })});
  return table;
}

constexpr const char* kTable = "errors";

/// The note is the name, and on a second line why it failed.
JournalRecord to_record(const std::string& name, const trade::Finished& finished) {
  JournalRecord record{.table = kTable, .values = {}, .note = name};
  if (!finished.failure.empty()) record.note += '\n' + finished.failure;
  record.values.assign(finished.error.begin(), finished.error.end());
  record.values.insert(record.values.end(), finished.noise.begin(), finished.noise.end());
  return record;
}

std::optional<trade::Finished> recalled(const Journal& journal, const std::string& name) {
  for (const JournalRecord& record : journal.records()) {
    const std::size_t end = std::min(record.note.find('\n'), record.note.size());
    if (record.table != kTable || record.note.substr(0, end) != name) continue;
    if (record.values.size() != 2 * trade::kMeasures) continue;
    trade::Finished finished;
    if (end < record.note.size()) finished.failure = record.note.substr(end + 1);
    const auto middle = record.values.begin() + static_cast<std::ptrdiff_t>(trade::kMeasures);
    std::copy(record.values.begin(), middle, finished.error.begin());
    std::copy(middle, record.values.end(), finished.noise.begin());
    return finished;
  }
  return std::nullopt;
}

}  // namespace

void keep_in(Journal& journal, trade::StudyOptions& out_options) {
  out_options.recall = [&journal](const std::string& name) { return recalled(journal, name); };
  out_options.store = [&journal](const std::string& name, const trade::Finished& finished) {
    journal.append(to_record(name, finished));
  };
  out_options.leave = [&journal](std::size_t number, const std::string& name) {
    return journal.leaves(number, {.table = kTable, .values = {}, .note = name});
  };
  out_options.sharing = journal.sharing();
}

void store_study(StoreWriter& writer, const trade::Study& study, const scene::Scene& scene) {
  const std::string group = kTradeGroup;
  writer.describe_group(group, "speed against accuracy");
  save(writer, group + "/candidates", candidate_table(study, scene));
  writer.write(group + "/reference", study.reference.variant.name, {"", "what errors are measured against"});
  save_fields(writer, group, study.schedule);
  writer.write(group + "/elsewhere", static_cast<double>(study.elsewhere),
               {"", "runs of the reference that end on another motion than the scene's own start does"});
  writer.write(
      group + "/dies_out", study.dies_out ? 1.0 : 0.0,
      {"", "1: the motion dies out, errors are from the scene's start on, and statistics have nothing to be of"});
}

void store_orbits(StoreWriter& writer, const trade::OrbitStudy& study) {
  std::vector<trade::OrbitRow> rows = {study.reference};
  rows.insert(rows.end(), study.rows.begin(), study.rows.end());
  Table table{"ways to the periodic orbit: errors against the first one, shooting, and times", columns_of(rows)};
  table.columns.push_back({"axis", {"", "in what it differs"}, texts(rows, [](const trade::OrbitRow& row) {
                             return trade::to_string(row.axis);
                           })});
  save(writer, fmt::format("{}/orbits", kTradeGroup), table);
  writer.write(fmt::format("{}/regimes", kTradeGroup), study.word, {"", "of the periodic orbit"});
}

}  // namespace slipmode::results
