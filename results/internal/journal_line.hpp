#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/diagnostics/attractors/periodicity.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/results/journal.hpp>

#include <fmt/format.h>
#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
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
  [[nodiscard]] bool reads() const { return record_ != nullptr; }
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
    Eigen::Index rows = values.rows(), columns = values.cols();
    (*this)(rows, columns);
    values.resize(rows, columns);
    if (!reads()) written_.reserve(written_.size() + static_cast<std::size_t>(values.size()));
    for (double& value : values.reshaped()) one(value);
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

/// A sink that keeps finished values in a journal, one table per model, and gives back those it already holds; other
/// tables are left alone. The journal must outlive it.
/// What the journal leaves to other processes, the sink leaves.
/// @param table  "sweep", …: what the values are of
/// @param list   void(Line&, SweptValue<Result>&): what a record holds after the parameter. The record's note is the
///               failure
template <class Result, class List>
SinkOf<Result> table_sink(Journal& journal, const std::string& table, const List& list) {
  struct Kept {
    std::map<std::pair<std::size_t, int>, SweptValue<Result>> values;
    std::size_t read = 0;  // records: others may come while a sweep is shared
  };
  const auto read = [&journal, table, list](Kept& kept) {
    for (; kept.read < journal.records().size(); ++kept.read) {
      const JournalRecord& record = journal.records()[kept.read];
      const std::size_t dash = record.table.rfind('-');
      if (dash == std::string::npos || record.table.substr(0, dash) != table) continue;
      SweptValue<Result> value{.index = static_cast<std::size_t>(record.index),
                               .model = std::stoi(record.table.substr(dash + 1)),
                               .failure = record.note};
      Line line(record);
      line(value.parameter);
      list(line, value);
      kept.values.insert_or_assign({value.index, value.model}, std::move(value));
    }
  };
  return {.recall = [read, kept = std::make_shared<Kept>()](std::size_t index,
                                                            int model) -> std::optional<SweptValue<Result>> {
            read(*kept);
            const auto found = kept->values.find({index, model});
            return found == kept->values.end() ? std::nullopt : std::optional(found->second);
          },
          .store =
              [&journal, table, list](SweptValue<Result> value) {
                Line line;
                line(value.parameter);
                list(line, value);
                journal.append({fmt::format("{}-{}", table, value.model), static_cast<std::int64_t>(value.index),
                                line.written(), std::move(value.failure)});
              },
          .leave =
              [&journal, table](std::size_t piece, std::size_t index, int model, double parameter) {
                return journal.leaves(
                    piece, {fmt::format("{}-{}", table, model), static_cast<std::int64_t>(index), {parameter}, ""});
              },
          .sharing = journal.sharing()};
}

}  // namespace slipmode::results::detail
