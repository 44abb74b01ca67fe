#pragma once

#include <Eigen/Core>

namespace slipmode {

/// Flips columns so that each one's largest component in magnitude is positive. Among components equal to the largest
/// within 1e-9 of it the first decides, so that rounding does not flip symmetric shapes.
void fix_signs(Eigen::MatrixXd& vectors);

}  // namespace slipmode
