#include "diagnostics/validation/internal/validation_checks.hpp"

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace slipmode::diagnostics {

std::vector<Eigen::Index> modes_to_try(const pod::NamedBasis& candidate, const ValidationOptions& options) {
  if (!options.modes.empty()) return options.modes;
  std::vector<Eigen::Index> all(static_cast<std::size_t>(candidate.basis.modes()));
  std::iota(all.begin(), all.end(), 1);
  return all;
}

void check_validation(const dynamics::HybridSystem& full, const std::vector<pod::NamedBasis>& candidates,
                      const ValidationOptions& options) {
  if (candidates.empty()) throw InvalidInput("validation: expected at least one basis, found none");
  if (options.horizon_starts < 1 || !(options.horizon_gap > 0.0) || !(options.horizon > 0.0) ||
      !(options.sample > 0.0)) {
    throw InvalidInput(
        fmt::format("validation: expected horizon, its sample and gap > 0 and at least one start, found "
                    "{}, {}, {}, {}",
                    options.horizon, options.sample, options.horizon_gap, options.horizon_starts));
  }
  if (options.orbit_starts < 1) {
    throw InvalidInput(
        fmt::format("validation: expected at least one start for orbits, found {}", options.orbit_starts));
  }
  for (const pod::NamedBasis& candidate : candidates) {
    const Eigen::Index available = std::min(candidate.basis.modes(), candidate.captured.size());
    if (candidate.basis.vectors.rows() != full.size()) {
      throw InvalidInput(fmt::format("validation: expected basis {} to have {} rows, found {}", candidate.name,
                                     full.size(), candidate.basis.vectors.rows()));
    }
    for (const Eigen::Index L : modes_to_try(candidate, options)) {
      if (L >= 1 && L <= available) continue;
      throw InvalidInput(
          fmt::format("validation: expected between 1 and {} modes of {} (vectors and energy shares "
                      "given), found {}",
                      available, candidate.name, L));
    }
  }
}

}  // namespace slipmode::diagnostics
