#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <memory>
#include <optional>

namespace slipmode::studies {

/// One run of a scene's full model, from [initial] as [time] says.
struct Simulation {
  dynamics::Trajectory trajectory;
  std::optional<NumericalFailure> failure;  ///< set: the trajectory ends before it
};

/// @throws NumericalFailure  when the run failed before there was anything to keep
/// @throws Interrupted       when the stop flag was set; polled at every event
[[nodiscard]] Simulation simulate(const scene::Scene& scene, const RunOptions& run = {});

/// What is kept of it: the trajectory, what the scene's sensors read, why it ended early. Shares its samples.
[[nodiscard]] results::Content content_of(const scene::Scene& scene, std::shared_ptr<const Simulation> simulation);

}  // namespace slipmode::studies
