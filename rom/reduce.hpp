#pragma once

#include "dynamics/system.hpp"
#include "pod/basis.hpp"

namespace slipmode::rom {

/// Linear natural modes of the slipping structure as a basis (mean zero), mass-orthonormal, ascending frequency.
/// @param count  1..n
/// @throws InvalidInput  if count is out of range
[[nodiscard]] pod::Basis lnm_basis(const fem::Structure& structure, Eigen::Index count);

/// A basis from columns a user supplies.
/// @param vectors  n x L, 1 ≤ L ≤ n
/// @param mean     q̄ [n], or empty for zero
/// @throws InvalidInput for wrong size, values not finite, columns dependent to 1e-7 (see reduce)
[[nodiscard]] pod::Basis user_basis(Eigen::MatrixXd vectors, Eigen::VectorXd mean = {});

/// Galerkin projection q = q̄ + Φ a: ΦᵀMΦ, ΦᵀCΦ, ΦᵀKΦ, Φᵀw, load Φᵀ(p − K q̄), contact offsets wᵀq̄ + old offset.
///
/// The reduced model is again a HybridSystem, so everything that works on a full model works on it, this function
/// included. Symmetry and definiteness survive, so projection alone cannot make it unstable; Rayleigh damping stays
/// Rayleigh damping with the same coefficients. With all modes it is the full model. Dofs are named "a1".."aL".
/// @throws InvalidInput  basis of wrong size or values not finite; columns whose smallest singular value, after scaling
///                       each to unit length, is below 1e-7 of the largest (the projected mass matrix squares that
///                       ratio); a contact the basis cannot see, or several it cannot tell apart (to 1e-10)
/// Cost O(n L²) for sparse matrices. Source: S4 (3.27)-(3.29) in second-order form; docs/theory/pod-and-reduction.md.
[[nodiscard]] dynamics::HybridSystem reduce(const dynamics::HybridSystem& full, const pod::Basis& basis);

/// Full state of a reduced one: q = q̄ + Φ a, q̇ = Φ ȧ. Contact velocities are those of the reduced model, so contact
/// modes are kept. Energies differ by a constant: E(lift(s)) = E_reduced(s) + ½ q̄ᵀK q̄ − pᵀq̄.
/// @throws InvalidInput  for sizes that do not fit
[[nodiscard]] dynamics::State lift(const pod::Basis& basis, const dynamics::State& reduced);

/// The reduced state nearest to a full one in the mass metric: a = (ΦᵀMΦ)⁻¹ΦᵀM(q − q̄), and the same for velocities.
/// Contact modes are kept when the velocity lies in the basis to rounding; otherwise the contact velocities change and
/// the modes are left empty, to be found by consistency when the flow starts.
/// @throws InvalidInput  for sizes that do not fit, dependent columns
[[nodiscard]] dynamics::State restrict_state(const fem::Structure& structure, const pod::Basis& basis,
                                             const dynamics::State& full);

}  // namespace slipmode::rom
