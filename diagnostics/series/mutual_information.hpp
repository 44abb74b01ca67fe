#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// How the densities in the mutual information are estimated.
enum class InformationEstimator {
  kEqualWidth,    ///< bins of equal width over the range of the series: S4 (3.22)
  kEquiprobable,  ///< bins of equal numbers of samples
  kNearest,       ///< no bins: distances to the k-th neighbour
};

struct InformationOptions {
  Eigen::Index max_lag = 100;  ///< [samples]
  InformationEstimator estimator = InformationEstimator::kEquiprobable;
  int bins = 16;             ///< per coordinate, ≥ 2, for the two kinds of bins
  int neighbours = 4;        ///< k of kNearest, ≥ 1
  ParallelOptions run = {};  ///< lags run in parallel
};

/// Average mutual information of s_n and s_{n+lag}, and the delay it suggests.
struct MutualInformation {
  Eigen::VectorXd bits;  ///< I(lag), lag = 0 … max_lag [bit]; NaN at lag 0 for kNearest, where it is infinite
  /// Root mean square over lags 1 … max_lag of half the difference between the two halves of the record [bit].
  double error = 0.0;
  /// Root mean square of the change from one lag to the next of the difference between the halves: a smaller rise of I
  /// is scatter [bit].
  double rise = 0.0;
  /// The lag ≥ 1 of the lowest value before I first rises by `rise` above the lowest so far; −1 if it does not rise up
  /// to max_lag.
  Eigen::Index first_minimum = -1;
  /// The same for each half of the record alone; −1 where there is none.
  Eigen::Index first_minimum_of_halves[2] = {-1, -1};
  InformationOptions settings;
};

/// I(lag) = Σ P(s_n, s_{n+lag}) log₂ [P(s_n, s_{n+lag}) / (P(s_n) P(s_{n+lag}))], the marginals counted over the same
/// pairs, so that I ≥ 0.
///
/// kNearest: I = ψ(k) − ⟨ψ(n_x) + ψ(n_y)⟩ − 1/k + ψ(N) over ln 2, where n_x counts the points whose first coordinates
/// lie within the reach in x of the k nearest points in the maximum norm (n_y likewise). Unbiased for independent
/// samples: it may be slightly negative.
/// Cost: O(T) per lag with bins, O(T log T) without.
/// @throws InvalidInput  for options out of range, or fewer samples than 2 (max_lag + 10·max(bins, neighbours))
/// Source: Fraser, Swinney, Phys. Rev. A 33 (1986) 1134; S4 (3.20)-(3.22); Kraskov, Stögbauer, Grassberger, Phys. Rev.
/// E 69 (2004) 066138, second estimator.
[[nodiscard]] MutualInformation mutual_information(const Series& series, const InformationOptions& options = {});

}  // namespace slipmode::diagnostics
