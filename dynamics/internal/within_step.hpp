#pragma once

#include <slipmode/dynamics/step_tables.hpp>

#include <Eigen/Core>

namespace slipmode::dynamics {

/// The motion inside one step of tabulated size whose contact forces are polynomials through its nodes: walked in
/// pieces that are tabulated steps too, halving down the table, until what is left is short enough for a Taylor series.
/// Where that series begins is kept, so that times near one another cost one walk.
class WithinStep {
 public:
  /// Whether the constant load acts: on states it does, on their differences (tangent vectors) it does not.
  enum class Load : bool { kLeftOut, kIncluded };

  /// @param audit  `work` will be asked for
  WithinStep(const StepTables& tables, bool audit, Load load = Load::kIncluded);

  /// Another step. The arrays are not copied: they must stay as they are. @param x  state at its begin [2np]
  /// @param forces  at its nodes, contact after contact [8nc]
  void begin(const double* x, const double* forces, int level);
  /// State at tau, within the step [2np].
  void state(double tau, double* out_x);
  /// The state at tau becomes the one at tau + shift, which is cheap where the shift is small [2np].
  void shift(double tau, double shift, double* x);
  /// Work of contacts and drive, and viscous loss, over [0, tau].
  [[nodiscard]] kernels::Work work(double tau);

 private:
  void seek(double tau);
  /// Coefficients of (t/rest)^k in the forces, times rest, from where the series begins [8nc].
  const double* coefficients(double rest);

  const StepTables& tables_;
  const ModalModel& model_;
  const RadauTables& nodes_ = radau();
  const kernels::Kernels& kernels_ = kernels::kernels();
  bool audit_, loaded_;
  kernels::PairArrays pairs_;

  const double* x_ = nullptr;
  const double* forces_ = nullptr;
  int level_ = 0;

  bool found_ = false;      ///< the following belong to this step
  double base_time_ = 0.0;  ///< where the series begins
  int base_level_ = 0;      ///< of the piece that begins there
  kernels::Work before_;    ///< work until there
  double steepness_ = 0.0;  ///< of the forces there: the coefficient of (t/h)⁷ by their size
  Eigen::VectorXd base_, next_, current_, other_, monomials_, scaled_, velocities_, moments_, points_;
};

}  // namespace slipmode::dynamics
