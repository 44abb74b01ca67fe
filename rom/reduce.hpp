#pragma once

#include "dynamics/system.hpp"
#include "pod/basis.hpp"

namespace slipmode::rom {

/// Linear natural modes of the slipping structure as a basis (mean zero).
[[nodiscard]] pod::Basis lnm_basis(const fem::Structure& structure, Eigen::Index count);

/// A basis from columns a user supplies. @throws InvalidInput for wrong size, values not finite, dependent columns
[[nodiscard]] pod::Basis user_basis(Eigen::MatrixXd vectors, Eigen::VectorXd mean = {});

/// Galerkin projection q = q̄ + Φ a: ΦᵀMΦ, ΦᵀCΦ, ΦᵀKΦ, Φᵀw, load Φᵀ(p − K q̄), contact offsets wᵀq̄.
///
/// The reduced model is again a HybridSystem, so everything that works on a full model works on it. Symmetry and
/// definiteness survive, so projection alone cannot make it unstable. With all modes it is the full model.
/// @throws InvalidInput  basis of wrong size or rank, or one in which a contact is invisible (Φᵀw = 0)
/// Source: S4 (3.27)-(3.29) in second-order form.
[[nodiscard]] dynamics::HybridSystem reduce(const dynamics::HybridSystem& full, const pod::Basis& basis);

/// Full state of a reduced one: q = q̄ + Φ a, q̇ = Φ ȧ.
[[nodiscard]] dynamics::State lift(const pod::Basis& basis, const dynamics::State& reduced);

/// The reduced state nearest to a full one in the mass metric: a = (ΦᵀMΦ)⁻¹ΦᵀM(q − q̄).
[[nodiscard]] dynamics::State restrict_state(const fem::Structure& structure, const pod::Basis& basis,
                                             const dynamics::State& full);

}  // namespace slipmode::rom
