#pragma once

#include <slipmode/pod/pod.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/results/store.hpp>

#include <Eigen/Core>
#include <optional>

namespace slipmode::results {

inline constexpr const char* kPomfGroup = "pomf";

/// What an ensemble of a shaken structure gives: POMs of all degrees of freedom in the mass metric and, where the scene
/// has sensors, modal functions from their readings.
struct ShakenModes {
  pod::PodResult mass_pom;
  std::optional<pod::PomfResult> pomf;
  Eigen::MatrixXd pomf_shares;  ///< of LNM 1, 2, … in each POMF; as many LNMs as sensors
  Eigen::MatrixXd mass_shares;  ///< of the same LNMs in each of the first mass POMs
};

/// Writes the groups `pod` (mass POMs) and `pomf`.
void save(StoreWriter& writer, const ShakenModes& modes);

/// What a file with the group `pod` holds of them: bases, without shares of LNMs.
/// @param n  degrees of freedom expected
[[nodiscard]] ShakenModes load_shaken_modes(const StoreReader& store, Eigen::Index n);

}  // namespace slipmode::results
