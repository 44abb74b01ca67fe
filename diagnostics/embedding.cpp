#include "diagnostics/embedding.hpp"

#include "core/errors.hpp"

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
  const Eigen::Index points = series.values.size() - span;
  Eigen::MatrixXd vectors(embedding.dimension, points);
  for (int k = 0; k < embedding.dimension; ++k) {
    vectors.row(k) = series.values.segment(k * embedding.lag, points).transpose();
  }
  return vectors;
}

}  // namespace slipmode::diagnostics
