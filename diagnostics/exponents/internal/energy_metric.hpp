#pragma once

#include <slipmode/dynamics/system.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Length of a small difference of states by the energy it holds:
///
///     |δx|² = δq̇ᵀM δq̇ + δqᵀK δq + Σ K_c δz²   (+ k δz_N² + m δż_N² for the load's own oscillator).
///
/// Displacements and velocities become commensurable, an undamped structure keeps the length, and a reduced model's
/// differences are as long as their lifted ones. Where K is singular (a floating structure) stops and contact springs
/// are added to it, and if that is not enough ω²M with the lowest frequency there is.
class EnergyMetric {
 public:
  /// Cost O(n³).
  explicit EnergyMetric(const dynamics::HybridSystem& system);

  /// Columns (q, q̇, internal) [N x k] to coordinates in which the length is Euclid's, and back.
  [[nodiscard]] Eigen::MatrixXd enter(const Eigen::MatrixXd& directions) const;
  [[nodiscard]] Eigen::MatrixXd leave(const Eigen::MatrixXd& coordinates) const;

  /// Largest frequency of the structure, stops and contact springs engaged [rad/s].
  [[nodiscard]] double fastest() const { return fastest_; }

 private:
  Eigen::Index n_;
  Eigen::MatrixXd q_in_, q_out_, v_in_, v_out_;  ///< Cholesky factors Lᵀ and their inverses [n x n]
  Eigen::VectorXd own_;                          ///< weights of the contacts' own states
  double fastest_ = 0.0;
};

}  // namespace slipmode::diagnostics
