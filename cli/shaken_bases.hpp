#pragma once

#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/results/store.hpp>
#include "cli/session.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

inline constexpr const char* kPomfGroup = "pomf";

/// What an ensemble of a shaken structure gives: POMs of all degrees of freedom in the mass metric and, where the scene
/// has sensors, modal functions from their readings.
struct ShakenModes {
  pod::PodResult mass_pom;
  std::optional<pod::PomfResult> pomf;
  Eigen::MatrixXd pomf_shares;  ///< of LNM 1, 2, … in each POMF; as many LNMs as sensors
  Eigen::MatrixXd mass_shares;  ///< of the same LNMs in each of the first mass POMs
};

/// Readings of the scene's sensors, with their noise [ns x T]. @throws InvalidInput  for a scene without sensors
[[nodiscard]] Eigen::MatrixXd sensor_readings(const scene::Scene& scene, const fem::Beam& beam,
                                              const Eigen::MatrixXd& q);
/// Writes the group `sensors`: their places and readings of these displacements.
void store_sensors(results::StoreWriter& writer, const scene::Scene& scene, const Eigen::MatrixXd& q);

/// Sensors → displacements → POMs → modal functions → POMFs, as [sensors] and [reduction] say, and mass POMs.
/// @param snapshots  all degrees of freedom
[[nodiscard]] ShakenModes shaken_modes(const scene::Scene& scene, const fem::Structure& structure,
                                       const pod::Ensemble& snapshots);

/// Writes the groups `pod` (mass POMs) and `pomf`.
void save(results::StoreWriter& writer, const ShakenModes& modes);

/// Tables of energies and of LNMs' shares (the form of S4 Tables 5.1 and 5.2), and the same as JSON.
[[nodiscard]] std::string text_of(const ShakenModes& modes);
[[nodiscard]] Json json_of(const ShakenModes& modes);

/// The basis that a word of the scene means, with all vectors that can be used.
/// @param ensemble  bases from motion need one: called when such a word comes
/// @throws InvalidInput  for "pomf" without sensors, or "pom" on a beam
[[nodiscard]] pod::Basis shaken_basis(scene::BasisChoice word, const scene::Scene& scene,
                                      const dynamics::HybridSystem& system,
                                      const std::function<const ShakenModes&()>& ensemble);

/// One candidate for each of validation.bases.
[[nodiscard]] std::vector<diagnostics::DrivenCandidate> shaken_candidates(
    const scene::Scene& scene, const dynamics::HybridSystem& system,
    const std::function<const ShakenModes&()>& ensemble);

/// What a result file gives to be judged or projected on: the one basis of a reduced model; the bases of a POD; or the
/// modes of an ensemble or trajectory.
[[nodiscard]] std::vector<diagnostics::DrivenCandidate> load_shaken_candidates(const scene::Scene& scene,
                                                                               const dynamics::HybridSystem& system,
                                                                               const std::string& file);

}  // namespace slipmode::cli
