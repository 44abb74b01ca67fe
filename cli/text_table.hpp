#pragma once

#include <slipmode/core/terminal.hpp>

#include <string>
#include <vector>

namespace slipmode::cli {

/// A table for a terminal: columns as wide as needed, first column to the left, the others to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  /// A title over `columns` columns, centred; the next group stands to its right. An empty title leaves a gap.
  void group(std::string title, std::size_t columns) { groups_.push_back({std::move(title), columns}); }
  /// One cell per column; missing cells are empty.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// The lines, each ended by a line break, the header underlined.
  [[nodiscard]] std::string str() const;

 private:
  struct Group {
    std::string title;
    std::size_t columns = 1;
  };

  [[nodiscard]] std::vector<std::size_t> widths() const;
  [[nodiscard]] std::string group_line(const std::vector<std::size_t>& widths) const;

  std::vector<Group> groups_;
  std::vector<std::vector<std::string>> rows_;
};

/// A value with `digits` after the point, "–" for NaN.
[[nodiscard]] std::string fixed(double value, int digits);
/// A number with so many significant digits, or a dash for NaN.
[[nodiscard]] std::string significant(double value, int digits);

}  // namespace slipmode::cli
