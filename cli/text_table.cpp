#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {

std::string significant(double value, int digits) {
  return std::isnan(value) ? "–" : fmt::format("{:.{}g}", value, digits);
}

std::string fixed(double value, int digits) { return std::isnan(value) ? "–" : fmt::format("{:.{}f}", value, digits); }

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], shown_width(row[i]));
  }
  std::size_t first = 0;
  for (const Group& group : groups_) {
    std::size_t span = 2 * (group.columns - 1);
    for (std::size_t i = first; i < first + group.columns; ++i) span += widths[i];
    const std::size_t needed = shown_width(group.title);
    if (needed > span) widths[first] += needed - span;
    first += group.columns;
  }
  return widths;
}

std::string TextTable::group_line(const std::vector<std::size_t>& widths) const {
  std::string out;
  std::size_t first = 0;
  for (const Group& group : groups_) {
    std::size_t span = 2 * (group.columns - 1);
    for (std::size_t i = first; i < first + group.columns; ++i) span += widths[i];
    first += group.columns;
    const std::size_t rest = span - shown_width(group.title);
    const char rule = group.title.empty() ? ' ' : '-';
    const std::size_t left = rest / 2, right = rest - rest / 2;
    out += "  " + std::string(left, rule) + group.title + std::string(right, rule);
  }
  return out + '\n';
}

std::string TextTable::str() const {
  const std::vector<std::size_t> column_widths = widths();
  std::string out = groups_.empty() ? std::string() : group_line(column_widths);
  const auto line = [&](const std::vector<std::string>& row) {
    for (std::size_t i = 0; i < column_widths.size(); ++i) {
      const std::string cell = i < row.size() ? row[i] : std::string();
      const std::size_t padding = column_widths[i] - shown_width(cell);
      out.append(i == 0 ? 2 : 2 + padding, ' ').append(cell).append(i == 0 ? padding : 0, ' ');
    }
    out.erase(out.find_last_not_of(' ') + 1);
    out += '\n';
  };
  line(rows_.front());
  std::size_t total = 0;
  for (const std::size_t width : column_widths) total += width + 2;
  out += "  " + std::string(total - 2, '-') + '\n';
  for (std::size_t i = 1; i < rows_.size(); ++i) line(rows_[i]);
  return out;
}

}  // namespace slipmode::cli
