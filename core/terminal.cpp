#include <slipmode/core/terminal.hpp>

#include <sys/ioctl.h>

#include <algorithm>
#include <sstream>

namespace slipmode {
namespace {

/// Of UTF-8.
bool starts_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

}  // namespace

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, starts_character));
}

std::string row_of(const std::string& text, std::size_t columns) {
  std::string out;
  std::size_t shown = 0;
  for (const char c : text) {
    if (starts_character(c) && ++shown >= columns) return out;
    out += c;
  }
  return out + std::string(columns - 1 - shown, ' ');
}

std::string wrapped(const std::string& text, std::size_t columns) {
  std::istringstream words(text);
  std::string out;
  std::size_t column = 0;
  for (std::string word; words >> word; column += shown_width(word)) {
    const bool breaks = column > 0 && column + 1 + shown_width(word) > columns;
    if (column > 0) out += breaks ? '\n' : ' ';
    column = breaks || column == 0 ? 0 : column + 1;
    out += word;
  }
  return out;
}

std::string wrapped_lines(const std::string& text, std::size_t columns) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);)
    out += (line.starts_with("  ") ? line : wrapped(line, columns)) + "\n";
  return out;
}

}  // namespace slipmode
