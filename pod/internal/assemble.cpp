#include "pod/internal/assemble.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/signs.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::pod {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

double rank_threshold(const Decomposition& d, const PodOptions& options) {
  if (options.rank_tolerance > 0.0) return options.rank_tolerance * d.sigma[0];
  const double offset = d.mean.cwiseAbs().maxCoeff() * std::sqrt(static_cast<double>(d.snapshots));
  return std::max(d.relative_error * d.sigma[0], 4.0 * kEpsilon * offset);
}

Eigen::Index choose(const PodResult& result, const ModeChoice& choice, const Decomposition& d) {
  if (choice.modes > result.rank) {
    throw InvalidInput(fmt::format(
        "POD: {} modes asked, but {} snapshots of {} degrees of freedom have rank {} (largest singular value {:.3g}, "
        "number {}: {:.3g}). Ask for at most {}, or add snapshots or runs",
        choice.modes, d.snapshots, d.mean.size(), result.rank, d.sigma[0], result.rank + 1,
        result.rank < d.sigma.size() ? d.sigma[result.rank] : 0.0, result.rank));
  }
  if (choice.modes > 0) return choice.modes;
  if (choice.energy == 1.0) return result.rank;
  return std::min(modes_for_energy(result.shares, choice.energy), result.rank);
}

void check_orthonormal(const Eigen::MatrixXd& vectors) {
  const Eigen::Index k = vectors.cols();
  const double error = (vectors.transpose() * vectors - Eigen::MatrixXd::Identity(k, k)).cwiseAbs().maxCoeff();
  if (!(error <= 1e-10)) {
    throw NumericalFailure(
        fmt::format("POD: modes are orthonormal to {:.3g} only; expected 1e-10. Use the QR method", error), kNone, {},
        error);
  }
}

}  // namespace

void validate(const PodOptions& options, Eigen::Index dofs) {
  const ModeChoice& choice = options.choice;
  if (choice.modes < 0 || choice.modes > dofs) {
    throw InvalidInput(
        fmt::format("POD: {} modes asked of {} degrees of freedom; expected 1 to {}, or 0 to choose by "
                    "energy share",
                    choice.modes, dofs, dofs));
  }
  if (!(choice.energy > 0.0 && choice.energy <= 1.0)) {
    throw InvalidInput(fmt::format("POD: energy share {} asked; expected a number in (0, 1]", choice.energy));
  }
  if (!(options.rank_tolerance >= 0.0 && options.rank_tolerance < 1.0)) {
    throw InvalidInput(
        fmt::format("POD: rank tolerance {}; expected a number in [0, 1), 0 for automatic", options.rank_tolerance));
  }
}

bool is_constant(double total, const Eigen::VectorXd& mean, Eigen::Index snapshots) {
  return std::sqrt(total) <= 4.0 * kEpsilon * std::sqrt(static_cast<double>(snapshots)) * mean.norm();
}

void fail_constant(Eigen::Index snapshots, double total, bool mean_removed) {
  throw InvalidInput(
      fmt::format("POD: the {} snapshots are {} to rounding (sum of squares {:.3g}); there is nothing to decompose. "
                  "Sample a motion "
                  "that has not come to rest",
                  snapshots, mean_removed ? "constant" : "zero", total));
}

Eigen::Index modes_for_energy(const Eigen::VectorXd& shares, double energy) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    sum += shares[i];
    if (sum >= energy) return i + 1;
  }
  return shares.size() + 1;
}

PodResult assemble(const Decomposition& d, const PodOptions& options) {
  if (!std::isfinite(d.total)) {
    throw InvalidInput("POD: the sum of squares of the snapshots overflows; change the unit of length");
  }
  if (is_constant(d.total, d.mean, d.snapshots)) fail_constant(d.snapshots, d.total, options.remove_mean);

  PodResult result;
  const double threshold = rank_threshold(d, options);
  result.rank = (d.sigma.array() > threshold).count();
  if (result.rank == 0) fail_constant(d.snapshots, d.total, options.remove_mean);
  result.singular_values = d.sigma / std::sqrt(static_cast<double>(d.snapshots));
  result.shares = d.sigma.array().square() / d.total;
  result.mean_square = d.total / static_cast<double>(d.snapshots);

  const Eigen::Index kept = choose(result, options.choice, d);
  result.basis.vectors = d.vectors.leftCols(kept);
  check_orthonormal(result.basis.vectors);
  fix_signs(result.basis.vectors);
  result.basis.mean = d.mean;
  result.basis.energy = result.shares.head(kept);
  result.basis.kind = BasisKind::kPom;
  result.basis.provenance = fmt::format("{} of {} proper orthogonal modes of {} snapshots, {}, {}", kept, result.rank,
                                        d.snapshots, options.remove_mean ? "mean removed" : "mean kept", d.method);
  return result;
}

}  // namespace slipmode::pod
