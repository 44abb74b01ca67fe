#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/fem/beam_modes.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/scene/scene.hpp>

#include <memory>
#include <vector>

namespace slipmode::studies {

/// Natural modes of a scene's full model, mass-normalised, by what its contacts do.
struct ModeSets {
  fem::Modes slipping;
  fem::Modes sticking;                    ///< every contact held whose law can; empty when nothing is left to move
  fem::Modes compliant;                   ///< every contact held by its spring or stop; empty unless each has one
  std::vector<fem::TheoryEffect> theory;  ///< of a beam
};

/// @param count  modes of each set at most; 0: the lowest 20
/// @throws InvalidInput  for more than there are degrees of freedom
[[nodiscard]] ModeSets natural_modes(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                     Eigen::Index count = 0);

/// The modes with every contact held that sticks or has bristles, stops open; empty without such, or with nothing left
/// to move.
[[nodiscard]] fem::Modes sticking_modes(const dynamics::HybridSystem& system, Eigen::Index count);

/// What is kept of it: circular frequencies and shapes.
[[nodiscard]] results::Content content_of(const scene::Scene& scene, std::shared_ptr<const ModeSets> sets);

}  // namespace slipmode::studies
