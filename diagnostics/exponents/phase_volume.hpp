#pragma once

#include <slipmode/dynamics/consistency.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::diagnostics {

/// ∫ tr A dt over a stretch of motion, A the linearised field on the space the motion is confined to.
struct PhaseContraction {
  double viscous = 0.0;  ///< −tr M⁻¹C, on what the sticking contacts leave free, and the stops' dashpots
  double friction = 0.0;  ///< −Σ λ'(s) wᵀM⁻¹w of the contacts that slide: positive where friction falls with speed

  [[nodiscard]] double total() const { return viscous + friction; }
  PhaseContraction& operator+=(const PhaseContraction& more) {
    viscous += more.viscous;
    friction += more.friction;
    return *this;
  }
};

/// What the equations say about volumes of phase space, without tangents: the other side of the sum of the exponents.
/// With the set S of sticking contacts the tangents are confined to T_S = {w_cᵀδq̇ = 0, c ∈ S}.
/// Source: docs/theory/lyapunov-spectrum.md, section 4.
class PhaseVolume {
 public:
  explicit PhaseVolume(const dynamics::HybridSystem& system);

  /// False for contacts whose volumes are not worked out here: behind a spring, with a bristle, or rigid ones under a
  /// varying load.
  [[nodiscard]] static bool applies(const dynamics::HybridSystem& system);

  /// Over a stretch without events [—]. Friction by Simpson's rule, panels halved until two results agree to 1e-7.
  /// @param start  with its modes
  [[nodiscard]] PhaseContraction along(const dynamics::State& start, double duration,
                                       const dynamics::FlowOptions& flow) const;

  /// Friction's impulse at a contact that does not stick while `modes` rule: M⁻¹w on T_S, of unit energy, as
  /// (q, q̇) [2n]. The normal, in the energy metric, of the space in which this contact sticks too.
  [[nodiscard]] Eigen::VectorXd normal(const std::vector<dynamics::ContactMode>& modes, int contact) const;

  /// ln |det| of the saltation where a contact turns from slip to slip: ratio of the relative accelerations.
  /// @param at  state at the event, with the modes after it
  [[nodiscard]] double reversal(const dynamics::State& at, int contact, dynamics::ContactMode before) const;

 private:
  /// Directions of the contacts that stick, as columns.
  [[nodiscard]] Eigen::MatrixXd held(const std::vector<dynamics::ContactMode>& modes) const;
  /// M⁻¹ on T_S [n x n].
  [[nodiscard]] Eigen::MatrixXd mobility_of(const std::vector<dynamics::ContactMode>& modes) const;
  [[nodiscard]] double slope(int contact, double relative_velocity) const;
  [[nodiscard]] double relative_acceleration(const dynamics::State& at, const std::vector<dynamics::ContactMode>& modes,
                                             int contact) const;

  dynamics::HybridSystem system_;
  std::vector<friction::ContactForces> laws_;
  Eigen::MatrixXd inverse_mass_, damping_, stiffness_;
  double fastest_;
};

}  // namespace slipmode::diagnostics
