#pragma once

#include "dynamics/internal/pair_form.hpp"

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace slipmode::dynamics {

/// A spring and a damper between a structure and the ground: force −(k + d ∂/∂t) wᵀη along w.
struct Support {
  Eigen::VectorXd w;  ///< in the structure's undamped modes [n]
  double stiffness = 0.0, damping = 0.0;
};

/// Pairs of a structure with modes of its own, η̈ + c η̇ + ω² η = 0, and supports: each adds a term of rank one, so its
/// eigenvalues are roots of a secular equation and its eigenvectors are known in closed form, left and right ones. No
/// decomposition of a matrix of order 2n, whose error grows with the ratio of the largest to the smallest eigenvalue
/// and whose cost with n³ (docs/theory/compliant-contacts.md, section 2).
///
/// @param omega    natural frequencies without supports [n]
/// @param damping  modal dampings c [n]
/// @return in the balanced state (ω η, η̇); none where a pair is not oscillatory, with or without supports, where two
///         modes that a support reaches have one eigenvalue, or where roots do not converge or do not solve the
///         equations of motion: then for `pair_form`
[[nodiscard]] std::optional<PairForm> sprung_pairs(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                                                   const std::vector<Support>& supports);

}  // namespace slipmode::dynamics
