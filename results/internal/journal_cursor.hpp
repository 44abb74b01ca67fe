#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
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

/// Finished values by the key a runner recalls them with; a copy shares them.
template <class Value, class... Key>
class Kept {
 public:
  void keep(const std::tuple<Key...>& key, Value value) { values_->insert_or_assign(key, std::move(value)); }
  std::optional<Value> operator()(Key... key) const {
    const auto found = values_->find({key...});
    return found == values_->end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::shared_ptr<std::map<std::tuple<Key...>, Value>> values_ =
      std::make_shared<std::map<std::tuple<Key...>, Value>>();
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

}  // namespace slipmode::results::detail
