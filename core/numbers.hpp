#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace slipmode {

/// The number that a whole text is, with a point whatever the locale; nothing if it is none or does not fit.
template <class Number>
[[nodiscard]] std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stopped != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace slipmode
