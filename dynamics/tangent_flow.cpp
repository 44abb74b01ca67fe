#include "core/errors.hpp"
#include "dynamics/collocation_flow.hpp"
#include "dynamics/prepare.hpp"

#include <Eigen/Dense>

namespace slipmode::dynamics {

struct TangentFlow::Implementation {
  HybridSystem system;
  FlowOptions options;
};

TangentFlow::TangentFlow(const HybridSystem& system, const FlowOptions& options)
    : implementation_(std::make_unique<Implementation>(Implementation{system, options})) {}
TangentFlow::TangentFlow(TangentFlow&&) noexcept = default;
TangentFlow& TangentFlow::operator=(TangentFlow&&) noexcept = default;
TangentFlow::~TangentFlow() = default;

TangentResult TangentFlow::run(const State& start, double duration) {
  const Eigen::Index size = 2 * implementation_->system.size() + implementation_->system.internal_size();
  return run(start, duration, Eigen::MatrixXd::Identity(size, size));
}

TangentResult TangentFlow::run(const State& start, double duration, const Eigen::MatrixXd& directions) {
  if (!(duration >= 0 && std::isfinite(duration))) throw InvalidInput("duration must be finite and not negative");
  const HybridSystem& system = implementation_->system;
  Prepared p = prepare(system, start, implementation_->options, false);
  const ModalModel& m = p.tables.model;
  CollocationFlow flow(system, p.tables.steps, std::move(p.start), p.options);
  Eigen::MatrixXd basis(2 * m.np, 2 * m.n);
  basis << m.from_q, m.from_v;
  flow.set_tangents(basis * directions);
  TangentResult out;
  const double end = start.time + duration;
  while (flow.point().time < end)
    if (advance_flow(flow, m, end)) out.events.insert(out.events.end(), flow.events().begin(), flow.events().end());
  out.end = physical(m, flow.point());
  out.monodromy.resize(2 * m.n, directions.cols());
  out.monodromy << m.to_q * flow.tangents(), m.to_v * flow.tangents();
  const Eigen::VectorXd rate = m.rate(flow.point().x, flow.point().force);
  out.rate.resize(2 * m.n);
  out.rate << m.to_q * rate, m.to_v * rate;
  return out;
}

TangentResult tangent_flow(const HybridSystem& system, const State& start, double duration,
                           const FlowOptions& options) {
  return TangentFlow(system, options).run(start, duration);
}

}  // namespace slipmode::dynamics
