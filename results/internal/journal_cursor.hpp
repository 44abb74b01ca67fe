#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Inside of the stores of sweeps and maps: values of a journal's line, written and read in one order.
namespace slipmode::results::detail {

/// Reads the values of a record one after the other.
class Cursor {
 public:
  explicit Cursor(const JournalRecord& record) : record_(record) {}
  double next() {
    if (at_ >= record_.values.size()) {
      throw InvalidInput(fmt::format("journal record {} {}: it is too short; remove the journal and start again",
                                     record_.table, record_.index));
    }
    return record_.values[at_++];
  }
  int next_int() { return static_cast<int>(next()); }
  Eigen::VectorXd next_vector() {
    Eigen::VectorXd values(static_cast<Eigen::Index>(next()));
    for (double& value : values) value = next();
    return values;
  }
  Eigen::MatrixXd next_matrix() {
    const auto rows = static_cast<Eigen::Index>(next());
    const Eigen::VectorXd values = next_vector();
    return values.reshaped(rows, rows > 0 ? values.size() / rows : 0);
  }
  dynamics::State next_state() {
    dynamics::State state;
    state.time = next();
    state.q = next_vector();
    state.v = next_vector();
    state.modes.resize(static_cast<std::size_t>(next()));
    for (auto& mode : state.modes) mode = static_cast<dynamics::ContactMode>(next_int());
    state.internal = next_vector();
    return state;
  }

 private:
  const JournalRecord& record_;
  std::size_t at_ = 0;
};

inline void append(std::vector<double>& values, const Eigen::VectorXd& vector) {
  values.push_back(static_cast<double>(vector.size()));
  values.insert(values.end(), vector.begin(), vector.end());
}

inline void append(std::vector<double>& values, const Eigen::MatrixXd& matrix) {
  values.push_back(static_cast<double>(matrix.rows()));
  append(values, Eigen::VectorXd(matrix.reshaped()));
}

inline void append(std::vector<double>& values, const dynamics::State& state) {
  values.push_back(state.time);
  append(values, state.q);
  append(values, state.v);
  values.push_back(static_cast<double>(state.modes.size()));
  for (const auto mode : state.modes) values.push_back(static_cast<double>(mode));
  append(values, state.internal);
}

/// A sink that keeps finished values in a journal, one table per model, and gives back those it already holds; other
/// tables are left alone. The journal must outlive it.
/// @param table  "sweep", …: what the values are of
/// @param write  std::string(std::vector<double>&, const SweptValue<Result>&): adds what a record holds after the
///               parameter; the record's note, as a rule the failure
/// @param read   void(Cursor&, SweptValue<Result>&): the same back, in the same order; finds the note as the failure
template <class Result, class Write, class Read>
SinkOf<Result> table_sink(Journal& journal, const std::string& table, const Write& write, const Read& read) {
  auto kept = std::make_shared<std::map<std::pair<std::size_t, int>, SweptValue<Result>>>();
  for (const JournalRecord& record : journal.records()) {
    const std::size_t dash = record.table.rfind('-');
    if (dash == std::string::npos || record.table.substr(0, dash) != table) continue;
    Cursor cursor(record);
    SweptValue<Result> value{.index = static_cast<std::size_t>(record.index),
                             .model = std::stoi(record.table.substr(dash + 1)),
                             .parameter = cursor.next(),
                             .failure = record.note};
    read(cursor, value);
    kept->insert_or_assign({value.index, value.model}, std::move(value));
  }
  return {.recall = [kept](std::size_t index, int model) -> std::optional<SweptValue<Result>> {
            const auto found = kept->find({index, model});
            return found == kept->end() ? std::nullopt : std::optional(found->second);
          },
          .store =
              [&journal, table, write](const SweptValue<Result>& value) {
                std::vector<double> values = {value.parameter};
                std::string note = write(values, value);
                journal.append({fmt::format("{}-{}", table, value.model), static_cast<std::int64_t>(value.index),
                                std::move(values), std::move(note)});
              }};
}

}  // namespace slipmode::results::detail
