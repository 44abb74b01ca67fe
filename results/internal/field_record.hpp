#pragma once

// Structs with a field list, to and from datasets.

#include <slipmode/core/fields.hpp>
#include <slipmode/results/store.hpp>

#include <Eigen/Core>

namespace slipmode::results {

/// How many fields of S are numbers, or are kept as such.
template <class S>
[[nodiscard]] constexpr Eigen::Index number_count() {
  return static_cast<Eigen::Index>(std::tuple_size_v<decltype(kFields<S>)>);
}

/// The fields of a struct of numbers, in order.
template <class S>
[[nodiscard]] Eigen::VectorXd numbers_of(const S& own) {
  return std::apply([&](const auto&... field) { return Eigen::VectorXd{{own.*field.member...}}; }, kFields<S>);
}

template <class S>
[[nodiscard]] S of_numbers(const Eigen::VectorXd& numbers) {
  S own;
  Eigen::Index next = 0;
  for_each_field<S>([&](const auto& field) { own.*field.member = numbers(next++); });
  return own;
}

}  // namespace slipmode::results
