#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/periodicity.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Inside of the stores of sweeps and maps.
namespace slipmode::results::detail {

/// The values of a journal's line, written and read by one list of them: line(point.parameter, point.order). Reading
/// sets them, writing leaves them.
class Line {
 public:
  Line() = default;                                                 ///< to be written
  explicit Line(const JournalRecord& record) : record_(&record) {}  ///< to be read

  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }
  [[nodiscard]] const std::vector<double>& written() const { return written_; }

 private:
  void one(double& value) {
    if (record_ == nullptr) {
      written_.push_back(value);
      return;
    }
    if (at_ >= record_->values.size()) {
      throw InvalidInput(fmt::format("journal record {} {}: it is too short; remove the journal and start again",
                                     record_->table, record_->index));
    }
    value = record_->values[at_++];
  }
  template <class T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void one(T& value) {
    auto number = static_cast<double>(value);
    one(number);
    value = static_cast<T>(number);
  }
  void one(Eigen::VectorXd& values) {
    Eigen::Index size = values.size();
    one(size);
    values.resize(size);
    for (double& value : values) one(value);
  }
  void one(Eigen::MatrixXd& values) {
    Eigen::Index rows = values.rows();
    Eigen::VectorXd all = values.reshaped();
    (*this)(rows, all);
    values = all.reshaped(rows, rows > 0 ? all.size() / rows : 0);
  }
  template <class T>
  void one(std::vector<T>& values) {
    std::size_t size = values.size();
    one(size);
    values.resize(size);
    for (T& value : values) one(value);
  }
  template <class T>
  void one(std::optional<T>& value) {
    bool has = value.has_value();
    one(has);
    if (!has)
      value.reset();
    else if (!value)
      value.emplace();
    if (has) one(*value);
  }
  void one(dynamics::State& own) { (*this)(own.time, own.q, own.v, own.modes, own.internal); }
  void one(diagnostics::SlipState& own) { (*this)(own.time, own.contact, own.displacement); }
  void one(diagnostics::LyapunovExponent& own) { (*this)(own.nats, own.bits, own.error, own.renormalisations); }

  const JournalRecord* record_ = nullptr;
  std::size_t at_ = 0;
  std::vector<double> written_;
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

}  // namespace slipmode::results::detail
