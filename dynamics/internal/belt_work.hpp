#pragma once

#include <slipmode/dynamics/regime.hpp>
#include "dynamics/internal/audit_forms.hpp"

#include <Eigen/Core>
#include <memory>

namespace slipmode::dynamics {

/// The energy audit under a belt of constant speed without quadrature, for real modes x = (η, η̇). What follows the
/// inputs moves at constant velocity; beside it η_f'' + d η_f' + ω² η_f = 0, so that with [·] the change over a stay
///
///     ∫ d η_f'² = −[½ (η_f'² + ω² η_f²)],     ∫ η_f = −[η_f' + d η_f]/ω²,     ∫ λ wᵀq̇ = λ [wᵀq] in slip,
///
/// and ∫ λ wᵀq̇ = V ∫ λ in stick, less [½ λ²/K_c] behind a contact spring. Costs O(n) per stay.
/// Source: docs/theory/flow.md, section 6.
class BeltWork {
 public:
  /// Null where the integrals have no such form: complex modes, rigid-body motion, forces in slip that vary.
  [[nodiscard]] static std::unique_ptr<BeltWork> make(const Regime& regime);

  /// Starts a stay.
  void begin(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs);
  /// Work since `begin` or the last `until`.
  [[nodiscard]] StayWork until(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs);

 private:
  /// What has an antiderivative, at one end of a stay.
  struct End {
    double time = 0.0;
    double energy = 0.0;       ///< ½ (η_f'² + ω² η_f²) of the damped modes
    double dragged = 0.0;      ///< 2 d η_p'·η_f + 2 V viscous_cross·η
    Eigen::VectorXd by_force;  ///< of each contact: wᵀq in slip, ∫ of λ by x_f in stick [nc]
    Eigen::VectorXd resting;   ///< λ by the inputs, in stick [nc]
    double stored = 0.0;       ///< Σ ½ λ²/K_c
  };

  explicit BeltWork(const Regime& regime);
  void measure(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, End& out);

  const Regime& regime_;
  Eigen::MatrixXd impulse_;         ///< y of each sticking contact: ∫ λ dt by x_f = [yᵀx_f] [2np x nc]
  Eigen::MatrixXd resting_;         ///< ι → λ that follows the inputs [ni x nc]
  Eigen::VectorXd stiffness_;       ///< ω² of damped modes, else 0 [np]
  Eigen::VectorXd mass_;            ///< 1 of damped modes, else 0 [np]
  Eigen::VectorXd free_, carried_;  ///< x_f [2np], η_p' [np]
  End begin_, end_;
};

}  // namespace slipmode::dynamics
