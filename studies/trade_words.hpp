#pragma once

#include <slipmode/trade/measures.hpp>

#include <string>

// Words that `trade` and `advise` share.

namespace slipmode::studies {

/// "1%", "0.5 %", "2": percent. @throws InvalidInput  for anything else, a number that is not positive, or one below 1
///                                                    without the sign, which could be a share
[[nodiscard]] double parse_percent(const std::string& option, const std::string& text);
/// "10s", "500ms", "2min": seconds. @throws InvalidInput  likewise
[[nodiscard]] double parse_duration(const std::string& option, const std::string& text);
/// @throws InvalidInput  for an unknown word, naming the valid ones
[[nodiscard]] trade::Measure parse_measure(const std::string& word);

}  // namespace slipmode::studies
