#include <slipmode/orbits/floquet.hpp>

#include <slipmode/core/dense_lapack.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace slipmode::orbits {
namespace {

/// Norm of Φ, velocities as displacements in a radian of the orbit: of any units.
double size_of_monodromy(const PeriodicOrbit& orbit) {
  if (orbit.monodromy.size() == 0) return 0.0;
  const Eigen::Index n = orbit.start.v.size();
  const double radian = orbit.period / (2.0 * std::numbers::pi);
  Eigen::MatrixXd balanced = orbit.monodromy;
  balanced.middleRows(n, n) *= radian;
  balanced.middleCols(n, n) /= radian;
  return balanced.norm();
}

std::vector<Eigen::Index> order_by_modulus(const Eigen::VectorXcd& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    const double size_a = std::abs(values[a]), size_b = std::abs(values[b]);
    if (std::abs(size_a - size_b) > 1e-14 * std::max(size_a, size_b)) return size_a > size_b;
    return values[a].imag() > values[b].imag();
  });
  return order;
}

}  // namespace

Eigen::VectorXcd sorted_by_modulus(const Eigen::VectorXcd& values) { return values(order_by_modulus(values)); }

Eigen::VectorXcd sorted_eigenvalues(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  return sorted_by_modulus(eigenpairs(matrix, false).values);
}

std::vector<FloquetMode> floquet_modes(const Eigen::MatrixXd& matrix) {
  const Eigenpairs pairs = eigenpairs(matrix, true);
  std::vector<FloquetMode> modes;
  for (const Eigen::Index i : order_by_modulus(pairs.values)) {
    Eigen::VectorXcd direction = pairs.vectors.col(i).normalized();
    Eigen::Index at = 0;
    direction.cwiseAbs().maxCoeff(&at);
    direction *= std::conj(direction[at]) / std::abs(direction[at]);
    modes.push_back({pairs.values[i], std::move(direction)});
  }
  return modes;
}

std::vector<Eigen::Index> trivial_indices(const Eigen::VectorXcd& multipliers, int count) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(multipliers.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(multipliers[a] - 1.0) < std::abs(multipliers[b] - 1.0);
  });
  order.resize(static_cast<std::size_t>(std::min<Eigen::Index>(count, multipliers.size())));
  return order;
}

void set_stability(PeriodicOrbit& orbit, double marginal_band) {
  if (orbit.monodromy.size() > 0) orbit.multipliers = sorted_eigenvalues(orbit.monodromy);
  const std::vector<Eigen::Index> trivial = trivial_indices(orbit.multipliers, orbit.trivial_multipliers);
  const double zero = 1e-8 * std::max(1.0, size_of_monodromy(orbit));
  orbit.leading_modulus = 0.0;
  orbit.zero_multipliers = 0;
  for (Eigen::Index i = 0; i < orbit.multipliers.size(); ++i) {
    if (std::find(trivial.begin(), trivial.end(), i) != trivial.end()) continue;
    orbit.leading_modulus = std::max(orbit.leading_modulus, std::abs(orbit.multipliers[i]));
    if (std::abs(orbit.multipliers[i]) <= zero) ++orbit.zero_multipliers;
  }
  const auto others = orbit.multipliers.size() - static_cast<Eigen::Index>(trivial.size());
  orbit.superstable = orbit.zero_multipliers == others;
  orbit.stability = orbit.leading_modulus > 1.0 + marginal_band    ? Stability::kUnstable
                    : orbit.leading_modulus >= 1.0 - marginal_band ? Stability::kMarginal
                                                                   : Stability::kStable;
}

}  // namespace slipmode::orbits
