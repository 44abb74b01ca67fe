#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/provenance.hpp>
#include "cli/session.hpp"

#include <filesystem>

namespace slipmode::cli {

/// The scene's system as a model whose parameter is the belt speed, or the shaker's frequency. A belt that is not
/// constant keeps its own speed.
[[nodiscard]] diagnostics::Model scene_model(const scene::Scene& scene, const dynamics::HybridSystem& system);

/// Verbs that compare motions by their slips, or at upward zeros of a shaker, have nothing to go by under a force.
/// @throws InvalidInput  for a scene with a force, naming what to use
void refuse_force(const scene::Scene& scene, const std::string& verb);

/// True when every contact is a frictional one: with clearances there are no sticking modes.
[[nodiscard]] bool can_stick(const dynamics::HybridSystem& system);

/// Runs what [ensemble] asks for: `members` starts (the scene's initial state plus `spread` times standard normal
/// numbers in every displacement and velocity) at each of its belt speeds or shaker frequencies; see
/// scene::ensemble_states.
/// @throws as diagnostics::run_ensemble
[[nodiscard]] diagnostics::EnsembleRun run_scene_ensemble(const Session& session, const scene::Scene& scene,
                                                          const dynamics::HybridSystem& system);

/// Writes groups `ensemble`, `members`, `provenance` and, where the scene has sensors, `sensors`.
void store_ensemble(const std::filesystem::path& path, const scene::Scene& scene, const diagnostics::EnsembleRun& run);

/// Largest energy residual of the members that went well.
[[nodiscard]] double worst_audit(const diagnostics::EnsembleRun& run);

/// Reads what a POD can be made of: an ensemble, or the samples of one trajectory.
/// @throws InvalidInput  when the file holds neither
[[nodiscard]] pod::Ensemble load_snapshots(const results::StoreReader& store);

/// The number of modes a choice asks for, given the energy shares of all modes.
/// @param source  what the modes come from, for the message
/// @throws InvalidInput  when more modes are asked than there are
[[nodiscard]] Eigen::Index chosen_modes(const pod::ModeChoice& choice, const Eigen::VectorXd& shares,
                                        Eigen::Index available, const std::string& source);

/// Cumulative shares.
[[nodiscard]] Eigen::VectorXd cumulative(const Eigen::VectorXd& shares);

/// A basis from the scene's point of view: POMs read from a file, or the structure's LNMs for the word "lnm".
struct BasisSource {
  pod::Basis basis;
  Eigen::VectorXd shares;  ///< energy share of each vector; empty for LNMs and user bases without energies
};
/// @param source  "lnm", or a result file with a POD, a basis or a reduced model
/// @throws InvalidInput  when the file holds no basis, or one for another number of degrees of freedom
[[nodiscard]] BasisSource load_basis_source(const std::string& source, const fem::Structure& structure);

}  // namespace slipmode::cli
