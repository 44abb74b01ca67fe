#pragma once

#include <slipmode/orbits/balance/balance.hpp>

#include <Eigen/Core>

namespace slipmode::orbits {

struct HillOptions {
  /// With the impulses [λ] δy/|ẏ| at the switches at which a stop's force jumps. Without them multipliers are wrong, at
  /// any order: for comparison.
  bool jumps = true;
  int perturbation = 0;  ///< L: highest order of a perturbation; 0: the balance's
  /// Multipliers of −Φ(T/2) instead: of balances without even orders, in a system that is its own mirror image.
  bool half_period = false;
};

/// Share of the strip |Im α| ≤ Ω/2 within which exponents are taken as they are.
inline constexpr double kHillsBand = 0.9;

/// Floquet multipliers of a balance by Hill's method: perturbations δq = e^{αt} Σ φ_k e^{ikΩt} balance up to order L,
///
///     [M(α + ikΩ)² + C(α + ikΩ) + K] φ_k = Σ_c w_c Σ_j (s_{k−j} + (α + ijΩ) d_{k−j})_c w_cᵀ φ_j,
///
/// s, d the contacts' answers along the series, by exact integrals. Of the 2n(2L + 1) exponents the 2n with the least
/// imaginary part are taken, |Im α| ≤ Ω/2, where truncation is felt least; on the edge of that strip, where truncation
/// splits and doubles them, each pair that is no complex one's stands for one negative multiplier −e^{aT}. With L the
/// balance's order a multiplier passes 1 exactly where Newton's matrix is singular; by half periods, where that of the
/// odd orders is, and −1 where that of the even ones is.
/// @return  by modulus, descending [2n]
/// @throws InvalidInput      for a perturbation < 0; where a contact's force depends on the motion before (has_memory)
/// @throws NumericalFailure  when the eigenvalues are not found
/// Cost O((n L)³). Source: docs/theory/harmonic-balance.md, section 4.
[[nodiscard]] Eigen::VectorXcd hill_multipliers(const dynamics::HybridSystem& system, const Balance& balance,
                                                const HillOptions& options = {});

}  // namespace slipmode::orbits
