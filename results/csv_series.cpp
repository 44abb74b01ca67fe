#include <slipmode/results/csv_series.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>

namespace slipmode::results {
namespace {

std::string_view trimmed_cell(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<std::string_view> cells_of_line(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(separator, begin);
    cells.push_back(trimmed_cell(line.substr(begin, end == std::string_view::npos ? end : end - begin)));
    if (end == std::string_view::npos) return cells;
    begin = end + 1;
  }
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// The number a cell holds; NaN for an empty one; nothing if it is no number.
std::optional<double> cell_number(std::string_view cell, bool decimal_comma) {
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') cell.remove_prefix(1);
  std::string changed;
  if (decimal_comma && cell.find(',') != std::string_view::npos) {
    changed = cell;
    std::ranges::replace(changed, ',', '.');
    cell = changed;
  }
  if (const auto value = number_in<double>(cell)) return value;
  if (lower_case(cell) == "na" || lower_case(cell) == "null") return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

/// "v [m/s]" or "v (m/s)" in two.
CsvFile::Name column_name_of(std::string_view cell) {
  const std::size_t open = cell.find_last_of("[(");
  if (open == std::string_view::npos || open == 0 || (cell.back() != ']' && cell.back() != ')')) {
    return {std::string(cell), ""};
  }
  return {std::string(trimmed_cell(cell.substr(0, open))),
          std::string(trimmed_cell(cell.substr(open + 1, cell.size() - open - 2)))};
}

std::string listed_columns(const std::vector<CsvFile::Name>& names) {
  constexpr std::size_t kShown = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kShown); ++k) {
    text += fmt::format("{}{} ({})", k == 0 ? "" : ", ", names[k].name, k + 1);
  }
  return names.size() > kShown ? text + fmt::format(", … ({} in all)", names.size()) : text;
}

}  // namespace

CsvFile::CsvFile(std::filesystem::path path) : path_(std::move(path)) {
  std::ifstream in(path_, std::ios::binary);
  if (!in) throw InvalidInput(fmt::format("cannot read '{}': is there such a file?", path_.string()));
  text_.assign(std::istreambuf_iterator<char>(in), {});
  if (text_.find('\0') != std::string::npos) {
    throw InvalidInput(
        fmt::format("'{}' is neither HDF5 nor text; give a result file or a CSV file with a header", path_.string()));
  }
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  std::size_t line = 0;
  for (std::size_t begin = 0; begin < text_.size();) {
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    ++line;
    const std::string_view content = trimmed_cell(std::string_view(text_).substr(begin, end - begin));
    if (!content.empty() && content.front() != '#') rows_.push_back({begin, end, line});
    begin = end + 1;
  }
  if (rows_.empty()) throw InvalidInput(fmt::format("'{}' is empty; expected a header and samples", path_.string()));
  const std::string_view header = std::string_view(text_).substr(rows_[0].begin, rows_[0].end - rows_[0].begin);
  for (const char separator : {';', '\t', ','}) {
    if (header.find(separator) == std::string_view::npos) continue;
    separator_ = separator;
    break;
  }
  for (const std::string_view cell : cells_of_line(header, separator_)) {
    if (!cell.empty() && cell_number(cell, separator_ == ';')) {
      throw InvalidInput(
          fmt::format("'{}', line {}: expected a header that names the columns, found the number {}; put a line like "
                      "\"t [s],x [m]\" first",
                      path_.string(), rows_[0].line, cell));
    }
    names_.push_back(column_name_of(cell));
  }
  rows_.erase(rows_.begin());
}

std::size_t CsvFile::column(const std::string& wanted) const {
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (names_[k].name == wanted || fmt::format("{} [{}]", names_[k].name, names_[k].unit) == wanted) return k;
  }
  const auto count = number_in<std::size_t>(wanted);
  if (count && *count >= 1 && *count <= names_.size()) return *count - 1;
  throw InvalidInput(
      fmt::format("'{}' has no column '{}'; there are {}", path_.string(), wanted, listed_columns(names_)));
}

int CsvFile::time_column() const {
  for (std::size_t k = 0; k < names_.size(); ++k) {
    const std::string name = lower_case(names_[k].name);
    if (name == "t" || name == "time") return static_cast<int>(k);
  }
  return -1;
}

Eigen::VectorXd CsvFile::values(std::size_t column) const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows_.size()));
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const auto cells =
        cells_of_line(std::string_view(text_).substr(rows_[r].begin, rows_[r].end - rows_[r].begin), separator_);
    if (column >= cells.size()) {
      throw InvalidInput(fmt::format("'{}', line {}: expected {} cells as in the header, found {}; is it cut off?",
                                     path_.string(), rows_[r].line, names_.size(), cells.size()));
    }
    const auto value = cell_number(cells[column], separator_ == ';');
    if (!value) {
      throw InvalidInput(fmt::format("'{}', line {}, column '{}': expected a number, found '{}'", path_.string(),
                                     rows_[r].line, names_[column].name, cells[column]));
    }
    out(static_cast<Eigen::Index>(r)) = *value;
  }
  return out;
}

}  // namespace slipmode::results
