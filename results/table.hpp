#pragma once

#include <slipmode/results/store.hpp>

#include <string>
#include <variant>
#include <vector>

namespace slipmode::results {

/// A named column of numbers or of texts.
struct Column {
  std::string name;  ///< a dataset name: letters, digits, '_' and '-'
  Meaning meaning;
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

/// Columns of equal length: what sweeps and comparisons store. A NaN stands for "no value" (say why in a text column).
struct Table {
  std::string description;
  std::vector<Column> columns;

  [[nodiscard]] std::size_t rows() const;
  /// @throws InvalidInput  when the column is missing (the message lists those there are) or is not of numbers / texts
  [[nodiscard]] const std::vector<double>& numbers(const std::string& name) const;
  [[nodiscard]] const std::vector<std::string>& texts(const std::string& name) const;
  [[nodiscard]] bool has(const std::string& name) const;
};

/// Writes each column as a dataset in `group`; their order is kept in its dataset `columns`.
/// @throws InvalidInput  for columns of different length, or two of one name
void save(StoreWriter& store, const std::string& group, const Table& table);
/// @throws InvalidInput  when the group is not a table
[[nodiscard]] Table load_table(const StoreReader& store, const std::string& group);

/// A vector as columns of tables, and JSON, take it.
[[nodiscard]] inline std::vector<double> values_of(const Eigen::VectorXd& values) {
  return {values.begin(), values.end()};
}

}  // namespace slipmode::results
