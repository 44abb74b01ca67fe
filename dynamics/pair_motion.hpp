#pragma once

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/dynamics/modal_model.hpp>

#include <Eigen/Core>
#include <vector>

namespace slipmode::dynamics {

/// Free motion of oscillating pairs over any time at once, e^{Gt} = e^{τt}(c I + s A), A = (G − τI)/w, A² = −I.
///
/// What is computed is e^{Gt} − I, exact to rounding however short the time and slow the pair: the change of a state
/// loses nothing where a large static deflection is a part of it.
class PairMotion {
 public:
  PairMotion() = default;
  /// @param slowest  frequency at and below which a pair is none of them [1/s]
  explicit PairMotion(const ModalModel& pairs, double slowest = 0.0);

  /// All pairs oscillate.
  [[nodiscard]] bool available() const { return decay_.size() > 0 && others_.empty(); }
  /// Pairs that do not oscillate, or hardly, for which there is no such formula, in ascending order.
  [[nodiscard]] const std::vector<Eigen::Index>& others() const { return others_; }
  /// e^{Gt} − I of the pairs that do oscillate, a column for each time: entries 11, 12, 21 and 22 of all [4np x times].
  [[nodiscard]] Eigen::MatrixXd changes(const Eigen::VectorXd& times) const;
  /// x += (e^{Gt} − I) free of the pairs that do oscillate. @param x, free  [2np], not the same
  void add(double t, const double* free, double* x) const;

 private:
  [[nodiscard]] kernels::MotionArrays arrays() const;

  Eigen::VectorXd decay_, frequency_;  ///< τ and w [np]
  Eigen::VectorXd a11_, a12_, a21_;    ///< A; its trace is zero [np]
  std::vector<Eigen::Index> others_;
};

}  // namespace slipmode::dynamics
