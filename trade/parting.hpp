#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/case.hpp>
#include <slipmode/trade/schedule.hpp>

namespace slipmode::trade {

/// How far two runs of a model part up to the horizon when their starts are a millionth apart: dX of the reading, root
/// mean square over eight starts along its motion [%]. Exponents do not tell it where the flow jumps: a contact that
/// just sticks, or just does not.
/// @param settled  a state of the motion; under a shaker or a force its time sets the phase
/// @throws NumericalFailure  as dynamics::simulate
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] double parting(const Case& model, const dynamics::State& settled, const Schedule& schedule,
                             const StopFlag* stop = nullptr);

}  // namespace slipmode::trade
