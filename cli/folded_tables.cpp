#include "cli/folded_tables.hpp"

#include <slipmode/core/terminal.hpp>

#include <algorithm>
#include <sstream>
#include <vector>

namespace slipmode::cli {
namespace {

/// A line by its characters, of which UTF-8 has one or several bytes each.
using Line = std::vector<std::string>;

Line characters(const std::string& text) {
  Line line;
  for (const char c : text) {
    if (shown_width(std::string(1, c)) == 1) line.emplace_back();
    if (!line.empty()) line.back() += c;
  }
  return line;
}

bool is_blank(const Line& line, std::size_t at) { return at >= line.size() || line[at] == " "; }

/// True between two columns of a table, which two blanks part.
bool is_gap(const Line& line, std::size_t at) { return is_blank(line, at) && is_blank(line, at + 1); }

/// Where the columns of a header, or the groups above one, end.
std::vector<std::size_t> ends_of(const Line& line) {
  std::vector<std::size_t> ends;
  for (std::size_t at = 1; at <= line.size(); ++at)
    if (!is_blank(line, at - 1) && is_gap(line, at)) ends.push_back(at);
  return ends;
}

bool is_rule(const std::string& line) {
  return line.starts_with("  -") && line.find_first_not_of('-', 2) == std::string::npos;
}

/// The titles of groups if it has any, header, rule, rows.
struct Table {
  std::vector<Line> lines;
  std::size_t header = 0;  ///< which line
};

/// The same characters of all lines, behind the first column.
std::string part(const Table& table, std::size_t first, std::size_t begin, std::size_t end) {
  std::string out;
  for (const Line& line : table.lines) {
    std::string row;
    for (std::size_t at = 0; at < end; ++at)
      if (at < first || at >= begin) row += at < line.size() ? line[at] : " ";
    row.erase(row.find_last_not_of(' ') + 1);
    out += row + '\n';
  }
  return out;
}

std::string folded(const Table& table, std::size_t columns) {
  const std::vector<std::size_t> ends = ends_of(table.lines[table.header]);
  const std::vector<std::size_t> groups = table.header == 0 ? std::vector<std::size_t>() : ends_of(table.lines.front());
  std::size_t first = ends.front();  // the first column, which stands to the left, is as wide as its longest cell
  for (std::size_t row = table.header + 2; row < table.lines.size(); ++row) {
    std::size_t end = 2;
    while (!is_gap(table.lines[row], end)) ++end;
    first = std::max(first, end);
  }
  std::string out;
  for (std::size_t begin = first; begin < ends.back();) {
    const auto fits = [&](std::size_t end) { return end > begin && first + end - begin <= columns; };
    const auto last_of = [&](const std::vector<std::size_t>& all) {
      const auto found = std::find_if(all.rbegin(), all.rend(), fits);
      return found == all.rend() ? 0 : *found;
    };
    std::size_t end = last_of(groups);
    if (end == 0) end = last_of(ends);
    if (end == 0) end = *std::ranges::upper_bound(ends, begin);  // a column wider than all there is
    out += (begin == first ? "" : "\n") + part(table, first, begin, end);
    begin = end;
  }
  return out;
}

}  // namespace

std::string folded_tables(const std::string& text, std::size_t columns) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::string out;
  for (std::size_t at = 0; at < lines.size();) {
    // A table begins one line above its rule, or two.
    const auto rule_at = [&](std::size_t line) { return line < lines.size() && is_rule(lines[line]); };
    const bool has_groups = rule_at(at + 2) && lines[at].starts_with("  ") && lines[at].find("--") != std::string::npos;
    const std::size_t rule = at + (has_groups ? 2 : 1);
    const std::vector<std::size_t> ends =
        rule_at(rule) ? ends_of(characters(lines[rule - 1])) : std::vector<std::size_t>();
    if (ends.size() < 2 || shown_width(lines[rule]) <= columns) {
      out += lines[at++] + '\n';
      continue;
    }
    Table table{.lines = {}, .header = rule - at - 1};
    const auto is_row = [&](const Line& line) {
      return line.size() <= lines[rule].size() &&
             std::all_of(ends.begin() + 1, ends.end(), [&](std::size_t end) { return is_gap(line, end); });
    };
    while (at < lines.size() && (at <= rule || (lines[at].starts_with("  ") && is_row(characters(lines[at])))))
      table.lines.push_back(characters(lines[at++]));
    out += folded(table, columns);
  }
  return out;
}

}  // namespace slipmode::cli
