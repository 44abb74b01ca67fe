#pragma once

#include <string>

namespace slipmode::cli {

/// A text whose tables (TextTable::str) that are wider than so many characters are folded: their first column is
/// repeated beside as many others as fit, whole groups where those do. All else stays as it is.
[[nodiscard]] std::string folded_tables(const std::string& text, std::size_t columns);

}  // namespace slipmode::cli
