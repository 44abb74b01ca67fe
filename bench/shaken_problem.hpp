#pragma once

#include <slipmode/dynamics/simulate.hpp>

#include <vector>

namespace slipmode::bench {

/// A shaken structure with one compliant Coulomb contact as the peers integrate it: in the natural modes of the
/// slipping structure, where a step costs them least. Unknowns a_i = ω_i η_i and b_i = η̇_i [m √kg/s], so that one
/// absolute tolerance fits all of them:
///
///     ȧ_i = ω_i b_i,    ḃ_i = −ω_i a_i − Σ_j D_ij b_j + p_i + w_i λ,    y = Σ (w_i/ω_i) a_i + offset.
struct ShakenProblem {
  int n = 0;
  std::vector<double> omega;                       ///< ω_i > 0 [rad/s]
  std::vector<double> damping;                     ///< D_ii [1/s], or all of D, row by row, where it is not diagonal
  std::vector<double> load;                        ///< p_i
  std::vector<double> direction;                   ///< w_i
  double offset = 0.0;                             ///< of y [m]
  double stiffness = 0.0;                          ///< K_c [N/m]
  double static_plus = 0.0, static_minus = 0.0;    ///< μ_s for forces along ±w, tilt included
  double kinetic_plus = 0.0, kinetic_minus = 0.0;  ///< μ_k
  double load_constant = 0.0, load_slope = 0.0;    ///< N0 [N], N1 [N/m]
  double amplitude = 0.0, drive_omega = 0.0, phase = 0.0;

  [[nodiscard]] bool diagonal() const { return damping.size() == omega.size(); }
};

/// Where a run is or begins: time, unknowns [a; b], what the contact does, stretch of its spring.
struct ShakenPoint {
  double time = 0.0;
  std::vector<double> y = {};  ///< [2n]
  int mode = 0;                ///< −1, +1: slip; 0: stick
  double stretch = 0.0;        ///< y_c − y [m]; counts in stick
};

/// Takes states of a system to the peers' unknowns.
class ShakenCoordinates {
 public:
  /// @throws InvalidInput  for anything but one compliant contact without normal oscillator, on a shaker
  explicit ShakenCoordinates(const dynamics::HybridSystem& system);

  [[nodiscard]] const ShakenProblem& problem() const { return problem_; }
  [[nodiscard]] ShakenPoint point(const dynamics::State& state) const;

 private:
  ShakenProblem problem_;
  Eigen::MatrixXd to_eta_;  // ΦᵀM
};

/// √(aᵀa + bᵀb): the square root of twice the energy of the structure.
[[nodiscard]] double energy_norm(const std::vector<double>& y);
/// Norm of the difference.
[[nodiscard]] double energy_distance(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace slipmode::bench
