#pragma once

#include "dynamics/drive_overlay.hpp"
#include "dynamics/regime.hpp"

#include <Eigen/Core>
#include <memory>

namespace slipmode::dynamics {

/// Work of a stay in a regime [J].
struct StayWork {
  double contact = 0.0;  ///< ∫ Σ λ wᵀq̇ dt
  double drive = 0.0;    ///< ∫ Σ λ v_drive dt
  double viscous = 0.0;  ///< ∫ q̇ᵀCq̇ dt
  double force = 0.0;    ///< ∫ Σ u_k d_kᵀq̇ dt
};

/// The energy audit under a harmonic drive without quadrature: with x = x_f + S u, ẋ_f = G x_f, u = (ι, cos θ, sin θ),
/// every power is a quadratic form of (x_f, u), and
///
///     ∫ x_fᵀQ x_f dt = [x_fᵀY x_f],  GᵀY + YG = Q;     ∫ x_fᵀr e^{iθ} dt = Re [x_fᵀy e^{iθ}],  (Gᵀ + iω) y = r.
///
/// Costs O(n²) per stay whatever its length, where quadrature would follow the fastest mode.
/// Source: docs/theory/flow.md.
class AuditForms {
 public:
  /// Null where a mode has no damping to speak of, or drifts, or the drive has several harmonics: then the integrals
  /// have no such form.
  [[nodiscard]] static std::unique_ptr<AuditForms> make(const Regime& regime, const ModalModel& slipping,
                                                        const DriveOverlay& overlay);

  /// Starts a stay. @param inputs  constant over the stay
  void begin(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs);
  /// Work since `begin` or the last `until`.
  [[nodiscard]] StayWork until(double t, const Eigen::VectorXd& x);

 private:
  /// One power, as the antiderivative of a quadratic form.
  struct Form {
    bool none = true;  ///< nothing acts: the integral is zero
    /// Lower triangle of Y, off-diagonal entries doubled, zeros above [2np x 2np]; empty: no quadratic part.
    Eigen::MatrixXd Y;
    Eigen::MatrixXd constant;      ///< ι → y of the constant part [2np x ni]
    Eigen::VectorXd cosine, sine;  ///< y of the harmonic part [2np]
    Eigen::MatrixXd steady;        ///< uᵀ(this)u is what does not depend on x_f [(ni+2) x (ni+2)]

    /// Under the inputs of a stay: y of the constant part [2np], and the cos θ and sin θ parts of what does not depend
    /// on x_f. Constant inputs alone move nothing and have no power.
    Eigen::VectorXd resting;
    double along_cosine = 0.0, along_sine = 0.0;

    void set_inputs(const Eigen::VectorXd& inputs);
  };
  /// The same before integration.
  struct Power {
    Eigen::MatrixXd Q, R, P;
  };

  AuditForms(const Regime& regime, const DriveOverlay& overlay) : regime_(regime), overlay_(overlay) {}
  [[nodiscard]] bool integrate(const Power& power, Form& out) const;
  [[nodiscard]] bool solve_quadratic(const Eigen::MatrixXd& Q, Eigen::MatrixXd& out_Y) const;
  [[nodiscard]] double value(const Form& form, double stay, DrivePhase p) const;
  /// Contact work that is a function of the state: −½λ²/K_c of contact springs, ∫λ d(wᵀq) under a load of wᵀq.
  [[nodiscard]] double contact_potential(DrivePhase p, const Eigen::VectorXd& x) const;
  [[nodiscard]] StayWork values(double t, const Eigen::VectorXd& x);

  const Regime& regime_;
  const DriveOverlay& overlay_;
  Form contact_, drive_, viscous_, force_;
  double begin_ = 0.0;
  Eigen::VectorXd inputs_, resting_;  ///< of this stay; x of constant inputs
  Eigen::VectorXd free_;              ///< x_f
  StayWork at_begin_;
};

}  // namespace slipmode::dynamics
