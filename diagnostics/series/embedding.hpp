#pragma once

#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Which samples make a point: x_i = (s_i, s_{i+lag}, …, s_{i+(dimension−1)lag}).
struct Embedding {
  int dimension = 3;
  Eigen::Index lag = 1;  ///< delay [samples]

  /// Samples a point spans beyond its first.
  [[nodiscard]] Eigen::Index span() const { return (dimension - 1) * lag; }
};

/// Delay vectors in time order, one column per point [dimension x (T − span)].
/// @throws InvalidInput  for a dimension or lag below 1, a series that check_series refuses, or fewer than 2 points
/// Source: Takens, Lecture Notes in Mathematics 898 (1981) 366; S4, sections 3.2 and 3.5.4.
[[nodiscard]] Eigen::MatrixXd delay_vectors(const Series& series, const Embedding& embedding);

}  // namespace slipmode::diagnostics
