#include <slipmode/diagnostics/series/kaplan_yorke.hpp>

#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace slipmode::diagnostics {

double kaplan_yorke_dimension(const Eigen::VectorXd& exponents) {
  const bool usable =
      std::all_of(exponents.begin(), exponents.end(), [](double x) { return std::isfinite(x) || x < 0.0; });
  if (exponents.size() == 0 || !usable) {
    throw InvalidInput(
        "Kaplan-Yorke dimension: expected exponents that are finite or minus infinity, found others or none");
  }
  Eigen::VectorXd sorted = exponents;
  std::sort(sorted.begin(), sorted.end(), std::greater<>{});
  double sum = 0.0;
  for (Eigen::Index j = 0; j < sorted.size(); ++j) {
    if (sum + sorted(j) < 0.0) return static_cast<double>(j) + sum / std::abs(sorted(j));
    sum += sorted(j);
  }
  return static_cast<double>(sorted.size());
}

}  // namespace slipmode::diagnostics
