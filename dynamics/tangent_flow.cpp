#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include "dynamics/internal/closed_form_flow.hpp"
#include "dynamics/internal/collocation_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

namespace slipmode::dynamics {

struct TangentFlow::Implementation {
  HybridSystem system;
  FlowOptions options;                               ///< of the method chosen
  std::unique_ptr<ClosedFormFlow> closed_form = {};  ///< from the first run on
  Eigen::MatrixXd enter = {}, leave = {};            ///< (q, q̇, internal) to its tangents' coordinates and back

  void set_coordinates(const ModalModel& m);
  template <class AnyFlow>
  TangentResult run(AnyFlow& flow, const ModalModel& m, double end, const std::vector<double>& times,
                    const TangentSample& sample);
  void check(const Tangents& tangents) const;
  /// What tangents in (q, q̇, internal) are once a contact has turned at the start: it would have, a little earlier or
  /// later.
  [[nodiscard]] Eigen::MatrixXd turned(Eigen::MatrixXd tangents, const TurnAtStart& turn, const ModalModel& m) const;
};

Eigen::MatrixXd TangentFlow::Implementation::turned(Eigen::MatrixXd tangents, const TurnAtStart& turn,
                                                    const ModalModel& m) const {
  if (turn.contact < 0 || turn.acceleration == 0.0) return tangents;  // reached at rest: when is nobody's
  auto speeds = tangents.middleRows(m.n, m.n);
  const Eigen::VectorXd& direction = system.contacts()[static_cast<std::size_t>(turn.contact)].direction;
  const Eigen::RowVectorXd delay = -direction.transpose() * speeds / turn.acceleration;
  speeds += m.to_v * (m.input * turn.force_change) * delay;
  return tangents;
}

void TangentFlow::Implementation::set_coordinates(const ModalModel& m) {
  // The closed-form flow's tangents are without padding.
  const Eigen::Index n = m.n, np = m.np, pairs = options.method == FlowMethod::kClosedForm ? n : np;
  const Eigen::Index own = system.internal_size();
  enter = Eigen::MatrixXd::Zero(2 * pairs + own, 2 * n + own);
  leave = Eigen::MatrixXd::Zero(2 * n + own, 2 * pairs + own);
  enter.topLeftCorner(2 * pairs, 2 * n) << m.from_q.topRows(pairs), m.from_v.topRows(pairs),
      m.from_q.middleRows(np, pairs), m.from_v.middleRows(np, pairs);
  leave.topLeftCorner(2 * n, 2 * pairs) << m.to_q.leftCols(pairs), m.to_q.middleCols(np, pairs), m.to_v.leftCols(pairs),
      m.to_v.middleCols(np, pairs);
  enter.bottomRightCorner(own, own) = leave.bottomRightCorner(own, own) = Eigen::MatrixXd::Identity(own, own);
}

void TangentFlow::Implementation::check(const Tangents& tangents) const {
  const Eigen::Index size = 2 * system.size() + system.internal_size(), directions = system.force_directions().cols();
  if (tangents.start.rows() != size)
    throw InvalidInput("tangents have " + std::to_string(tangents.start.rows()) + " rows; the state has " +
                       std::to_string(size) + " (displacements, velocities, contacts' own states)");
  const Eigen::Index rows = tangents.forces.rows();
  if (rows == 0) return;
  if (system.drive().force() == nullptr || directions == 0)
    throw InvalidInput("tangents of forces need a force drive with directions");
  if (options.method == FlowMethod::kCollocation)
    throw InvalidInput("tangents of forces need the closed-form flow, whose laws are piecewise linear");
  if (rows % directions != 0 || rows / directions % 2 == 0 || tangents.forces.cols() != tangents.start.cols())
    throw InvalidInput("tangents of forces are " + std::to_string(rows) + " x " +
                       std::to_string(tangents.forces.cols()) + "; valid: 2H + 1 rows for each of " +
                       std::to_string(directions) + " directions, " + std::to_string(tangents.start.cols()) +
                       " columns");
}

template <class AnyFlow>
TangentResult TangentFlow::Implementation::run(AnyFlow& flow, const ModalModel& m, double end,
                                               const std::vector<double>& times, const TangentSample& sample) {
  TangentResult out;
  out.events = flow.events();
  const auto go_on = [&](double until) {
    while (flow.point().time < until)
      if (advance_flow(flow, m, until)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  };
  for (const double time : times) {
    go_on(time);
    sample(end_state(system, m, flow.point()), leave * flow.tangents());
  }
  go_on(end);
  out.end = end_state(system, m, flow.point());
  out.monodromy = leave * flow.tangents();
  out.rate = leave * flow.point_rate();
  return out;
}

TangentFlow::TangentFlow(const HybridSystem& system, const FlowOptions& options)
    : implementation_(std::make_unique<Implementation>(Implementation{system, with_method(system, options)})) {}
TangentFlow::TangentFlow(TangentFlow&&) noexcept = default;
TangentFlow& TangentFlow::operator=(TangentFlow&&) noexcept = default;
TangentFlow::~TangentFlow() = default;

TangentResult TangentFlow::run(const State& start, double duration) {
  const Eigen::Index size = 2 * implementation_->system.size() + implementation_->system.internal_size();
  return run(start, duration, {.start = Eigen::MatrixXd::Identity(size, size)});
}

TangentResult TangentFlow::run(const State& start, double duration, const Tangents& tangents,
                               const std::vector<double>& times, const TangentSample& sample) {
  if (!(duration >= 0 && std::isfinite(duration))) throw InvalidInput("duration must be finite and not negative");
  Implementation& own = *implementation_;
  own.check(tangents);
  if (!std::ranges::is_sorted(times) ||
      (!times.empty() && (!sample || !(times.front() >= start.time) || !(times.back() <= start.time + duration))))
    throw InvalidInput("times to sample a run at must be in order and within it, with something to call at them");
  Prepared p = prepare(own.system, start, own.options, false);
  const ModalModel& m = p.tables.model;
  const double end = start.time + duration;
  if (own.enter.size() == 0) own.set_coordinates(m);
  if (own.options.method == FlowMethod::kCollocation) {
    CollocationFlow flow(own.system, p.tables.steps, std::move(p.start), p.options);
    flow.set_tangents(own.enter * own.turned(tangents.start, flow.turn_at_start(), m));
    return own.run(flow, m, end, times, sample);
  }
  if (own.closed_form)
    own.closed_form->restart(std::move(p.start));
  else
    own.closed_form = std::make_unique<ClosedFormFlow>(own.system, std::move(p.start), p.options);
  const TurnAtStart& turn = own.closed_form->turn_at_start();
  own.closed_form->set_tangents(own.enter * own.turned(tangents.start, turn, m), tangents.forces);
  return own.run(*own.closed_form, m, end, times, sample);
}

TangentResult tangent_flow(const HybridSystem& system, const State& start, double duration,
                           const FlowOptions& options) {
  return TangentFlow(system, options).run(start, duration);
}

}  // namespace slipmode::dynamics
