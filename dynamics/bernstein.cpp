#include "dynamics/bernstein.hpp"

#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Below this width a sign change that does not separate is called a touch.
constexpr double kSmallestInterval = 1e-12;

/// The single root of a polynomial that is positive just after 0 and not positive at 1: bisection kept safe, secant
/// fast.
double single_root(const BernsteinPolynomial& p) {
  double lo = 0.0, hi = 1.0, f_lo = p.coefficient[0], f_hi = p(1.0);
  for (int i = 0; i < 200 && hi - lo > 1e-16 * hi; ++i) {
    double t = f_lo > 0 ? lo - f_lo * (hi - lo) / (f_hi - f_lo) : lo + (hi - lo) / 2;
    if (!(t > lo && t < hi)) t = lo + (hi - lo) / 2;
    if (t == lo || t == hi) break;
    const double f = p(t);
    if (f == 0) return t;
    if (f > 0) {
      lo = t;
      f_lo = f;
      f_hi /= 2;  // Illinois: no end point stays for ever
    } else {
      hi = t;
      f_hi = f;
      f_lo /= 2;
    }
  }
  return hi;
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
