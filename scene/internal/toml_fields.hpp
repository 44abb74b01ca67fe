#pragma once

// Structs with a field list, from and to TOML.

#include <slipmode/core/fields.hpp>
#include "scene/internal/toml_reader.hpp"
#include "scene/internal/toml_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <concepts>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipmode::scene {

/// Fields that are left out.
using Without = std::initializer_list<std::string_view>;

template <class S>
[[nodiscard]] S read_table(TomlReader in, const std::optional<S>& start = {});

/// The whole numbers of type T within limits.
template <class T>
[[nodiscard]] std::int64_t read_integer(TomlReader& in, const char* key, const Limits& limits) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kMost = std::in_range<std::int64_t>(std::numeric_limits<T>::max())
                                     ? static_cast<std::int64_t>(std::numeric_limits<T>::max())
                                     : kLargest;
  const bool bounded = limits.high < static_cast<double>(kMost);
  return in.integer(key, static_cast<std::int64_t>(limits.low),
                    bounded ? static_cast<std::int64_t>(limits.high) : kMost);
}

/// The fields of a struct, in order, without those that are read by other means. What `own` has already stands where a
/// key is absent and may be.
template <class S>
void read_fields(TomlReader& in, S& own, Without without = {}, bool all_optional = false) {
  for_each_field<S>([&](const auto& field) { static_cast<void>(in.has(field.name)); });  // all are known
  for_each_field<S>([&](const auto& field) {
    if (std::ranges::find(without, field.name) != without.end()) return;
    if (!in.has(field.name) && (all_optional || !field.is_required)) return;
    auto& value = own.*field.member;
    using T = std::remove_reference_t<decltype(value)>;
    if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(in.choice(field.name, {kWords<T>.begin(), kWords<T>.end()}));
    } else if constexpr (std::integral<T>) {
      value = static_cast<T>(read_integer<T>(in, field.name, field.limits));
    } else if constexpr (std::floating_point<T>) {
      value = in.number(field.name, field.limits);
    } else {
      value = read_table<typename T::value_type>(in.table(field.name));
    }
  });
}

/// A table that is a struct and nothing else. With a start nothing need be said.
template <class S>
S read_table(TomlReader in, const std::optional<S>& start) {
  S own = start.value_or(S{});
  read_fields(in, own, {}, start.has_value());
  in.finish();
  return own;
}

template <class S>
[[nodiscard]] std::string inline_table(const S& own);

template <class T>
[[nodiscard]] std::string value_toml(const T& value) {
  if constexpr (std::is_enum_v<T>)
    return fmt::format("\"{}\"", kWords<T>.at(static_cast<std::size_t>(value)));
  else if constexpr (std::floating_point<T>)
    return number_text(value);
  else if constexpr (std::integral<T>)
    return fmt::format("{}", value);
  else
    return inline_table(value);
}

/// "key = value" for each field that has a value.
template <class S>
[[nodiscard]] std::vector<std::string> entries(const S& own, Without without = {}) {
  std::vector<std::string> out;
  for_each_field<S>([&](const auto& field) {
    if (std::ranges::find(without, field.name) != without.end()) return;
    const auto& value = own.*field.member;
    if constexpr (requires { value.has_value(); }) {
      if (value) out.push_back(fmt::format("{} = {}", field.name, value_toml(*value)));
    } else {
      out.push_back(fmt::format("{} = {}", field.name, value_toml(value)));
    }
  });
  return out;
}

template <class S>
std::string inline_table(const S& own) {
  return fmt::format("{{ {} }}", fmt::join(entries(own), ", "));
}

/// The same as lines.
template <class S>
[[nodiscard]] std::string lines_toml(const S& own, Without without = {}) {
  std::string out;
  for (const std::string& entry : entries(own, without)) out += entry + "\n";
  return out;
}

}  // namespace slipmode::scene
