#pragma once

#include <slipmode/pod/pod.hpp>
#include "pod/internal/snapshot_triangle.hpp"

#include <string>

namespace slipmode::pod {

/// A decomposition before modes are chosen.
struct Decomposition {
  Eigen::VectorXd sigma;    ///< descending, not scaled by T
  Eigen::MatrixXd vectors;  ///< one column per sigma, at least as many columns as the rank
  Eigen::VectorXd mean;     ///< q̄ [n]; zero when the mean stays
  double total = 0.0;       ///< ‖X − q̄‖²_F
  Eigen::Index snapshots = 0;
  double relative_error = 0.0;  ///< of a singular value against the largest: what the method leaves as rounding
  std::string method;           ///< for the basis's provenance
};

/// @throws InvalidInput  for no degrees of freedom, or fewer than two snapshots
void check_counts(Eigen::Index dofs, Eigen::Index snapshots);

/// @param first  number of the first one among all, from 0
/// @throws InvalidInput  naming the first value that is not finite
void check_finite(const Eigen::MatrixXd& snapshots, Eigen::Index first);

/// Checks a choice before work starts.
/// @throws InvalidInput  for a negative count, more modes than `dofs`, a share outside (0, 1], a negative tolerance
void validate(const PodOptions& options, Eigen::Index dofs);

/// True when fluctuations of this energy about `mean` are what rounding alone leaves of constant snapshots.
[[nodiscard]] bool is_constant(double total, const Eigen::VectorXd& mean, Eigen::Index snapshots);

/// @throws InvalidInput  saying that there is nothing to decompose
[[noreturn]] void fail_constant(Eigen::Index snapshots, double total, bool mean_removed);

/// How many of the leading shares reach `energy`; shares.size() + 1 if they do not.
[[nodiscard]] Eigen::Index modes_for_energy(const Eigen::VectorXd& shares, double energy);

/// Rank, shares, choice of modes, signs, and the check that modes are orthonormal.
[[nodiscard]] PodResult assemble(const Decomposition& decomposition, const PodOptions& options);

/// The method that kAutomatic means for so many degrees of freedom and snapshots; another one as it is.
[[nodiscard]] PodMethod resolved_method(Eigen::Index dofs, Eigen::Index snapshots, const PodOptions& options);

/// Decompositions by the two methods that have a file of their own; Lanczos also of a triangle, where a step costs n².
[[nodiscard]] Decomposition decompose_lanczos(const Eigen::MatrixXd& snapshots, const PodOptions& options);
[[nodiscard]] Decomposition decompose_lanczos(const SnapshotTriangle& sum, const PodOptions& options);
[[nodiscard]] Decomposition decompose_covariance(const Eigen::MatrixXd& snapshots, const PodOptions& options);

}  // namespace slipmode::pod
