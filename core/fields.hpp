#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace slipmode {

/// The numbers a field may hold; NaN and infinities never pass.
struct Limits {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool above = false;  ///< `low` itself is not allowed
  const char* text = "any finite number";

  [[nodiscard]] constexpr bool hold(double value) const {
    return (above ? value > low : value >= low) && value <= high;
  }
};
/// "an integer from 1 to 16", or "an integer >= 1" where nothing but the type ends them.
[[nodiscard]] std::string integer_text(const Limits& limits);

inline constexpr Limits kFinite{};
inline constexpr Limits kPositive{.low = 0.0, .above = true, .text = "a number > 0"};
inline constexpr Limits kNonNegative{.low = 0.0, .text = "a number >= 0"};
/// Of whole numbers, which say their limits themselves.
inline constexpr Limits kCount{.low = 1.0};
inline constexpr Limits kFromZero{.low = 0.0};

/// What is to be known about one member of a struct S, said once, for all that read it, write it or explain it.
template <class S, class T>
struct Field {
  const char* name;  ///< as a key of a scene's table
  T S::*member;
  const char* unit;  ///< of SI; "1" for a pure number, "" for what has none (words, counts)
  const char* meaning;
  Limits limits;
  bool is_required;          ///< otherwise what the struct starts with stands where nothing is said
  const char* stored;        ///< name of the dataset in result files
  bool is_per_item = false;  ///< an array of which one value may stand for all

  [[nodiscard]] constexpr Field per_item() const {
    Field other = *this;
    other.is_per_item = true;
    return other;
  }
  [[nodiscard]] constexpr Field stored_as(const char* dataset) const {
    Field other = *this;
    other.stored = dataset;
    return other;
  }
};

template <class S, class T>
constexpr Field<S, T> required(const char* name, T S::*member, const char* unit, const char* meaning,
                               const Limits& limits = kFinite) {
  return {name, member, unit, meaning, limits, true, name};
}

template <class S, class T>
constexpr Field<S, T> optional(const char* name, T S::*member, const char* unit, const char* meaning,
                               const Limits& limits = kFinite) {
  return {name, member, unit, meaning, limits, false, name};
}

/// The fields of S in the order they are written: a tuple of Field. A struct has them as `static constexpr auto
/// fields()`, or they are given beside whoever first needs them, as a specialisation.
template <class S>
inline constexpr auto kFields = S::fields();

/// The words for the values of an enum, in its order; given as a specialisation.
template <class Enum>
inline constexpr int kWords = 0;

/// The word for a value of an enum that has words.
template <class Enum>
[[nodiscard]] constexpr const char* word_of(Enum value) {
  return kWords<Enum>.at(static_cast<std::size_t>(value));
}

/// Calls visit(field) for each field of S.
template <class S, class Visit>
constexpr void for_each_field(const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, kFields<S>);
}

/// The same for those that are a real number.
template <class S, class Visit>
constexpr void for_each_number(const Visit& visit) {
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if constexpr (std::is_same_v<T, double>) visit(field);
  });
}

/// The alternative at `index`, as it starts.
template <class Variant>
[[nodiscard]] Variant alternative(std::size_t index) {
  Variant value;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (static_cast<void>(i == index ? &(value = std::variant_alternative_t<i, Variant>{}) : nullptr), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return value;
}

}  // namespace slipmode
