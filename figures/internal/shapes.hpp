#pragma once

#include <slipmode/fem/beam.hpp>

#include <Eigen/Core>

namespace slipmode::figures {

/// Scaled to a largest component of one in magnitude; zero stays.
[[nodiscard]] Eigen::VectorXd normalised(const Eigen::VectorXd& shape);

/// With the sign in which it is more like another: a mode's own means nothing.
[[nodiscard]] Eigen::VectorXd turned_to(const Eigen::VectorXd& shape, const Eigen::VectorXd& reference);

/// Displacement along a beam at places x [m] for nodal coordinates q, normalised.
[[nodiscard]] Eigen::VectorXd beam_shape(const fem::Beam& beam, const Eigen::VectorXd& x, const Eigen::VectorXd& q);

}  // namespace slipmode::figures
