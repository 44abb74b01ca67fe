#include <slipmode/orbits/branches/balance_branch.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include "orbits/balance/internal/balance_orbit.hpp"
#include "orbits/branches/internal/balance_branch_solver.hpp"
#include "orbits/branches/internal/branch_walk.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>

namespace slipmode::orbits {

Branch continue_balance(const dynamics::SystemFamily& family, const Balance& balance, double parameter,
                        const ContinuationOptions& options) {
  check_continuation(parameter, options);
  if (!balance.converged || balance.samples != kExact)
    throw InvalidInput("continuation of a balance starts from one that converged, with exact forces (samples = 0)");
  const PeriodicOrbit first = in_terms_of_an_orbit(family(parameter), balance, options.shooting.marginal_band,
                                                   options.shooting.symmetry_tolerance);
  return walk_branch(BalanceBranchSolver(family, balance, parameter, options, first.symmetric), options,
                     {.parameter = parameter, .orbit = first, .balance = balance});
}

BranchCertificate certify_branch(const dynamics::SystemFamily& family, Branch& out_branch, int every,
                                 const ShootingOptions& shooting) {
  if (every < 1) throw InvalidInput(fmt::format("every: {}; valid: 1 or more", every));
  BranchCertificate out;
  const std::size_t count = out_branch.points.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (k % static_cast<std::size_t>(every) != 0 && k + 1 != count) continue;
    BranchPoint& point = out_branch.points[k];
    Certificate certificate;
    try {
      certificate = certify(family(point.parameter), *point.balance, shooting);
    } catch (const Interrupted&) {
      out_branch.end = BranchEnd::kInterrupted;
      out_branch.reason = fmt::format("interrupted as its points were certified, beyond {} of {}", k, count);
      return out;
    }
    ++out.certified;
    point.true_error = certificate.behind ? certificate.error.front() : std::numeric_limits<double>::infinity();
    if (!certificate.behind) continue;
    ++out.behind;
    out.worst = std::max(out.worst, certificate.relative);
  }
  return out;
}

}  // namespace slipmode::orbits
