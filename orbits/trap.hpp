#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/orbits/periodic_orbit.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// An ellipsoid ‖L (x − centre)‖ ≤ radius about a point of a stable orbit at the drive's phase of time 0, from which
/// motions were measured to end on the orbit. Coordinates (q, q̇, internal) [N].
struct Trap {
  Eigen::VectorXd centre;
  std::vector<dynamics::ContactMode> modes = {};  ///< required where they do not follow from the state; else empty
  Eigen::MatrixXd L = {};                         ///< ‖Lδ‖ shrinks at every return by the linear map [N x N]
  double radius = 0.0;                            ///< 0: none was found
  double contraction = 1.0;                       ///< largest ‖LΦδ‖/‖Lδ‖ of the linear map

  [[nodiscard]] bool holds(const dynamics::State& state) const {
    return radius > 0.0 && (L * (stacked(state) - centre)).norm() <= radius && (modes.empty() || modes == state.modes);
  }
};

/// The largest trap that halving a radius finds: about `centre`, a point of an orbit that returns after `duration`,
/// five radii in a row, each half of the one before it, are drawn in from every direction tried; half of the largest is
/// kept, as directions between those tried may do worse. Radius 0 for a return that is slower than 1 − 10⁻⁶, or none.
/// @param centre  at the drive's phase of time 0; with modes, they are required
/// @param scale   how far each coordinate moves [N]
/// @throws NumericalFailure  when the flow from the centre fails
/// Derivation: docs/theory/basins.md, section 3.
[[nodiscard]] Trap measure_trap(const dynamics::HybridSystem& system, const dynamics::State& centre, double duration,
                                const Eigen::VectorXd& scale, const dynamics::FlowOptions& flow);

}  // namespace slipmode::orbits
