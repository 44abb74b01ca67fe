#pragma once

#include "cli/session.hpp"

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace slipmode::cli {

/// A vector as JSON and the columns of tables take it.
[[nodiscard]] inline std::vector<double> json_list(const Eigen::VectorXd& values) {
  return {values.begin(), values.end()};
}

/// A number, null if it is not finite: JSON has neither infinities nor NaN.
[[nodiscard]] inline Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace slipmode::cli
