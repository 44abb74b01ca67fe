#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include "dynamics/internal/closed_form_flow.hpp"
#include "dynamics/internal/collocation_flow.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <string>

namespace slipmode::dynamics {

struct TangentFlow::Implementation {
  HybridSystem system;
  FlowOptions options;
  FlowMethod method;
  std::unique_ptr<ClosedFormFlow> closed_form = {};  ///< from the first run on
  Eigen::MatrixXd enter = {}, leave = {};            ///< (q, q̇, internal) to its tangents' coordinates and back

  void set_coordinates(const ModalModel& m);
  template <class AnyFlow>
  TangentResult run(AnyFlow& flow, const ModalModel& m, double end, const Eigen::MatrixXd& directions);
};

void TangentFlow::Implementation::set_coordinates(const ModalModel& m) {
  // The closed-form flow's tangents are without padding.
  const Eigen::Index n = m.n, np = m.np, pairs = method == FlowMethod::kClosedForm ? n : np;
  const Eigen::Index own = system.internal_size();
  enter = Eigen::MatrixXd::Zero(2 * pairs + own, 2 * n + own);
  leave = Eigen::MatrixXd::Zero(2 * n + own, 2 * pairs + own);
  enter.topLeftCorner(2 * pairs, 2 * n) << m.from_q.topRows(pairs), m.from_v.topRows(pairs),
      m.from_q.middleRows(np, pairs), m.from_v.middleRows(np, pairs);
  leave.topLeftCorner(2 * n, 2 * pairs) << m.to_q.leftCols(pairs), m.to_q.middleCols(np, pairs), m.to_v.leftCols(pairs),
      m.to_v.middleCols(np, pairs);
  enter.bottomRightCorner(own, own) = leave.bottomRightCorner(own, own) = Eigen::MatrixXd::Identity(own, own);
}

template <class AnyFlow>
TangentResult TangentFlow::Implementation::run(AnyFlow& flow, const ModalModel& m, double end,
                                               const Eigen::MatrixXd& directions) {
  if (enter.size() == 0) set_coordinates(m);
  flow.set_tangents(enter * directions);
  TangentResult out;
  while (flow.point().time < end)
    if (advance_flow(flow, m, end)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  out.end = end_state(system, m, flow.point());
  out.monodromy = leave * flow.tangents();
  out.rate = leave * flow.point_rate();
  return out;
}

TangentFlow::TangentFlow(const HybridSystem& system, const FlowOptions& options)
    : implementation_(
          std::make_unique<Implementation>(Implementation{system, options, choose_method(system, options.method)})) {}
TangentFlow::TangentFlow(TangentFlow&&) noexcept = default;
TangentFlow& TangentFlow::operator=(TangentFlow&&) noexcept = default;
TangentFlow::~TangentFlow() = default;

TangentResult TangentFlow::run(const State& start, double duration) {
  const Eigen::Index size = 2 * implementation_->system.size() + implementation_->system.internal_size();
  return run(start, duration, Eigen::MatrixXd::Identity(size, size));
}

TangentResult TangentFlow::run(const State& start, double duration, const Eigen::MatrixXd& directions) {
  if (!(duration >= 0 && std::isfinite(duration))) throw InvalidInput("duration must be finite and not negative");
  Implementation& own = *implementation_;
  const Eigen::Index size = 2 * own.system.size() + own.system.internal_size();
  if (directions.rows() != size)
    throw InvalidInput("tangents have " + std::to_string(directions.rows()) + " rows; the state has " +
                       std::to_string(size) + " (displacements, velocities, contacts' own states)");
  Prepared p = prepare(own.system, start, own.options, false);
  const ModalModel& m = p.tables.model;
  const double end = start.time + duration;
  if (own.method == FlowMethod::kCollocation) {
    CollocationFlow flow(own.system, p.tables.steps, std::move(p.start), p.options);
    return own.run(flow, m, end, directions);
  }
  if (own.closed_form)
    own.closed_form->restart(std::move(p.start));
  else
    own.closed_form = std::make_unique<ClosedFormFlow>(own.system, std::move(p.start), p.options);
  return own.run(*own.closed_form, m, end, directions);
}

TangentResult tangent_flow(const HybridSystem& system, const State& start, double duration,
                           const FlowOptions& options) {
  return TangentFlow(system, options).run(start, duration);
}

}  // namespace slipmode::dynamics
