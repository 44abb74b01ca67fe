#include <slipmode/scene/solver_options.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::scene {

dynamics::FlowOptions uncertified(dynamics::FlowOptions flow) {
  flow.certify = false;
  return flow;
}

diagnostics::SettleOptions settle_options(const Scene& scene) {
  const auto& spec = scene.validation;
  return {.transient = spec.transient,
          .block = spec.block,
          .limit = spec.limit,
          .period = {.tolerance = spec.period_tolerance, .max_period = spec.max_period},
          .flow = uncertified(scene.flow)};
}

diagnostics::SettleOptions sweep_settle_options(const Scene& scene) {
  diagnostics::SettleOptions options = settle_options(scene);
  options.limit = scene.validation.sweep_limit;
  options.block = std::min(options.block, options.limit);
  options.patience = 1.0;
  options.flow.audit = false;
  return options;
}

diagnostics::DrivenOptions driven_options(const Scene& scene) {
  return {.cycles = scene.driven.cycles,
          .kept = scene.driven.kept,
          .tolerance = scene.driven.period_tolerance,
          .max_period = scene.driven.max_period,
          .flow = uncertified(scene.flow)};
}

diagnostics::ModelVerdictOptions verdict_options(const Scene& scene) {
  constexpr double kShareOfDuration = 0.2, kIntervalsOfExponents = 1000.0;
  constexpr double kLeastRecord = 2000.0, kLargestRecord = 20000.0;
  diagnostics::ModelVerdictOptions options{.sample = scene.time.sample};
  const double samples = std::clamp(scene.time.duration / scene.time.sample, kLeastRecord, kLargestRecord);
  options.samples = static_cast<Eigen::Index>(samples);
  options.tangent.transient = scene.validation.transient;
  options.tangent.duration = kShareOfDuration * scene.validation.lyapunov_duration;
  options.tangent.interval = options.tangent.duration / kIntervalsOfExponents;
  options.tangent.seed = scene.ensemble.seed;
  options.tangent.flow = uncertified(scene.flow);
  return options;
}

}  // namespace slipmode::scene
