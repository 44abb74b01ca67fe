#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/event_resolver.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <utility>

namespace slipmode::dynamics {

/// The flow that serves a system: as asked, or the cheaper one of those that can.
/// @throws InvalidInput  when the one asked for cannot, or none can, naming the contact
[[nodiscard]] FlowMethod choose_method(const HybridSystem& system, FlowMethod asked);
/// The same options, of that method.
[[nodiscard]] FlowOptions with_method(const HybridSystem& system, FlowOptions asked);

/// The modal model a run needs, and its state there.
struct Prepared {
  const ModelTables& tables;
  HybridPoint start;
  FlowOptions options;
};

/// @param options  see with_method() @param rows_suffice  no mode shapes are asked for
/// @throws InvalidInput  for sizes, values that are not finite, modes the state contradicts
[[nodiscard]] Prepared prepare(const HybridSystem& system, const State& start, FlowOptions options, bool rows_suffice);

/// The state in the structure's own degrees of freedom; q and v empty without mode shapes.
[[nodiscard]] State physical(const ModalModel& model, const HybridPoint& point);

/// The same where a run ends, to go on from: rigid contacts that stick, or whose mode and sliding speed disagree in
/// sign, are put on the belt's speed exactly (smallest change of v). A run holds that speed to its tolerance only, and
/// a start must be consistent with its modes to rounding. Contacts behind a spring stick at any speed.
[[nodiscard]] State end_state(const HybridSystem& system, const ModalModel& model, const HybridPoint& point);

/// One step of a flow; a failure is reported with the state in the structure's own degrees of freedom, (q, q̇).
template <class AnyFlow>
bool advance_flow(AnyFlow& flow, const ModalModel& m, double end) {
  try {
    return flow.step(end);
  } catch (const NumericalFailure& failure) {
    Eigen::VectorXd state;
    if (m.has_shapes() && failure.state.size() == 2 * m.np) {
      state.resize(2 * m.n);
      state << m.to_q * failure.state, m.to_v * failure.state;
    }
    throw NumericalFailure(failure.what(), failure.time, std::move(state), failure.residual);
  }
}

}  // namespace slipmode::dynamics
