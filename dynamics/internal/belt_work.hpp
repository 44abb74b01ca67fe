#pragma once

#include <slipmode/dynamics/regime.hpp>
#include "dynamics/internal/audit_forms.hpp"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace slipmode::dynamics {

/// The energy audit under a belt of constant speed without quadrature. What follows the inputs, x_p, moves at constant
/// velocity; beside it ẋ_f = G x_f, so that with [·] the change over a stay
///
///     ∫ rᵀx_f = [yᵀx_f],  Gᵀy = r;     ∫ x_fᵀQ x_f = [x_fᵀY x_f],  GᵀY + YG = Q,
///
/// the second minus the energy of the damped modes, −[½ (η_f'² + ω² η_f²)], where modes are real. The contacts' work is
/// λ [wᵀq] under a constant force, V ∫ λ in stick, less [½ λ²/K_c] behind a contact spring. Costs O(n) per stay in real
/// modes, else O(n²) of few pairs and one lift of many. Source: docs/theory/flow.md, section 6.
class BeltWork {
 public:
  /// Null where the integrals have no such form: rigid-body motion, or pairs that hardly decay where
  /// squares of x_f are needed: in complex modes, at stops, under normal oscillators.
  [[nodiscard]] static std::unique_ptr<BeltWork> make(const RegimeTables& tables, const ModalModel& slipping);

  /// Starts a stay.
  void begin(const StayPlace& at, const Eigen::VectorXd& inputs);
  /// Work since `begin` or the last `until`.
  [[nodiscard]] StayWork until(const StayPlace& at, const Eigen::VectorXd& inputs);

 private:
  /// How a contact's work is found.
  enum class Exchange : std::uint8_t {
    kFollows,    ///< its velocity is the belt's, but for what a spring stores
    kPotential,  ///< its force is constant, or a function of wᵀq
    kForms,      ///< neither: a square of x_f, and more
  };
  /// What has an antiderivative, at one end of a stay; of the contacts, [nc] each.
  struct End {
    double time = 0.0;
    double loss = 0.0;         ///< of squares of x_f
    double dragged = 0.0;      ///< of x_f with what x_p moves at
    double squares = 0.0;      ///< of contacts' forces by x_f with velocities by x_f
    Eigen::VectorXd impulse;   ///< ∫ of λ by x_f
    Eigen::VectorXd steady;    ///< λ by x_p
    Eigen::VectorXd exchange;  ///< by kind: −½ λ²/K_c; ∫ λ d(wᵀq); wᵀq by x_f
    Eigen::VectorXd way;       ///< ∫ of wᵀq by x_f
  };

  BeltWork(const Regime& regime, const ModalModel& slipping);
  void measure(const StayPlace& at, const Eigen::VectorXd& inputs, End& out);
  [[nodiscard]] double loss_of_squares(const StayPlace& at, const Eigen::VectorXd& inputs);

  const Regime& regime_;
  const ModalModel& slipping_;
  const RegimeForms* forms_ = nullptr;  ///< null: real modes, no squares in contacts' work
  std::vector<Exchange> exchange_;      ///< [nc]
  Eigen::MatrixXd impulse_, way_;       ///< y of λ and of wᵀq [2np x nc]
  Eigen::VectorXd dragging_;            ///< y of 2 (loss of x_f with x_p at V = 1) [2np]
  double dragged_loss_ = 0.0;           ///< q̇ᵀCq̇ of x_p at V = 1
  Eigen::VectorXd stiffness_, mass_;    ///< ω² and 1 of damped real modes, else 0 [np]
  Eigen::MatrixXd held_;  ///< ι → state in the slipping model that x_p is; empty if not needed [2np_s x ni]
  Eigen::VectorXd lifted_;
  End begin_, end_;
};

}  // namespace slipmode::dynamics
