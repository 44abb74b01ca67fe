#pragma once

#include <slipmode/dynamics/modal_model.hpp>

#include <Eigen/Core>

namespace slipmode::dynamics {

/// Free motion of oscillating pairs over any time at once, e^{Gt} = e^{τt}(c I + s A), A = (G − τI)/w, A² = −I.
///
/// What is computed is e^{Gt} − I, exact to rounding however short the time and slow the pair: the change of a state
/// loses nothing where a large static deflection is a part of it.
class PairMotion {
 public:
  PairMotion() = default;
  explicit PairMotion(const ModalModel& pairs);

  /// False when a pair does not oscillate, or hardly: then there is no such formula.
  [[nodiscard]] bool available() const { return available_; }
  /// x += (e^{Gt} − I) free. @param x, free  [2np], not the same
  void add(double t, const double* free, double* x) const;

 private:
  bool available_ = false;
  Eigen::VectorXd decay_, frequency_;  ///< τ and w [np]
  Eigen::VectorXd a11_, a12_, a21_;    ///< A; its trace is zero [np]
};

}  // namespace slipmode::dynamics
