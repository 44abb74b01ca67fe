#pragma once

#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>

namespace slipmode::rom {

/// Linear natural modes of the slipping structure as a basis (mean zero), mass-orthonormal, ascending frequency.
/// @param count  1..n
/// @throws InvalidInput  if count is out of range
[[nodiscard]] pod::Basis lnm_basis(const fem::Structure& structure, Eigen::Index count);

/// Natural modes with the classic remedy for their slow convergence at a concentrated force: one static mode K⁻¹w_c per
/// contact (attachment modes; the reduced model's response to constant contact forces is then exact).
///
/// Vectors, mass-orthonormal by Gram-Schmidt in this order: K⁻¹w_1 … K⁻¹w_m, φ_1 … φ_count. So the first L of them span
/// the m static modes and the first L − m natural modes for every L ≥ m: truncated() is what one expects. The span is
/// that of `count` natural modes and the residual attachment modes Σ_{k>count} φ_k φ_kᵀw/ω_k².
/// @param directions  w_c as columns [n x m], m ≥ 1
/// @param count       natural modes, 0 to n − m
/// @throws InvalidInput  for sizes that do not fit, a count out of range, a singular K (rigid-body modes: a constant
///                       force has no static response), or directions whose static modes depend on each other or on the
///                       natural modes
/// Source: Craig, Int. J. Analytical and Experimental Modal Analysis 10 (1995) 59; docs/theory/modal-functions.md.
[[nodiscard]] pod::Basis lnm_static_basis(const fem::Structure& structure, const Eigen::MatrixXd& directions,
                                          Eigen::Index count);

/// The same for the directions of the system's contacts. @throws InvalidInput  also for a system without contacts
[[nodiscard]] pod::Basis lnm_static_basis(const dynamics::HybridSystem& system, Eigen::Index count);

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

/// Full state of a reduced one: q = q̄ + Φ a, q̇ = Φ ȧ. Contact displacements and velocities are those of the reduced
/// model, so contact modes and contacts' own states are kept. Energies differ by a constant: E(lift(s)) = E_reduced(s)
/// + ½ q̄ᵀK q̄ − pᵀq̄.
/// @throws InvalidInput  for sizes that do not fit
[[nodiscard]] dynamics::State lift(const pod::Basis& basis, const dynamics::State& reduced);

/// The reduced state nearest to a full one in the mass metric: a = (ΦᵀMΦ)⁻¹ΦᵀM(q − q̄), and the same for velocities.
/// Contact modes are kept when the velocity lies in the basis to rounding; otherwise the contact velocities change and
/// the modes are left empty, to be found by consistency when the flow starts. Contacts' own states (stretch, bristle,
/// normal oscillator) are kept as they are.
/// @throws InvalidInput  for sizes that do not fit, dependent columns
[[nodiscard]] dynamics::State restrict_state(const fem::Structure& structure, const pod::Basis& basis,
                                             const dynamics::State& full);

}  // namespace slipmode::rom
