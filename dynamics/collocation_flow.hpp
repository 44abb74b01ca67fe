#pragma once

#include "dynamics/bernstein.hpp"
#include "dynamics/consistency.hpp"
#include "dynamics/simulate.hpp"
#include "dynamics/step_tables.hpp"

#include <Eigen/Core>
#include <vector>

namespace slipmode::dynamics {

/// Running sums of the energy balance (see EnergyAudit).
struct WorkSums {
  double contact_work = 0.0, drive_work = 0.0, viscous_loss = 0.0, exchanged = 0.0;
};

/// The flow by scalar Volterra collocation: between events only contact forces are unknown, eight numbers per contact
/// and step, whatever n is; the linear part is exact. In slip the eight equations λ_i = law(w_i) are solved by Newton;
/// in stick the eight forces that hold wᵀq̇ = v_belt. Slip and stick share the modal basis, so an event costs no change
/// of basis. Theory: docs/theory/flow.md.
///
/// A step ends at the time asked, at the end of a tabulated step, or at an event, whichever comes first. The last step
/// stays readable (`evaluate`) until the next one.
class CollocationFlow {
 public:
  /// @param x  state of the modal model [2np]
  CollocationFlow(const HybridSystem& system, const StepTables& tables, Eigen::VectorXd x, double time,
                  std::vector<ContactMode> modes, const FlowOptions& options, bool dense);

  /// Advances by one step, not beyond t_limit (> time()). True if it ended at an event.
  bool step(double t_limit);

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double step_begin() const { return begin_; }
  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
  [[nodiscard]] const std::vector<ContactMode>& modes() const { return modes_; }
  /// Events that ended the last step (simultaneous ones together).
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  [[nodiscard]] const WorkSums& work() const { return work_; }
  [[nodiscard]] const FlowStatistics& statistics() const { return statistics_; }

  /// State and contact forces at a time within the last step.
  void evaluate(double t, Eigen::VectorXd& out_x, Eigen::VectorXd& out_force) const;

  /// Carries these tangent vectors along, with saltation at events [2np x k].
  /// A direction that would break a stick is projected along the contact's force: the friction impulse of re-sticking.
  void set_tangents(Eigen::MatrixXd tangents);
  [[nodiscard]] const Eigen::MatrixXd& tangents() const { return tangents_; }

 private:
  struct Guarded {
    double theta = 1.0;  ///< fraction of the step at which the first guard is reached
    int contact = -1;
    bool touching = false;
  };

  void free_velocities(const Collocation& table);
  void guess_forces(int level, bool retry);
  [[nodiscard]] int foreseen_level(int level) const;
  bool solve_forces(const Collocation& table, double h);
  bool solve_single_slip(const Collocation& table);
  bool solve_coupled(const Collocation& table);
  [[nodiscard]] double force_error() const;
  [[nodiscard]] Guarded first_guard() const;
  [[nodiscard]] double deepest_overshoot() const;
  void advance_full(const Propagator& p, const double* x, const double* forces, double* out_x) const;
  void advance_partial(const double* x, const double* forces, int level, double tau, double* out_x) const;
  void refine_event(const Guarded& guard, double& tau, Eigen::VectorXd& x) const;
  [[nodiscard]] double stick_force(int c, const Eigen::VectorXd& x, double tau,
                                   const RadauTables::Vector8& basis) const;
  void account(int level, double theta);
  void settle_event(int contact, bool touching);
  void settle_single();
  void settle_coupled(int contact);
  void record(int contact, EventKind kind, ContactMode before);
  void record_change(int contact, ContactMode before);
  void guard_against_zeno();
  void start_modes(const Resolution& resolution);
  void restart_steps();
  void push_tangents(int level, double tau);
  void salt_tangents(const Eigen::VectorXd& force_before, const Eigen::VectorXd& force_after,
                     const std::vector<ContactMode>& modes_before, int contact);
  [[nodiscard]] double force_slope(int c, ContactMode mode, double velocity, double belt) const;

  [[nodiscard]] std::size_t stuck_count() const;
  [[nodiscard]] double contact_velocity(int c, const double* x) const;
  [[nodiscard]] Instant instant(const Eigen::VectorXd& x) const;

  const StepTables& tables_;
  const RadauTables& nodes_ = radau();
  const ModalModel& model_;
  friction::Belt belt_;
  FlowOptions options_;
  bool dense_;
  int nc_;
  std::vector<ContactForces> laws_;
  std::vector<double> steep_speed_;  ///< sliding speed at which a law is just resolved by the largest step [m/s]

  double time_, begin_;
  Eigen::VectorXd x_, x_begin_, x_end_;
  std::vector<ContactMode> modes_, step_modes_;
  std::vector<int> multiplicity_, step_multiplicity_;
  Eigen::VectorXd force_now_;  ///< λ at time_
  int level_ = 3, step_level_ = 0;
  bool solved_ = false;           ///< forces_ hold a solution of the step of step_level_ that began at step_begin()
  bool fresh_ = true;             ///< no step taken since the last event
  std::vector<int> start_level_;  ///< remembered first step size after an event, by number of sticking contacts

  // One step's scalars, contact after contact, eight nodes each.
  Eigen::VectorXd free_, velocity_, forces_, belt_nodes_, slope_;

  std::vector<Event> events_;
  std::vector<double> recent_events_;
  WorkSums work_;
  FlowStatistics statistics_;
  Eigen::MatrixXd tangents_;
};

}  // namespace slipmode::dynamics
