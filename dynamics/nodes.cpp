#include <slipmode/dynamics/nodes.hpp>

#include <slipmode/core/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using Real = long double;
using MatrixL = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using VectorL = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Legendre polynomials P_0..P_degree at x in [-1, 1].
VectorL legendre(int degree, Real x) {
  VectorL p(degree + 1);
  p(0) = 1;
  if (degree > 0) p(1) = x;
  for (int k = 2; k <= degree; ++k) p(k) = ((2 * k - 1) * x * p(k - 1) - (k - 1) * p(k - 2)) / k;
  return p;
}

/// Roots of a function on (-1, 1] found by scanning and bisection: few, simple, well apart.
template <class F>
VectorL simple_roots(F f, int count) {
  VectorL roots(count);
  const int scan = 4000;
  int found = 0;
  Real a = -1 + Real(1e-9), fa = f(a);
  for (int i = 1; i <= scan && found < count; ++i) {
    const Real b = -1 + Real(2) * i / scan, fb = f(b);
    if ((fa < 0) != (fb < 0)) {
      Real lo = a, hi = b;
      for (int it = 0; it < 90; ++it) {
        const Real mid = (lo + hi) / 2;
        ((f(mid) < 0) == (fa < 0) ? lo : hi) = mid;
      }
      roots(found++) = (lo + hi) / 2;
    }
    a = b;
    fa = fb;
  }
  return roots;
}

/// Matrix that takes values at `points` to values at `targets` of the interpolating polynomial.
MatrixL interpolation(const VectorL& points, const VectorL& targets) {
  MatrixL L(targets.size(), points.size());
  for (Eigen::Index i = 0; i < targets.size(); ++i)
    for (Eigen::Index j = 0; j < points.size(); ++j) {
      Real product = 1;
      for (Eigen::Index k = 0; k < points.size(); ++k)
        if (k != j) product *= (targets(i) - points(k)) / (points(j) - points(k));
      L(i, j) = product;
    }
  return L;
}

/// Bernstein polynomials of the given degree at the points: rows are points.
MatrixL bernstein_values(int degree, const VectorL& points) {
  MatrixL B(points.size(), degree + 1);
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    Real binomial = 1;
    for (int k = 0; k <= degree; ++k) {
      B(i, k) = binomial * std::pow(points(i), Real(k)) * std::pow(1 - points(i), Real(degree - k));
      binomial = binomial * (degree - k) / (k + 1);
    }
  }
  return B;
}

/// Largest values are taken on a grid so fine that what lies between adds less than the thousandth allowed for.
constexpr int kGrid = 400;
constexpr double kBetweenGrid = 1.001;

/// max |Ω⁽ʲ⁾| on [0,1] over the factorial of the number of points, Ω = Π (t − point).
std::array<double, 3> remainders(const VectorL& points) {
  VectorL power = VectorL::Zero(points.size() + 1);  // Ω by powers
  power(0) = 1;
  Real factorial = 1;
  for (Eigen::Index k = 0; k < points.size(); ++k) {
    factorial *= static_cast<Real>(k + 1);
    for (Eigen::Index i = k + 1; i >= 0; --i) power(i) = (i > 0 ? power(i - 1) : Real(0)) - points(k) * power(i);
  }
  std::array<double, 3> out{};
  for (double& remainder : out) {
    for (int i = 0; i <= kGrid; ++i) {
      Real value = 0;
      for (Eigen::Index k = power.size(); k-- > 0;) value = value * i / kGrid + power(k);
      remainder = std::max(remainder, static_cast<double>(std::abs(value)));
    }
    remainder *= kBetweenGrid / static_cast<double>(factorial);
    for (Eigen::Index k = 1; k < power.size(); ++k) power(k - 1) = static_cast<Real>(k) * power(k);
    power(power.size() - 1) = 0;
  }
  return out;
}

RadauTables build() {
  VectorL c(kNodes);
  c.head(kNodes - 1) = simple_roots(
      [](Real x) {
        const VectorL p = legendre(kNodes, x);
        return (p(kNodes) - p(kNodes - 1)) / (x - 1);
      },
      kNodes - 1);
  for (int j = 0; j + 1 < kNodes; ++j) c(j) = (c(j) + 1) / 2;
  c(kNodes - 1) = 1;

  MatrixL P(kNodes, kNodes), V(kNodes, kNodes);
  for (int i = 0; i < kNodes; ++i) {
    P.row(i) = legendre(kNodes - 1, 2 * c(i) - 1).transpose();
    for (int k = 0; k < kNodes; ++k) V(i, k) = std::pow(c(i), Real(k));
  }
  const MatrixL to_legendre = P.inverse();

  VectorL with_start(kNodes + 1);
  with_start << 0, c;
  const MatrixL to_bernstein8 = bernstein_values(kNodes, with_start).inverse();

  RadauTables t;
  t.node = c.cast<double>();
  t.weight = to_legendre.row(0).transpose().cast<double>();
  t.bernstein7 = bernstein_values(kNodes - 1, c).inverse().cast<double>();
  t.bernstein8 = to_bernstein8.bottomRightCorner(kNodes, kNodes).cast<double>();
  t.bernstein8_start = to_bernstein8.col(0).tail(kNodes).cast<double>();
  t.legendre = to_legendre.cast<double>();
  t.legendre5 = to_legendre.row(kNodes - 3).transpose().cast<double>();
  t.legendre6 = to_legendre.row(kNodes - 2).transpose().cast<double>();
  t.legendre7 = to_legendre.row(kNodes - 1).transpose().cast<double>();
  MatrixL T(kNodes + 1, kNodes + 1);
  for (int i = 0; i <= kNodes; ++i)
    for (int k = 0; k <= kNodes; ++k) T(i, k) = std::cos(k * std::acos(2 * with_start(i) - 1));
  const MatrixL to_chebyshev = T.inverse();
  t.chebyshev = to_chebyshev.bottomRightCorner(kNodes, kNodes).cast<double>();
  t.chebyshev_start = to_chebyshev.col(0).tail(kNodes).cast<double>();
  t.chebyshev_mean = to_chebyshev.row(0).tail(kNodes).transpose().cast<double>();
  t.chebyshev_mean_start = static_cast<double>(to_chebyshev(0, 0));
  t.remainder = remainders(with_start);
  t.force_remainder = remainders(c);
  const MatrixL basis = interpolation(c, VectorL::LinSpaced(kGrid + 1, 0, 1)).cwiseAbs();
  t.lebesgue = kBetweenGrid * static_cast<double>(basis.rowwise().sum().maxCoeff());
  // b = p₇ + γ (P₈ − P₇)(2t − 1) by its value at 0, where that difference is 2; and ∫₀¹ P₇² dt = 1/15.
  const MatrixL at_start = interpolation(c, VectorL::Zero(1));
  for (int j = 0; j < kNodes; ++j) {
    t.product.weight[j] = t.weight(j);
    t.product.last_of_a[j] = -t.legendre7(j) / 30.0;
    t.product.start_of_b[j] = static_cast<double>(at_start(0, j));
  }
  t.left_half = interpolation(c, c / 2).cast<double>();
  t.right_half = interpolation(c, c / 2 + VectorL::Constant(kNodes, Real(0.5))).cast<double>();
  for (std::size_t r = 0; r < t.following.size(); ++r) {
    const int degree = r == 0 ? 4 : 5;
    const Real length = Real(2) / static_cast<Real>(1 << r);
    MatrixL ahead(kNodes, degree + 1);
    for (int i = 0; i < kNodes; ++i) ahead.row(i) = legendre(degree, 1 + 2 * length * c(i)).transpose();
    t.following[r] = (ahead * to_legendre.topRows(degree + 1)).cast<double>();
  }
  for (int j = 0; j < kNodes; ++j) {
    Real product = 1;
    for (int k = 0; k < kNodes; ++k)
      if (k != j) product *= c(j) - c(k);
    t.barycentric(j) = static_cast<double>(1 / product);
  }
  const MatrixL to_monomial = V.inverse();
  t.monomial = to_monomial.cast<double>();
  MatrixL powers(kNodes, kNodes);  // ∫₀^{c_i} t^k
  for (int i = 0; i < kNodes; ++i)
    for (int k = 0; k < kNodes; ++k) powers(i, k) = V(i, k) * c(i) / static_cast<Real>(k + 1);
  t.integral = (powers * to_monomial).cast<double>();
  return t;
}

}  // namespace

RadauTables::Vector8 RadauTables::lagrange(double t) const {
  // Products of (t − c_k) from the left and from the right: no division, and exact at a node.
  Vector8 values = barycentric;
  double left = 1.0, right = 1.0;
  for (int j = 0; j < kNodes; ++j) {
    values(j) *= left;
    values(kNodes - 1 - j) *= right;
    left *= t - node(j);
    right *= t - node(kNodes - 1 - j);
  }
  return values;
}

RadauTables::Vector8 RadauTables::lagrange_slope(double t) const {
  Vector8 powers;  // derivative of 1, t, ..., t⁷
  double power = 1.0;
  powers(0) = 0.0;
  for (int k = 1; k < kNodes; ++k, power *= t) powers(k) = k * power;
  return monomial.transpose() * powers;
}

const RadauTables& radau() {
  static const RadauTables tables = build();
  return tables;
}

GaussRule gauss_rule(int points) {
  // Newton on P_n from the Chebyshev guess converges for every n of use here.
  GaussRule rule{Eigen::VectorXd(points), Eigen::VectorXd(points)};
  for (int i = 0; i < points; ++i) {
    Real x = std::cos(std::numbers::pi_v<Real> * (i + Real(0.75)) / (points + Real(0.5))), slope = 0;
    for (int it = 0; it < 50; ++it) {
      const VectorL p = legendre(points, x);
      slope = points * (x * p(points) - p(points - 1)) / (x * x - 1);
      const Real dx = p(points) / slope;
      x -= dx;
      if (std::abs(dx) < 1e-19L) break;
    }
    rule.node(points - 1 - i) = static_cast<double>((x + 1) / 2);
    rule.weight(points - 1 - i) = static_cast<double>(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace slipmode::dynamics
