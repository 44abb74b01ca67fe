#pragma once

#include <slipmode/fem/beam.hpp>

#include <Eigen/Core>

namespace slipmode::figures {

/// Displacement along a beam at places x [m] for nodal coordinates q, scaled to a largest value of one in magnitude.
[[nodiscard]] Eigen::VectorXd beam_shape(const fem::Beam& beam, const Eigen::VectorXd& x, const Eigen::VectorXd& q);

}  // namespace slipmode::figures
