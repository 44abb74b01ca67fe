#pragma once

#include <cstddef>
#include <string>

namespace slipmode {

/// How many characters the terminal behind a file descriptor shows in a row; 80 where none says.
[[nodiscard]] std::size_t terminal_columns(int descriptor);

/// Number of characters shown for UTF-8 text.
[[nodiscard]] std::size_t shown_width(const std::string& text);

/// A text as it overwrites any other in a row of a terminal: cut to one character less than its columns, or filled up
/// with blanks to as many. No control characters are needed, which not every terminal knows.
[[nodiscard]] std::string row_of(const std::string& text, std::size_t columns);

/// Text broken between words into lines of at most so many characters, as far as its words allow; no break at the end.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t columns);
/// Each line by itself; those that are indented, tables and commands, stay whole.
[[nodiscard]] std::string wrapped_lines(const std::string& text, std::size_t columns);

}  // namespace slipmode
