#include "core/errors.hpp"
#include "dynamics/closed_form_flow.hpp"
#include "dynamics/collocation_flow.hpp"
#include "dynamics/prepare.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <string>

namespace slipmode::dynamics {

struct TangentFlow::Implementation {
  HybridSystem system;
  FlowOptions options;
  FlowMethod method;
  std::unique_ptr<ClosedFormFlow> closed_form = {};  ///< from the first run on

  TangentResult run(ClosedFormFlow& flow, const ModalModel& m, double end, const Eigen::MatrixXd& directions) const;
  TangentResult run(CollocationFlow& flow, const ModalModel& m, double end, const Eigen::MatrixXd& directions) const;
  template <class AnyFlow>
  void advance_to(AnyFlow& flow, const ModalModel& m, double end, TangentResult& out) const;
};

template <class AnyFlow>
void TangentFlow::Implementation::advance_to(AnyFlow& flow, const ModalModel& m, double end, TangentResult& out) const {
  while (flow.point().time < end)
    if (advance_flow(flow, m, end)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  out.end = physical(m, flow.point());
}

TangentResult TangentFlow::Implementation::run(ClosedFormFlow& flow, const ModalModel& m, double end,
                                               const Eigen::MatrixXd& directions) const {
  const Eigen::Index n = m.n, own = system.internal_size();
  Eigen::MatrixXd start(2 * m.np + own, directions.cols());
  start.topRows(2 * m.np) = m.from_q * directions.topRows(n) + m.from_v * directions.middleRows(n, n);
  start.bottomRows(own) = directions.bottomRows(own);
  flow.set_tangents(start);
  TangentResult out;
  advance_to(flow, m, end, out);
  const auto lifted = [&](const Eigen::MatrixXd& tangents) {
    Eigen::MatrixXd physical(2 * n + own, tangents.cols());
    physical << m.to_q * tangents.topRows(2 * m.np), m.to_v * tangents.topRows(2 * m.np), tangents.bottomRows(own);
    return physical;
  };
  out.monodromy = lifted(flow.tangents());
  out.rate = lifted(flow.point_rate());
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
