#include "dynamics/internal/bernstein.hpp"

#include <Eigen/Core>
#include <bit>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Below this width a sign change that does not separate is called a touch.
constexpr double kSmallestInterval = 1e-12;
/// Relative accuracy of a root: the last Newton step, so that its error is the square of this.
constexpr double kRootTolerance = 1e-6;

using Eight = Eigen::Array<double, 8, 1>;
using Columns = std::array<std::array<double, 8>, 8>;

constexpr auto kBinomial = [] {
  std::array<std::array<double, 9>, 9> out{};
  for (std::size_t n = 0; n < 9; ++n) {
    out[n][0] = 1.0;
    for (std::size_t k = 1; k <= n; ++k)
      out[n][k] = out[n][k - 1] * static_cast<double>(n - k + 1) / static_cast<double>(k);
  }
  return out;
}();

/// Eight coefficients → the first eight on [0, ½]: C(i, j) / 2ⁱ, whatever the degree. Columns.
constexpr Columns kFirstHalf = [] {
  Columns out{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j <= i; ++j) out[j][i] = kBinomial[i][j] / static_cast<double>(1 << i);
  return out;
}();
/// The last eight → the last eight on [½, 1].
constexpr Columns kLastHalf = [] {
  Columns out{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < 8; ++j) out[j][i] = kFirstHalf[7 - j][7 - i];
  return out;
}();
/// Eight coefficients → their forward differences of order 0 … 7.
constexpr Columns kDifferences = [] {
  Columns out{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j <= i; ++j) out[j][i] = kBinomial[i][j] * ((i - j) % 2 == 0 ? 1.0 : -1.0);
  return out;
}();

Eight product(const Columns& columns, const double* b) {
  const auto column = [&](std::size_t j) { return Eigen::Map<const Eight>(columns[j].data()); };
  const Eight even = (column(0) * b[0] + column(2) * b[2]) + (column(4) * b[4] + column(6) * b[6]);
  const Eight odd = (column(1) * b[1] + column(3) * b[3]) + (column(5) * b[5] + column(7) * b[7]);
  return even + odd;
}

/// The parts on [0, ½] and on [½, 1], each on [0, 1] again. @param b, out_left, out_right  [degree + 1], degree 7 or 8
void halve(const double* b, int degree, double* out_left, double* out_right) {
  const int ninth = degree - 7;
  Eigen::Map<Eight> left(out_left), right(out_right + ninth);
  left = product(kFirstHalf, b);
  right = product(kLastHalf, b + ninth);
  if (ninth == 1) out_left[8] = out_right[0] = 0.5 * (left(7) + right(0));
}

/// A polynomial by powers, and its derivative; short chains of operations.
struct PowerForm {
  std::array<double, 9> power{};
  std::array<double, 8> slope;

  explicit PowerForm(const BernsteinPolynomial& p) {
    const auto n = static_cast<std::size_t>(p.degree);
    Eigen::Map<Eight> first(power.data());
    first = product(kDifferences, p.coefficient.data());
    if (n == 8) power[8] = product(kDifferences, p.coefficient.data() + 1)(7) - power[7];
    first *= Eigen::Map<const Eight>(kBinomial[n].data());
    for (std::size_t k = 0; k < 8; ++k) slope[k] = static_cast<double>(k + 1) * power[k + 1];
  }

  [[nodiscard]] static double sum(const double* c, double t, double t2, double t4) {
    return ((c[0] + c[1] * t) + (c[2] + c[3] * t) * t2) + ((c[4] + c[5] * t) + (c[6] + c[7] * t) * t2) * t4;
  }
  struct Value {
    double value, slope;
  };
  [[nodiscard]] Value at(double t) const {
    const double t2 = t * t, t4 = t2 * t2;
    return {sum(power.data(), t, t2, t4) + power[8] * (t4 * t4), sum(slope.data(), t, t2, t4)};
  }
};

/// The single root of a polynomial that is positive just after 0 and not positive at 1: Newton on the power form, kept
/// inside a shrinking bracket.
double single_root(const BernsteinPolynomial& p) {
  const PowerForm form(p);
  // From where the control polygon crosses zero.
  std::size_t last = 0;
  while (p.coefficient[last + 1] > 0 || p.coefficient[last] <= 0) ++last;
  const double above = p.coefficient[last], below = p.coefficient[last + 1];
  double lo = 0.0, hi = 1.0, t = (static_cast<double>(last) + above / (above - below)) / p.degree;
  for (int i = 0; i < 100; ++i) {
    const auto [f, slope] = form.at(t);
    (f > 0 ? lo : hi) = t;
    double next = t - f / slope;
    if (!(next > lo && next < hi)) next = lo + (hi - lo) / 2;
    if (std::abs(next - t) <= kRootTolerance * next || hi - lo <= kRootTolerance * hi) return next;
    t = next;
  }
  return t;
}

std::optional<FirstRoot> search(const BernsteinPolynomial& p, double lo, double width) {
  unsigned positive = 0, negative = 0;
  for (int k = 0; k <= p.degree; ++k) {
    const double b = p.coefficient[static_cast<std::size_t>(k)];
    positive |= static_cast<unsigned>(b > 0) << k;
    negative |= static_cast<unsigned>(b < 0) << k;
  }
  if (negative == 0) return positive == 0 ? std::optional(FirstRoot{lo, true}) : std::nullopt;
  const int first = std::countr_zero(negative);
  if (std::countr_zero(positive) > first) return FirstRoot{lo, false};  // negative from the start
  // One change of sign: no positive one after the first negative one.
  if (positive >> first == 0) return FirstRoot{lo + width * single_root(p), false};
  if (width < kSmallestInterval) return FirstRoot{lo, true};
  BernsteinPolynomial left{p.degree, {}}, right{p.degree, {}};
  halve(p.coefficient.data(), p.degree, left.coefficient.data(), right.coefficient.data());
  if (auto root = search(left, lo, width / 2)) return root;
  return search(right, lo + width / 2, width / 2);
}

}  // namespace

bool stays_above(const std::array<double, 8>& coefficients, double bound, int halvings) {
  if (Eigen::Map<const Eight>(coefficients.data()).minCoeff() > bound) return true;
  if (halvings == 0 || coefficients.front() <= bound || coefficients.back() <= bound) return false;
  std::array<double, 8> left, right;
  halve(coefficients.data(), 7, left.data(), right.data());
  return stays_above(left, bound, halvings - 1) && stays_above(right, bound, halvings - 1);
}

BernsteinPolynomial lowered(BernsteinPolynomial p, double by) {
  for (int k = 0; k <= p.degree; ++k) p.coefficient[static_cast<std::size_t>(k)] -= by;
  return p;
}

BernsteinPolynomial part(const BernsteinPolynomial& p, double from, double to) {
  // De Casteljau's scheme twice: what lies after `from`, and of that what lies before `to`.
  BernsteinPolynomial out = p;
  const auto n = static_cast<std::size_t>(p.degree);
  auto& b = out.coefficient;
  if (from > 0.0)
    for (std::size_t round = 1; round <= n; ++round)
      for (std::size_t k = 0; k + round <= n; ++k) b[k] += from * (b[k + 1] - b[k]);
  if (to == 1.0) return out;
  const double share = from < 1.0 ? (to - from) / (1.0 - from) : 0.0;
  for (std::size_t round = 1; round <= n; ++round)
    for (std::size_t k = n; k >= round; --k) b[k] = b[k - 1] + share * (b[k] - b[k - 1]);
  return out;
}

BernsteinPolynomial derivative(const BernsteinPolynomial& p) {
  BernsteinPolynomial out{p.degree - 1, {}};
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.degree); ++k)
    out.coefficient[k] = p.degree * (p.coefficient[k + 1] - p.coefficient[k]);
  return out;
}

std::optional<FirstRoot> first_root(const BernsteinPolynomial& p) { return search(p, 0.0, 1.0); }

double least(const BernsteinPolynomial& p) {
  return *std::min_element(p.coefficient.begin(), p.coefficient.begin() + p.degree + 1);
}

double most(const BernsteinPolynomial& p) {
  return *std::max_element(p.coefficient.begin(), p.coefficient.begin() + p.degree + 1);
}

}  // namespace slipmode::dynamics
