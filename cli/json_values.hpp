#pragma once

#include <slipmode/results/result_fields.hpp>
#include <slipmode/results/table.hpp>
#include "cli/session.hpp"

#include <cmath>
#include <type_traits>

namespace slipmode::cli {

/// A number, null if it is not finite: JSON has neither infinities nor NaN.
[[nodiscard]] inline Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// The fields of a struct by their list; a matrix is no value of a report.
template <class S>
[[nodiscard]] Json fields_json(const S& own) {
  Json out = Json::object();
  for_each_field<S>([&]<class T>(const Field<S, T>& field) {
    if constexpr (!std::is_same_v<T, Eigen::MatrixXd>) out[field.name] = own.*field.member;
  });
  return out;
}

/// Fourier coefficients, order by order.
[[nodiscard]] inline Json harmonics_json(const orbits::Harmonics& own) {
  return {{"cosine", results::values_of(own.cosine)}, {"sine", results::values_of(own.sine)}};
}

/// Keys of one object and of those that follow.
template <class... More>
[[nodiscard]] Json merged(Json first, const More&... more) {
  (first.update(more), ...);
  return first;
}

}  // namespace slipmode::cli
