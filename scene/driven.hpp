#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>

namespace slipmode::scene {

/// True for a scene with a shaker: the bases that are made of its motion are then those of its own words.
[[nodiscard]] bool is_shaken(const Scene& scene);
/// True for a scene whose drive has a period, a shaker's or a force's: sections, labels and sweeps are then those of
/// diagnostics/attractors/driven.hpp.
[[nodiscard]] bool is_driven(const Scene& scene);

/// The scene's full model with its one reading: the strain at the gauge of a beam, the first contact's displacement of
/// a chain.
[[nodiscard]] diagnostics::DrivenCase driven_case(const Scene& scene);
/// What that reading is: "strain at x = 0.05 m", "displacement of contact 1"; and its unit.
[[nodiscard]] std::string reading_name(const Scene& scene);
[[nodiscard]] std::string reading_unit(const Scene& scene);

/// The drive over its own key, see drive_key.
[[nodiscard]] diagnostics::DriveAt drive_over_own_key(const Scene& scene);

/// A start near the scene's own, for a second run that shows the sampling noise of statistics: the first member of an
/// ensemble of another seed, with the ensemble's spread, or 1e-4 where it has none.
[[nodiscard]] dynamics::State second_start(const Scene& scene, const dynamics::HybridSystem& system);

}  // namespace slipmode::scene
