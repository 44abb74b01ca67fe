#pragma once

#include "dynamics/bernstein.hpp"
#include "dynamics/cache.hpp"
#include "dynamics/event_resolver.hpp"

#include <Eigen/Core>
#include <vector>

namespace slipmode::dynamics {

/// The flow of a piecewise-linear system in closed form: within a regime every state is an exact modal solution, and a
/// window is passed only when its guards are proved positive on all of it. The proof: the guard's interpolant of degree
/// 7 in Bernstein form (convex hull), less a bound on what interpolation leaves out, from the amplitudes of the pairs.
/// Theory: docs/theory/flow.md.
///
/// A step ends at the time asked, at the end of a window, or at an event. The last step stays readable (`evaluate`)
/// until the next one.
class ClosedFormFlow {
 public:
  /// @param start  its modes may be undecided where a contact is at rest on the belt; laws must be piecewise linear
  ClosedFormFlow(const HybridSystem& system, HybridPoint start, const FlowOptions& options);

  /// Advances by one step, not beyond t_limit (> time). True if it ended at an event.
  bool step(double t_limit);

  /// `x` and `force` are brought up to date at events and at the time asked, `time` and `modes` always.
  [[nodiscard]] const HybridPoint& point() const { return point_; }
  [[nodiscard]] const std::vector<Event>& events() const { return resolver_.events(); }
  [[nodiscard]] const WorkSums& work() const { return work_; }
  [[nodiscard]] const FlowStatistics& statistics() const { return statistics_; }

  /// State and contact forces at a time within the last step.
  void evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const;

 private:
  /// What a search of one window found.
  struct Search {
    int contact = -1;       ///< whose guard may vanish first; −1: none in this window
    double at = 1.0;        ///< fraction of the window before which no guard vanishes
    bool resolved = false;  ///< nothing is left out that matters: `at` is the event
    bool touching = false;  ///< resolved: the guard comes within tolerance of zero and goes back
    bool alone = true;      ///< no other guard may vanish in this window
    int refinement = 1;     ///< not resolved: levels to go down until it is
    double spare = 1e300;   ///< smallest ratio of a guard's least value to its remainder
  };

  void enter_regime();
  [[nodiscard]] bool has_guard(int c) const;
  void measure_amplitudes();
  void foresee_starts();
  [[nodiscard]] Search search(int level) const;
  void judge(const BernsteinPolynomial& guard, double remainder, double tolerance, int contact, Search& found) const;
  /// Takes the state on to where the guard vanishes; tau follows. True if that is proved to be the first time.
  [[nodiscard]] bool approach(int contact, double& tau);
  /// Bound on the second derivative of an output over the window.
  [[nodiscard]] double curvature(int contact) const;
  void account(double tau);
  /// State of the slipping model and contact forces.
  void lift(const Regime& regime, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, Eigen::VectorXd& out_x,
            Eigen::VectorXd& out_force) const;
  [[nodiscard]] bool settle(int contact, bool touching);

  const HybridSystem& system_;
  const ModalModel& slipping_;
  EventResolver resolver_;
  FlowOptions options_;
  int nc_;
  HybridPoint point_;

  const RegimeTables* tables_ = nullptr;
  const RegimeTables* step_tables_ = nullptr;  ///< those of the last step
  Eigen::VectorXd x_, inputs_, x_begin_, inputs_begin_, amplitude_;
  double begin_ = 0.0;
  int level_ = 0;
  std::vector<double> exempt_until_;  ///< [nc] guards known to be clear up to this time

  WorkSums work_;
  FlowStatistics statistics_;
  std::vector<std::pair<std::vector<bool>, const RegimeTables*>> visited_;
};

}  // namespace slipmode::dynamics
