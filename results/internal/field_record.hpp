#pragma once

// Structs with a field list, to and from datasets.

#include <slipmode/core/fields.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/results/result_fields.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/checked_read.hpp"

#include <fmt/format.h>
#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace slipmode::results {

/// The codes of an enum that is kept as integers; given as a specialisation.
template <class Enum>
inline constexpr const char* kCodes = "";

template <class S, class T>
[[nodiscard]] Meaning meaning_of(const Field<S, T>& field) {
  const std::string said = field.meaning;
  if (field.unit == std::string_view(kClockSeconds)) return {"s", said, Meaning::Of::kClock};
  if constexpr (!std::is_enum_v<T>)
    return {field.unit, said};
  else
    return {field.unit, said.empty() ? kCodes<T> : said + ": " + kCodes<T>};
}

/// The integers of a dataset within a field's limits.
template <class S, class T>
[[nodiscard]] std::vector<std::int64_t> coded(const StoreReader& store, const std::string& name,
                                              const Field<S, T>& field, Eigen::Index size) {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<int>::max());
  return codes(store, name, size, static_cast<std::int64_t>(field.limits.low),
               static_cast<std::int64_t>(std::min(field.limits.high, kMost)));
}

/// Each field as a dataset of the group.
template <class S>
void save_fields(StoreWriter& store, const std::string& group, const S& own) {
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    const T& value = own.*field.member;
    if constexpr (std::is_integral_v<T>) {
      store.write(group + "/" + field.stored, static_cast<std::int64_t>(value), meaning_of(field));
    } else {
      store.write(group + "/" + field.stored, value, meaning_of(field));
    }
  });
}

/// Fields that need not be said are not in files of versions that did not have them.
template <class S>
[[nodiscard]] S load_fields(const StoreReader& store, const std::string& group, S own = {}) {
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    const std::string name = group + "/" + field.stored;
    if (!field.is_required && !store.has(name)) return;
    T& value = own.*field.member;
    if constexpr (std::is_same_v<T, double>) {
      value = store.number(name);
    } else if constexpr (std::is_integral_v<T>) {
      const std::int64_t read = store.integer(name);
      const double high = std::min(field.limits.high, static_cast<double>(std::numeric_limits<T>::max()));
      if (!Limits{.low = field.limits.low, .high = high}.hold(static_cast<double>(read))) {
        store.fail(name, fmt::format("{}; expected {} to {}", read, field.limits.low, high));
      }
      value = static_cast<T>(read);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = store.text(name);
    } else if constexpr (std::is_same_v<T, Eigen::MatrixXd>) {
      value = finite_matrix(store, name);
    } else {
      const Eigen::VectorXd values = finite_vector(store, name);
      value.assign(values.begin(), values.end());
    }
  });
  return own;
}

/// What a column holds: numbers, and enums as their codes.
template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Each field that is a number as a dataset of the group with one value per struct.
template <class S>
void save_rows(StoreWriter& store, const std::string& group, const std::vector<S>& rows) {
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if constexpr (Number<T>) {
      std::vector<std::conditional_t<std::is_same_v<T, double>, double, std::int64_t>> values;
      for (const S& own : rows) values.push_back(static_cast<typename decltype(values)::value_type>(own.*field.member));
      store.write(group + "/" + field.stored, values, meaning_of(field));
    }
  });
}

template <class S>
[[nodiscard]] std::vector<S> load_rows(const StoreReader& store, const std::string& group,
                                       Eigen::Index count = StoreReader::kAny) {
  std::vector<S> rows;
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    const std::string name = group + "/" + field.stored;
    if (!field.is_required && !store.has(name)) return;
    const auto take = [&](const auto& values) {
      count = static_cast<Eigen::Index>(values.size());
      rows.resize(static_cast<std::size_t>(count));
      std::ranges::transform(values, rows, rows.begin(), [&](auto value, S own) {
        own.*field.member = static_cast<T>(value);
        return own;
      });
    };
    if constexpr (std::is_same_v<T, double>)
      take(finite_vector(store, name, count));
    else if constexpr (Number<T>)
      take(coded(store, name, field, count));
  });
  return rows;
}

/// A column for each field, of numbers or of texts.
/// @param part  part(row): the struct of a row, or a pointer to it; numbers of a row without one are NaN
template <class Row, class Part = std::identity>
[[nodiscard]] std::vector<Column> columns_of(const std::vector<Row>& rows, const Part& part = {}) {
  using Found = std::remove_cvref_t<std::invoke_result_t<Part, const Row&>>;
  using S = std::remove_cv_t<std::remove_pointer_t<Found>>;
  std::vector<Column> columns;
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    std::vector<std::conditional_t<std::is_same_v<T, std::string>, std::string, double>> values;
    for (const Row& row : rows) {
      typename decltype(values)::value_type value{};
      if constexpr (!std::is_pointer_v<Found>) {
        value = static_cast<decltype(value)>(std::invoke(part, row).*field.member);
      } else if (const S* own = std::invoke(part, row); own != nullptr) {
        value = static_cast<decltype(value)>(own->*field.member);
      } else if constexpr (!std::is_same_v<T, std::string>) {
        value = kNone;
      }
      values.push_back(std::move(value));
    }
    columns.push_back({field.stored, meaning_of(field), std::move(values)});
  });
  return columns;
}

[[nodiscard]] inline std::vector<Column> joined(std::initializer_list<std::vector<Column>> parts) {
  std::vector<Column> columns;
  for (const std::vector<Column>& part : parts) columns.insert(columns.end(), part.begin(), part.end());
  return columns;
}

/// The fields of a struct of numbers as one vector.
template <class S>
inline constexpr Eigen::Index kNumbers = std::tuple_size_v<std::remove_cvref_t<decltype(kFields<S>)>>;

template <class S>
[[nodiscard]] Eigen::VectorXd to_numbers(const S& own) {
  return std::apply([&](const auto&... field) { return Eigen::VectorXd{{own.*field.member...}}; }, kFields<S>);
}

template <class S>
[[nodiscard]] S from_numbers(const Eigen::VectorXd& numbers) {
  S own;
  Eigen::Index next = 0;
  for_each_field<S>([&](const auto& field) { own.*field.member = numbers(next++); });
  return own;
}

}  // namespace slipmode::results
