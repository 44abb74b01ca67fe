#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::results {

/// Columns of a CSV file, read as far as asked for.
///
/// The first line names the columns; a unit may follow a name in brackets: "t [s],v [m/s]". Cells are parted by commas,
/// semicolons (a comma is then a decimal point) or tabs; lines that begin with # and empty lines are skipped.
class CsvFile {
 public:
  /// Reads the file and its header.
  /// @throws InvalidInput  when the file cannot be read, is not text, or its first line names no columns
  explicit CsvFile(std::filesystem::path path);

  struct Name {
    std::string name, unit;  ///< unit: empty if none is given
  };
  [[nodiscard]] const std::vector<Name>& names() const { return names_; }

  /// Number of the column from 0. @param wanted  its name, with or without unit, or its number from 1
  /// @throws InvalidInput  naming the columns there are
  [[nodiscard]] std::size_t column(const std::string& wanted) const;
  /// The column called t or time (in any case), or -1.
  [[nodiscard]] int time_column() const;

  /// Values of a column, NaN where a cell is empty or says nan [rows].
  /// @throws InvalidInput  naming the line of a cell that is no number, or of one that is missing
  [[nodiscard]] Eigen::VectorXd values(std::size_t column) const;
  /// Line of a row in the file, from 1.
  [[nodiscard]] std::size_t line(Eigen::Index row) const { return rows_[static_cast<std::size_t>(row)].line; }

 private:
  struct Row {
    std::size_t begin, end, line;  // of text_
  };

  std::filesystem::path path_;
  std::string text_;
  char separator_ = ',';
  std::vector<Name> names_;
  std::vector<Row> rows_;
};

}  // namespace slipmode::results
