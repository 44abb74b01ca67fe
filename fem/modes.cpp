#include <slipmode/fem/modes.hpp>

#include <slipmode/core/errors.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/mode_conventions.hpp"

#include <fmt/format.h>

namespace slipmode::fem {

namespace {

// Below this size the dense solver is as fast as any, and its modes are the most nearly orthogonal.
constexpr Eigen::Index kSmall = 64;

EigenMethod choose(const Structure& structure, Eigen::Index count) {
  const Eigen::Index n = structure.size();
  if (n <= kSmall) return EigenMethod::kDense;
  if (structure.is_chain_like()) return EigenMethod::kTridiagonal;
  if (n < detail::kDenseLimit || 5 * count >= n) return EigenMethod::kDense;
  return EigenMethod::kSpectra;
}

void check_method(const Structure& structure, Eigen::Index count, EigenMethod method) {
  if (method == EigenMethod::kTridiagonal && !structure.is_chain_like()) {
    throw InvalidInput(
        "natural modes: the tridiagonal method needs a diagonal M and a tridiagonal K; use the dense method or "
        "Spectra");
  }
  if (method == EigenMethod::kSpectra && count >= structure.size()) {
    throw InvalidInput(
        fmt::format("natural modes: Lanczos finds at most {} of {} modes, {} were asked; use the dense "
                    "method for all",
                    structure.size() - 1, structure.size(), count));
  }
}

detail::EigenPairs solve(const Structure& structure, Eigen::Index count, EigenMethod method) {
  switch (method) {
    case EigenMethod::kTridiagonal:
      return detail::solve_tridiagonal(structure, count);
    case EigenMethod::kSpectra:
      return detail::solve_spectra(structure, detail::no_holds(structure.size()), count);
    default:
      break;
  }
  detail::EigenPairs all = detail::solve_dense(structure);
  return {all.values.head(count), all.vectors.leftCols(count)};
}

}  // namespace

Modes natural_modes(const Structure& structure, Eigen::Index count, EigenMethod method) {
  const Eigen::Index n = structure.size();
  if (count < 0 || count > n) {
    throw InvalidInput(fmt::format("natural modes: {} modes asked; expected 0 (all) to {}", count, n));
  }
  const Eigen::Index wanted = count == 0 ? n : count;
  const EigenMethod chosen = method == EigenMethod::kAutomatic ? choose(structure, wanted) : method;
  check_method(structure, wanted, chosen);
  return detail::conventional_modes(structure, solve(structure, wanted, chosen));
}

}  // namespace slipmode::fem
