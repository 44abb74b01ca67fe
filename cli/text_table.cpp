#include "cli/text_table.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {

std::size_t shown_width(const std::string& text) {
  const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_character));
}

std::string fixed(double value, int digits) { return std::isnan(value) ? "–" : fmt::format("{:.{}f}", value, digits); }

std::string TextTable::str() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], shown_width(row[i]));
  }
  std::string out;
  const auto line = [&](const std::vector<std::string>& row) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::string cell = i < row.size() ? row[i] : std::string();
      const std::string padding(widths[i] - shown_width(cell), ' ');
      out += i == 0 ? "  " + cell + padding : "  " + padding + cell;
    }
    out.erase(out.find_last_not_of(' ') + 1);
    out += '\n';
  };
  line(rows_.front());
  std::size_t total = 0;
  for (const std::size_t width : widths) total += width + 2;
  out += "  " + std::string(total - 2, '-') + '\n';
  for (std::size_t i = 1; i < rows_.size(); ++i) line(rows_[i]);
  return out;
}

}  // namespace slipmode::cli
