#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>

namespace slipmode::scene {

/// True for a scene with a shaker: sections, labels and sweeps are then those of diagnostics/driven.hpp.
[[nodiscard]] bool is_shaken(const Scene& scene);

/// The scene's full model with its one reading: the strain at the gauge of a beam, the first contact's displacement of
/// a chain.
[[nodiscard]] diagnostics::DrivenCase shaken_case(const Scene& scene);
/// What that reading is: "strain at x = 0.05 m", "displacement of contact 1"; and its unit.
[[nodiscard]] std::string reading_name(const Scene& scene);
[[nodiscard]] std::string reading_unit(const Scene& scene);

/// The drive over frequency, with the amplitude that the scene's curve has there.
[[nodiscard]] diagnostics::DriveAt drive_over_frequency(const Scene& scene);

/// A start near the scene's own, for a second run that shows the sampling noise of statistics: the first member of an
/// ensemble of another seed, with the ensemble's spread, or 1e-4 where it has none.
[[nodiscard]] dynamics::State second_start(const Scene& scene, const dynamics::HybridSystem& system);

}  // namespace slipmode::scene
