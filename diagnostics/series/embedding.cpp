#include <slipmode/diagnostics/series/embedding.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

namespace slipmode::diagnostics {

Eigen::MatrixXd delay_vectors(const Series& series, const Embedding& embedding) {
  if (embedding.dimension < 1 || embedding.lag < 1) {
    throw InvalidInput(fmt::format("embedding of {}: expected a dimension and a lag of at least 1, found {} and {}",
                                   series.name, embedding.dimension, embedding.lag));
  }
  const Eigen::Index span = embedding.span();
  check_series(series, span + 2,
               fmt::format("embedding in dimension {} at lag {}", embedding.dimension, embedding.lag));
  const Eigen::Index count = series.values.size() - span;
  Eigen::MatrixXd points(embedding.dimension, count);
  for (Eigen::Index d = 0; d < embedding.dimension; ++d) {
    points.row(d) = series.values.segment(d * embedding.lag, count).transpose();
  }
  return points;
}

}  // namespace slipmode::diagnostics
