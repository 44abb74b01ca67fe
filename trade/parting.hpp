#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/case.hpp>
#include <slipmode/trade/schedule.hpp>

namespace slipmode::trade {

struct Parting {
  double apart = 0.0;  ///< dX of the reading up to the horizon, of two runs whose starts are a millionth apart [%]
  double reach = 0.0;  ///< root mean square of the reading about its mean, in its own unit; 0 where nothing moves
};

/// How far two runs of a model part, over some starts along its motion. Exponents do not tell it where the flow jumps:
/// a contact that just sticks, or just does not.
/// @param from    a state of the motion; under a shaker or a force its time sets the phase
/// @param starts  ≥ 1, the first being `from`
/// @throws NumericalFailure  as dynamics::simulate
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] Parting parting(const Case& model, const dynamics::State& from, int starts, const Schedule& schedule,
                              const StopFlag* stop = nullptr);

/// @throws InvalidInput  where nothing moves, neither from the scene's start on nor later: there is nothing to compare
void require_motion(const Parting& from_start, const Parting& later);

}  // namespace slipmode::trade
