#pragma once

// Structs with a field list, as JSON Schema.

#include "scene/internal/toml_fields.hpp"

#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace slipmode::scene {

/// JSON that keeps the order in which keys are said.
using Json = nlohmann::ordered_json;

[[nodiscard]] Json number_schema(const Limits& limits, const char* type = "number");
/// An array whose values are each as said.
[[nodiscard]] Json array_schema(Json items, std::size_t least = 0, std::optional<std::size_t> most = {});
[[nodiscard]] Json any_of(const std::vector<Json>& schemas);

/// A table of a scene file: its keys, each with what it means, and no others.
class TableSchema {
 public:
  /// A key that no field list has.
  TableSchema& key(const std::string& name, Json schema, const std::string& meaning);
  /// The word that tells this table from others in its place.
  TableSchema& word(const std::string& name, const std::string& word, const std::string& meaning);
  TableSchema& require(const std::string& name);
  /// Exactly one of these is there.
  TableSchema& one_of(const std::vector<std::string>& names);
  /// In words, what stands where the key is not given and that is no fixed value.
  TableSchema& otherwise(const std::string& name, const std::string& text);

  /// The fields of S as read_fields reads them. Defaults are those of an S that nothing is said about.
  template <class S>
  TableSchema& fields(const Reading& how = {});

  [[nodiscard]] Json json() const;

 private:
  Json properties_ = Json::object(), required_ = Json::array(), all_of_ = Json::array();
};

/// The schema that scene_schema writes.
[[nodiscard]] Json schema_json();

/// What a value of type T may be, as read_value reads it.
template <class T>
[[nodiscard]] Json value_schema(const Limits& limits, bool is_per_item) {
  if constexpr (requires(T value) { value.has_value(); }) {
    return value_schema<typename T::value_type>(limits, is_per_item);
  } else if constexpr (std::is_enum_v<T>) {
    return {{"enum", words<T>()}};
  } else if constexpr (std::same_as<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::integral<T>) {
    return number_schema(limits, "integer");
  } else if constexpr (std::floating_point<T>) {
    return number_schema(limits);
  } else if constexpr (requires(T value) { value.push_back({}); }) {
    const Json items = value_schema<typename T::value_type>(limits, false);
    return is_per_item ? any_of({items, array_schema(items)}) : array_schema(items);
  } else {
    return TableSchema().fields<T>({.limits = limits_of(limits)}).json();
  }
}

/// A value as a scene would hold it; null where it holds none.
template <class T>
[[nodiscard]] Json value_json(const T& value) {
  if constexpr (requires { value.has_value(); }) {
    return value ? value_json(*value) : Json();
  } else if constexpr (std::is_enum_v<T>) {
    return word_of(value);
  } else if constexpr (std::is_arithmetic_v<T>) {
    return value;
  } else if constexpr (requires { value.front(); }) {
    return value.size() == 1 ? value_json(value.front()) : Json();
  } else {
    return {};
  }
}

template <class S>
TableSchema& TableSchema::fields(const Reading& how) {
  const S own{};
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if (has(how.without, field.name)) return;
    const std::string unit = field.unit;
    const Limits limits = how.limits ? how.limits(field.name, field.limits) : field.limits;
    key(field.name, value_schema<T>(limits, field.is_per_item),
        unit.empty() || unit == "1" ? field.meaning : fmt::format("{} [{}]", field.meaning, unit));
    const Json usual = value_json(own.*field.member);
    if (field.is_required && !how.all_optional) {
      require(field.name);
    } else if (!field.is_required && !usual.is_null()) {
      properties_[field.name]["default"] = usual;
    }
  });
  return *this;
}

}  // namespace slipmode::scene
