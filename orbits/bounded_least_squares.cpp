#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/dense_lapack.hpp>
#include "orbits/internal/shooting_problem.hpp"

#include <cmath>

namespace slipmode::orbits {
namespace {

/// Below this share of the largest singular value a direction counts as lost.
constexpr double kRankTolerance = 1e-12;

SingularValues decompose(const Eigen::MatrixXd& J) {
  if (J.cols() > 24) return singular_values(J);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

}  // namespace

BoundedLeastSquares bounded_least_squares(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double radius) {
  const SingularValues d = decompose(J);
  const Eigen::VectorXd beta = -d.U.transpose() * r;
  const Eigen::Index count = d.sigma.size();
  BoundedLeastSquares out;
  out.smallest = d.sigma[0] > 0 ? d.sigma[count - 1] / d.sigma[0] : 0.0;
  const auto coefficients = [&](double mu) {
    Eigen::VectorXd c = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < count; ++i)
      if (d.sigma[i] > kRankTolerance * d.sigma[0]) c[i] = d.sigma[i] * beta[i] / (d.sigma[i] * d.sigma[i] + mu);
    return c;
  };
  Eigen::VectorXd c = coefficients(0.0);
  if (c.norm() > radius) {
    // ‖c(μ)‖ falls with μ: bisection on ln μ, a tenth of the radius is near enough.
    double low = std::log(1e-30 * d.sigma[0] * d.sigma[0]);
    double high = std::log(d.sigma[0] * d.sigma[0] + d.sigma[0] * beta.norm() / radius);
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      c = coefficients(std::exp(middle));
      const double norm = c.norm();
      if (norm <= radius && norm >= 0.9 * radius) break;
      (norm > radius ? low : high) = middle;
    }
  }
  out.step = d.V * c;
  out.predicted = (J * out.step + r).norm();
  return out;
}

}  // namespace slipmode::orbits
