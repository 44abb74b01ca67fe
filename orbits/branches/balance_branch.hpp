#pragma once

#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>

namespace slipmode::orbits {

/// Follows a balance over a parameter: `continue_orbit` for truncated series, with the same steps, folds and special
/// points. Every point has its `balance`, and an `orbit` that says of the series what it says of an orbit: a state at
/// time 0, the word of its switches, multipliers by Hill's method; it closes as a series only.
///
/// Unknowns are the contacts' coefficients and the parameter, by exact forces; a symmetric balance keeps to its odd
/// orders. The equations are smooth in the parameter: what its derivative costs is three evaluations.
/// @param balance  at `parameter`, converged, of exact forces
/// @param options  of `shooting` the tolerance (on Balance::residual) and the bands of symmetry and margin
/// @throws InvalidInput  for a balance that is not converged or of samples; and as continue_orbit
[[nodiscard]] Branch continue_balance(const dynamics::SystemFamily& family, const Balance& balance, double parameter,
                                      const ContinuationOptions& options);

/// How a branch of balances stands to the exact orbits behind it.
struct BranchCertificate {
  int certified = 0;   ///< points that were looked at
  int behind = 0;      ///< of them, those with an orbit behind
  double worst = 0.0;  ///< largest Certificate::relative of these
};

/// Shoots from every k-th point of a branch, and from its last one, and fills in `BranchPoint::true_error`. Where the
/// family is stopped, the branch ends as interrupted and its other points stay unseen.
/// @param every  k ≥ 1
[[nodiscard]] BranchCertificate certify_branch(const dynamics::SystemFamily& family, Branch& out_branch, int every,
                                               const ShootingOptions& shooting = {});

}  // namespace slipmode::orbits
