#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/dynamics/system_family.hpp>
#include <slipmode/pod/basis.hpp>

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace slipmode::diagnostics {

/// A model under study: full, or reduced by a basis.
struct Model {
  dynamics::SystemFamily system;
  std::optional<pod::Basis> basis = {};  ///< set for a reduced model: how its states lift to the full ones
  /// Added to HybridSystem::energy so that a reduced model's energy is that of its lifted state [J]; it moves with the
  /// stiffness and the load. Empty: zero.
  std::function<double(double parameter)> energy_offset = {};
};

/// The full model with belt speed as the parameter; modal data are shared by all speeds.
[[nodiscard]] Model belt_model(const dynamics::HybridSystem& full);

/// ½ q̄ᵀK q̄ − pᵀq̄: what projection on an affine basis leaves out of the energy [J].
[[nodiscard]] double projection_energy(const dynamics::HybridSystem& full, const pod::Basis& basis);

/// The model reduced to `basis`, belt speed as the parameter; energy_offset is projection_energy.
/// @throws InvalidInput  as rom::reduce
[[nodiscard]] Model reduced_belt_model(const dynamics::HybridSystem& full, const pod::Basis& basis);

/// Model::energy_offset at a value, zero where there is none [J].
[[nodiscard]] double energy_offset_at(const Model& model, double parameter);

/// A state in full coordinates: lifted for a reduced model, unchanged for a full one.
[[nodiscard]] dynamics::State lifted(const Model& model, const dynamics::State& state);

/// Mean of HybridSystem::energy over samples, one column per instant [J].
/// @param q, v  n x T, T ≥ 1
[[nodiscard]] double mean_energy(const dynamics::HybridSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& q,
                                 const Eigen::Ref<const Eigen::MatrixXd>& v);

/// Steady sliding at the drive's speed at time 0: K q = p + Σ w λ with λ at its kinetic value for that speed (zero for
/// a belt at rest), v = 0. A static equilibrium that need not be stable.
/// @throws InvalidInput  if K is singular to rounding (a structure free to move as a rigid body)
[[nodiscard]] dynamics::State sliding_equilibrium(const dynamics::HybridSystem& system);

/// Where a belt holds the structure on average: the displacement of sliding_equilibrium; zero under another drive and
/// where there is none.
[[nodiscard]] Eigen::VectorXd resting_place(const dynamics::HybridSystem& system);
/// The first L natural modes, which know of no mean, about that place. @throws InvalidInput  as rom::lnm_basis
[[nodiscard]] pod::Basis lnms_at_rest(const dynamics::HybridSystem& system, Eigen::Index L);

}  // namespace slipmode::diagnostics
