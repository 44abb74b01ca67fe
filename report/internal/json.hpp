#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

namespace slipmode::report {

/// JSON that keeps the order things are said in.
using Json = nlohmann::ordered_json;

/// A number to seven digits, null if it is not finite.
[[nodiscard]] Json number_json(double value);

/// How finely a long list of numbers is kept.
enum class Grain { kFine, kCoarse };

/// A list of numbers: up to 64 as they are; longer ones as steps of a ten-thousandth (coarse: a two-thousandth) of
/// their span, {"low", "step", "d": differences, null where not finite}, which deflates to little more than a byte a
/// number. @param logarithmic  of the logarithms, with "log": true, where the axis is
[[nodiscard]] Json list_json(const Eigen::VectorXd& values, Grain grain = Grain::kFine, bool logarithmic = false);

/// The same with low and step given. @param step  > 0
[[nodiscard]] Json stepped_json(const Eigen::VectorXd& values, double low, double step);

}  // namespace slipmode::report
