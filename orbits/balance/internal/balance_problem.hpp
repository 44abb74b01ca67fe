#pragma once

#include <slipmode/orbits/balance/balance.hpp>
#include "orbits/balance/internal/balanced_law.hpp"

#include <Eigen/Core>
#include <vector>

namespace slipmode::orbits {

/// The pairs' inputs of a force drive at order k of the orbit's period, as phasors; zeros under a shaker.
/// @param order  Balance::order
[[nodiscard]] Eigen::VectorXcd drive_phasors(const dynamics::HybridSystem& system, Eigen::Index order, Eigen::Index k);

/// How the structure answers at its contacts, order by order. Contacts of one displacement are one place: their forces
/// add up, and it is solved for once.
class ContactResponse {
 public:
  /// @param order  periods of the drive in one of the balance
  ContactResponse(const dynamics::HybridSystem& system, int order, Eigen::Index harmonics);

  [[nodiscard]] double omega() const { return omega_; }
  [[nodiscard]] Eigen::Index places() const { return std::ssize(contacts_at); }
  [[nodiscard]] Eigen::Index harmonics() const { return harmonics_; }
  [[nodiscard]] Eigen::Index block() const { return 2 * harmonics_ + 1; }
  [[nodiscard]] Eigen::Index unknowns() const { return places() * block() + rigid_rows.cols(); }
  [[nodiscard]] int order() const { return order_; }
  /// Of an unknown; 0 of what floats.
  [[nodiscard]] Eigen::Index order_of(Eigen::Index unknown) const;

  /// The orders that Newton's method solves together: those beyond answer their forces by less than a share of their
  /// motion, and follow by substitution.
  [[nodiscard]] Eigen::Index lead(const dynamics::HybridSystem& system) const;

  std::vector<std::vector<std::size_t>> contacts_at;  ///< of each place [np]
  TrigonometricPolynomial counterpart;                ///< d, what a shaker moves the contacts' counterpart by
  std::vector<Eigen::MatrixXcd> receptance;           ///< R_k [np x np]
  std::vector<Eigen::VectorXcd> own;                  ///< e_k
  Eigen::MatrixXd rigid_rows;                         ///< Z [np x nr]
  Eigen::VectorXd rigid_load;                         ///< of the modes that float [nr]

 private:
  int order_;
  Eigen::Index harmonics_;
  double omega_;
};

/// Which orders there are: all, or the odd ones of a motion that has no others, and keeps to them.
enum class Parity : std::uint8_t { kAll, kOdd };

/// Newton's equations at a point.
struct BalanceEvaluation {
  Eigen::VectorXd x, residual;
  Parity parity = Parity::kAll;
  Eigen::MatrixXd jacobian;           ///< of the leading orders; of the odd ones what floats is no unknown
  std::vector<BalancedForce> forces;  ///< of each contact, without derivatives
  std::vector<BalancedForce> sums;    ///< of each place
  double relative = 0.0;
};

/// The equations of `balance`. Unknowns place after place (cosine_0 … cosine_H, sine_1 … sine_H), then what floats.
class BalanceProblem {
 public:
  /// @param response  outlives this
  /// @param lead      orders that Newton's method solves together
  BalanceProblem(const dynamics::HybridSystem& system, const ContactResponse& response, int samples, Eigen::Index lead);

  /// Laws on the way from linear ones to their own: gaps in this share, limits of friction over it.
  void set_share(double share);

  [[nodiscard]] BalanceEvaluation evaluate(const Eigen::VectorXd& x, Parity parity = Parity::kAll) const;
  /// Of a motion without even orders in a system that is its own mirror image: odd.
  [[nodiscard]] Parity parity_of(const Eigen::VectorXd& x) const;
  /// No contact's force changes with its mean displacement: where the mean floats, it is free.
  [[nodiscard]] bool leaves_means_open(const BalanceEvaluation& at) const;

  /// The step: Newton's for the leading orders, of least norm where the equations leave something open, and
  /// substitution for those beyond.
  [[nodiscard]] Eigen::VectorXd step(const BalanceEvaluation& at) const;
  /// The equations, of all orders, do not tell all unknowns.
  [[nodiscard]] bool leaves_something_open(const BalanceEvaluation& at) const;

  /// The series at a point; `iterations`, `family`, `converged` and `message` are left to the caller.
  /// @param order  periods of the drive in one of the balance
  [[nodiscard]] Balance series_of(const BalanceEvaluation& at, int order) const;

 private:
  [[nodiscard]] double size_of(const Eigen::VectorXd& x) const;
  /// Jacobian's block of place c by place d: less R_k times the force's derivative.
  void take_off(Eigen::Index c, Eigen::Index d, BalanceEvaluation& out) const;
  /// Zᵀλ_0 + p = 0 for what floats.
  void add_equilibrium(BalanceEvaluation& out) const;

  const ContactResponse& response_;
  int samples_;
  Eigen::Index lead_;
  bool symmetric_;
  std::vector<Eigen::Index> all_, odd_, even_;  ///< entries of x: those of the leading orders, and all of even order
  std::vector<BalancedLaw> own_laws_, laws_;    ///< at share 1, and at the one set
};

/// The solution of a square system, of least norm where it is singular: a structure that floats in the gap.
[[nodiscard]] Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                                  bool& out_singular);

/// A guess's coefficients as unknowns of this order; what floats is given the mean that fits best.
[[nodiscard]] Eigen::VectorXd unknowns_of(const std::vector<Harmonics>& guess, const ContactResponse& response);

}  // namespace slipmode::orbits
