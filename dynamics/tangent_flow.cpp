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

  TangentResult run(ClosedFormFlow& flow, const ModalModel& m, double end, const Eigen::MatrixXd& directions);
  TangentResult run(CollocationFlow& flow, const ModalModel& m, double end, const Eigen::MatrixXd& directions) const;
  template <class AnyFlow>
  void advance_to(AnyFlow& flow, const ModalModel& m, double end, TangentResult& out) const;
};

template <class AnyFlow>
void TangentFlow::Implementation::advance_to(AnyFlow& flow, const ModalModel& m, double end, TangentResult& out) const {
  while (flow.point().time < end)
    if (advance_flow(flow, m, end)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  out.end = end_state(system, m, flow.point());
}

TangentResult TangentFlow::Implementation::run(ClosedFormFlow& flow, const ModalModel& m, double end,
                                               const Eigen::MatrixXd& directions) {
  if (enter.size() == 0) {
    const Eigen::Index n = m.n, np = m.np, own = system.internal_size();
    enter = leave = Eigen::MatrixXd::Identity(2 * n + own, 2 * n + own);
    enter.topLeftCorner(2 * n, 2 * n) << m.from_q.topRows(n), m.from_v.topRows(n), m.from_q.middleRows(np, n),
        m.from_v.middleRows(np, n);
    leave.topLeftCorner(2 * n, 2 * n) << m.to_q.leftCols(n), m.to_q.middleCols(np, n), m.to_v.leftCols(n),
        m.to_v.middleCols(np, n);
  }
  flow.set_tangents(enter * directions);
  TangentResult out;
  advance_to(flow, m, end, out);
  out.monodromy = leave * flow.tangents();
  out.rate = leave * flow.point_rate();
  return out;
}

TangentResult TangentFlow::Implementation::run(CollocationFlow& flow, const ModalModel& m, double end,
                                               const Eigen::MatrixXd& directions) const {
  Eigen::MatrixXd basis(2 * m.np, 2 * m.n);
  basis << m.from_q, m.from_v;
  flow.set_tangents(basis * directions);
  TangentResult out;
  advance_to(flow, m, end, out);
  out.monodromy.resize(2 * m.n, directions.cols());
  out.monodromy << m.to_q * flow.tangents(), m.to_v * flow.tangents();
  const Eigen::VectorXd rate = m.rate(flow.point().x, flow.point().force);
  out.rate.resize(2 * m.n);
  out.rate << m.to_q * rate, m.to_v * rate;
  return out;
}

TangentFlow::TangentFlow(const HybridSystem& system, const FlowOptions& options)
    : implementation_(
          std::make_unique<Implementation>(Implementation{system, options, choose_method(system, options.method)})) {
  if (implementation_->method == FlowMethod::kCollocation && system.internal_size() > 0)
    throw InvalidInput(
        "the tangent flow carries displacements and velocities, but a contact's law (Dahl, LuGre) has a state of its "
        "own; use a law without one, or differences of simulated motions");
}
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
