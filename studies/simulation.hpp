#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/run_options.hpp>

#include <memory>
#include <optional>
#include <string>

namespace slipmode::studies {

/// One run of a model, from [initial] as [time] says.
struct Simulation {
  dynamics::Trajectory trajectory;          ///< of a reduced model lifted, to all degrees of freedom
  std::optional<NumericalFailure> failure;  ///< set: the trajectory ends before it
};

/// @throws NumericalFailure  when the run failed before there was anything to keep
/// @throws Interrupted       when the stop flag was set; polled at every event
[[nodiscard]] Simulation simulate(const Family& model, const RunOptions& run = {});

/// What is kept of it: the trajectory, what the scene's sensors read, why it ended early. Shares its samples.
/// @param model_word  the model as the executable is given it
[[nodiscard]] results::Content content_of(const scene::Scene& scene, std::shared_ptr<const Simulation> simulation,
                                          const std::string& model_word);

}  // namespace slipmode::studies
