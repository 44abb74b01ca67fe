#pragma once

#include <slipmode/studies/command.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// KEY=FROM:TO:STEP. @throws InvalidInput  saying what is wrong with the text
[[nodiscard]] studies::Over parse_over(const std::string& text);

/// What to say when Ctrl-C came: that finished values are kept and the same command goes on.
/// @param how_far  "with 12 of 500 values done"; may be empty
[[nodiscard]] Report interrupted_at(const std::string& output, const std::string& how_far = "");

}  // namespace slipmode::cli
