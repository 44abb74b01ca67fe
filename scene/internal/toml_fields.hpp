#pragma once

// Structs with a field list, from and to TOML.

#include <slipmode/core/fields.hpp>
#include "scene/internal/toml_reader.hpp"
#include "scene/internal/toml_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace slipmode::scene {

/// Fields that are passed over: they are read or written by other means.
using Without = std::vector<std::string_view>;

/// What a field list leaves to the scene.
struct Reading {
  Without without = {};
  /// Of some fields, by name, limits in place of their own.
  std::function<Limits(std::string_view name, const Limits& own)> limits = {};
  /// How many values an array has. Without it any number.
  std::function<std::int64_t(std::string_view name)> count = {};
  bool all_optional = false;
};

[[nodiscard]] inline bool has(const Without& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

template <class Enum>
[[nodiscard]] std::vector<std::string> words() {
  return {kWords<Enum>.begin(), kWords<Enum>.end()};
}

/// Of a table that is a value: its numbers that are not limited themselves are as the table is.
[[nodiscard]] inline std::function<Limits(std::string_view, const Limits&)> limits_of(const Limits& table) {
  return [table](std::string_view, const Limits& own) { return own.low == kFinite.low ? table : own; };
}

template <class S>
void read_fields(TomlReader& in, S& own, const Reading& how = {});

/// A table that is a struct and nothing else.
template <class S>
[[nodiscard]] S read_table(TomlReader in, S own = {}, const Reading& how = {}) {
  read_fields(in, own, how);
  in.finish();
  return own;
}

/// A value that is there.
template <class T, class AnyField>
void read_value(TomlReader& in, const AnyField& field, T& value, const Limits& limits, const Reading& how) {
  const std::int64_t count = how.count ? how.count(field.name) : -1;
  if constexpr (requires {
                  typename std::optional<typename T::value_type>;
                  value.has_value();
                }) {
    read_value(in, field, value.emplace(), limits, how);
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(in.choice(field.name, words<T>()));
  } else if constexpr (std::same_as<T, bool>) {
    value = in.flag_or(field.name, value);
  } else if constexpr (std::integral<T>) {
    value = in.integer<T>(field.name, limits);
  } else if constexpr (std::floating_point<T>) {
    value = in.number(field.name, limits);
  } else if constexpr (std::same_as<T, std::vector<double>>) {
    value = field.is_per_item ? in.per_item(field.name, limits, count) : in.numbers(field.name, limits, count);
  } else if constexpr (std::same_as<T, std::vector<int>>) {
    value = in.integers(field.name, limits);
  } else if constexpr (requires { value.push_back({}); }) {
    value.clear();
    for (const std::size_t word : in.choices(field.name, words<typename T::value_type>())) {
      value.push_back(static_cast<typename T::value_type>(word));
    }
  } else {
    value = read_table<T>(in.table(field.name), {}, {.limits = limits_of(limits)});
  }
}

/// The fields of a struct, in order. What `own` has already stands where a key is absent and may be.
template <class S>
void read_fields(TomlReader& in, S& own, const Reading& how) {
  for_each_field<S>([&](const auto& field) {
    if (!has(how.without, field.name)) static_cast<void>(in.has(field.name));  // all are known, for hints
  });
  for_each_field<S>([&](const auto& field) {
    if (has(how.without, field.name)) return;
    if (!in.has(field.name) && (how.all_optional || !field.is_required)) return;
    read_value(in, field, own.*field.member, how.limits ? how.limits(field.name, field.limits) : field.limits, how);
  });
}

/// Whether any field of S is there.
template <class S>
[[nodiscard]] bool has_any(TomlReader& in) {
  bool any = false;
  for_each_field<S>([&](const auto& field) { any = in.has(field.name) || any; });
  return any;
}

/// Refuses the fields of Other that S has not.
template <class Other, class S>
void refuse_others(TomlReader& in, const std::string& why, const std::string& valid) {
  Without shared;
  for_each_field<S>([&](const auto& field) { shared.push_back(field.name); });
  for_each_field<Other>([&](const auto& field) {
    if (!has(shared, field.name)) in.refuse(field.name, why, valid);
  });
}

template <class S>
[[nodiscard]] std::string inline_table(const S& own, const Without& without = {});

template <class T>
[[nodiscard]] std::string value_toml(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return fmt::format("\"{}\"", word_of(value));
  } else if constexpr (std::floating_point<T>) {
    return number_text(value);
  } else if constexpr (std::integral<T>) {
    return fmt::format("{}", value);
  } else if constexpr (requires { value.begin(); }) {
    std::vector<std::string> texts(static_cast<std::size_t>(value.size()));
    std::ranges::transform(value, texts.begin(), [](const auto& item) { return value_toml(item); });
    return fmt::format("[{}]", fmt::join(texts, ", "));
  } else {
    return inline_table(value);
  }
}

/// "key = value" for each field that has a value.
template <class S>
[[nodiscard]] std::vector<std::string> entries(const S& own, const Without& without = {}) {
  std::vector<std::string> out;
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if (has(without, field.name)) return;
    const T& value = own.*field.member;
    const auto add = [&](const std::string& text) { out.push_back(fmt::format("{} = {}", field.name, text)); };
    if constexpr (requires { value.has_value(); }) {
      if (value) add(value_toml(*value));
    } else if constexpr (std::same_as<T, std::vector<double>>) {
      if (!field.is_per_item)
        add(value_toml(value));
      else if (!value.empty())
        add(one_or_many_text(value));
    } else {
      add(value_toml(value));
    }
  });
  return out;
}

template <class S>
std::string inline_table(const S& own, const Without& without) {
  return fmt::format("{{ {} }}", fmt::join(entries(own, without), ", "));
}

/// The same as lines.
template <class S>
[[nodiscard]] std::string lines_toml(const S& own, const Without& without = {}) {
  std::string out;
  for (const std::string& entry : entries(own, without)) out += entry + "\n";
  return out;
}

}  // namespace slipmode::scene
