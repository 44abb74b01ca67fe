#include "dynamics/internal/bernstein.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Below this width a sign change that does not separate is called a touch.
constexpr double kSmallestInterval = 1e-12;
/// Relative accuracy of a root: the last Newton step, so that its error is the square of this.
constexpr double kRootTolerance = 1e-6;

constexpr std::size_t index(int k) { return static_cast<std::size_t>(k); }

constexpr auto kBinomial = [] {
  constexpr int most = BernsteinPolynomial::kMaxDegree;
  std::array<std::array<double, most + 1>, most + 1> out{};
  for (int n = 0; n <= most; ++n) {
    out[index(n)][0] = 1.0;
    for (int k = 1; k <= n; ++k) out[index(n)][index(k)] = out[index(n)][index(k - 1)] * (n - k + 1) / k;
  }
  return out;
}();

/// The single root of a polynomial that is positive just after 0 and not positive at 1: Newton on the power form, kept
/// inside a shrinking bracket.
double single_root(const BernsteinPolynomial& p) {
  std::array<double, BernsteinPolynomial::kMaxDegree + 1> power =
      p.coefficient;  // forward differences, then × binomial
  for (int order = 1; order <= p.degree; ++order)
    for (int k = p.degree; k >= order; --k) power[index(k)] -= power[index(k - 1)];
  for (int k = 1; k <= p.degree; ++k) power[index(k)] *= kBinomial[index(p.degree)][index(k)];
  // From where the control polygon crosses zero.
  int last = 0;
  while (p.coefficient[index(last + 1)] > 0 || p.coefficient[index(last)] <= 0) ++last;
  const double above = p.coefficient[index(last)], below = p.coefficient[index(last + 1)];
  double lo = 0.0, hi = 1.0, t = (last + above / (above - below)) / p.degree;
  for (int i = 0; i < 100; ++i) {
    double f = power[index(p.degree)], slope = 0.0;
    for (int k = p.degree - 1; k >= 0; --k) {
      slope = slope * t + f;
      f = f * t + power[index(k)];
    }
    (f > 0 ? lo : hi) = t;
    double next = t - f / slope;
    if (!(next > lo && next < hi)) next = lo + (hi - lo) / 2;
    if (std::abs(next - t) <= kRootTolerance * next || hi - lo <= kRootTolerance * hi) return next;
    t = next;
  }
  return t;
}

std::optional<FirstRoot> search(const BernsteinPolynomial& p, double lo, double width) {
  int changes = 0;
  double previous = 0.0;
  for (int k = 0; k <= p.degree; ++k) {
    const double b = p.coefficient[static_cast<std::size_t>(k)];
    if (b == 0) continue;
    if (previous != 0 && (b > 0) != (previous > 0)) ++changes;
    if (previous == 0 && b < 0) return FirstRoot{lo, false};  // negative from the start
    previous = b;
  }
  if (changes == 0) return previous == 0 ? std::optional(FirstRoot{lo, true}) : std::nullopt;
  if (changes == 1 && previous < 0) return FirstRoot{lo + width * single_root(p), false};
  if (width < kSmallestInterval) return FirstRoot{lo, true};
  BernsteinPolynomial left, right;
  p.split(0.5, left, right);
  if (auto root = search(left, lo, width / 2)) return root;
  return search(right, lo + width / 2, width / 2);
}

}  // namespace

bool stays_above(const std::array<double, 8>& coefficients, double bound, int halvings) {
  if (*std::min_element(coefficients.begin(), coefficients.end()) > bound) return true;
  if (halvings == 0 || coefficients.front() <= bound || coefficients.back() <= bound) return false;
  // De Casteljau's rule at one half.
  std::array<double, 8> left = coefficients, right = coefficients;
  for (std::size_t level = 1; level < 8; ++level) {
    for (std::size_t k = 7; k >= level; --k) left[k] = 0.5 * (left[k - 1] + left[k]);
    for (std::size_t k = 0; k < 8 - level; ++k) right[k] = 0.5 * (right[k] + right[k + 1]);
  }
  return stays_above(left, bound, halvings - 1) && stays_above(right, bound, halvings - 1);
}

double BernsteinPolynomial::operator()(double t) const {
  auto b = coefficient;
  for (int level = degree; level > 0; --level)
    for (int k = 0; k < level; ++k) {
      const auto i = static_cast<std::size_t>(k);
      b[i] += t * (b[i + 1] - b[i]);
    }
  return b[0];
}

void BernsteinPolynomial::split(double t, BernsteinPolynomial& left, BernsteinPolynomial& right) const {
  left.degree = right.degree = degree;
  auto b = coefficient;
  const auto last = static_cast<std::size_t>(degree);
  left.coefficient[0] = b[0];
  right.coefficient[last] = b[last];
  for (int level = degree; level > 0; --level) {
    for (int k = 0; k < level; ++k) {
      const auto i = static_cast<std::size_t>(k);
      b[i] += t * (b[i + 1] - b[i]);
    }
    left.coefficient[static_cast<std::size_t>(degree - level + 1)] = b[0];
    right.coefficient[static_cast<std::size_t>(level - 1)] = b[static_cast<std::size_t>(level - 1)];
  }
}

std::optional<FirstRoot> first_root(const BernsteinPolynomial& p) { return search(p, 0.0, 1.0); }

}  // namespace slipmode::dynamics
