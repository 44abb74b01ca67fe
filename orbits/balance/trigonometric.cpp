#include "orbits/balance/internal/trigonometric.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

constexpr double kNarrowest = 1e-9;

class ZeroSearch {
 public:
  explicit ZeroSearch(const TrigonometricPolynomial& polynomial) : polynomial_(polynomial) {
    for (Eigen::Index k = 1; k < polynomial.phasors.size(); ++k)
      curvature_ += static_cast<double>(k * k) * std::abs(polynomial.phasors[k]);
  }

  void search(double low, double at_low, double high, double at_high) {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    const auto [y, slope] = polynomial_.at(middle);
    if (std::abs(y) > std::abs(slope) * half + 0.5 * curvature_ * half * half) return;
    if (std::abs(slope) > curvature_ * half || half < 0.5 * kNarrowest) {
      if ((at_low < 0.0) != (at_high < 0.0)) found.push_back(zero_between(polynomial_, low, at_low < 0.0, high));
      return;
    }
    search(low, at_low, middle, y);
    search(middle, y, high, at_high);
  }

  std::vector<double> found;

 private:
  const TrigonometricPolynomial& polynomial_;
  double curvature_ = 0.0;  ///< bound on |y″|
};

}  // namespace

TrigonometricPolynomial::Value TrigonometricPolynomial::at(double theta) const {
  const double c = std::cos(theta), s = std::sin(theta);
  double re = 0.0, im = 0.0, slope_re = 0.0, slope_im = 0.0;  // Horner's rule for Σ p_k z^k and Σ k p_k z^k
  for (Eigen::Index k = phasors.size() - 1; k > 0; --k) {
    const std::complex<double> p = phasors[k];
    const double a = re + p.real(), b = im + p.imag();
    re = a * c - b * s;
    im = a * s + b * c;
    const double da = slope_re + static_cast<double>(k) * p.real(), db = slope_im + static_cast<double>(k) * p.imag();
    slope_re = da * c - db * s;
    slope_im = da * s + db * c;
  }
  return {re + phasors[0].real(), -slope_im};
}

TrigonometricPolynomial polynomial_of(const Harmonics& y) {
  TrigonometricPolynomial polynomial{Eigen::VectorXcd(y.cosine.size())};
  polynomial.phasors.real() = y.cosine;
  polynomial.phasors.imag() = -y.sine;
  return polynomial;
}

TrigonometricPolynomial derivative(const TrigonometricPolynomial& y) {
  TrigonometricPolynomial out = y;
  for (Eigen::Index k = 0; k < out.phasors.size(); ++k)
    out.phasors[k] *= std::complex<double>(0.0, static_cast<double>(k));
  return out;
}

double zero_between(const TrigonometricPolynomial& polynomial, double low, bool negative, double high) {
  double theta = 0.5 * (low + high);  // Newton's method within a bracket
  for (int turn = 0; turn < 80; ++turn) {
    const auto [y, slope] = polynomial.at(theta);
    ((y < 0.0) == negative ? low : high) = theta;
    double next = theta - y / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - theta) <= 4e-16 * (1.0 + theta)) return next;
    theta = next;
  }
  return theta;
}

std::vector<double> zeros(const TrigonometricPolynomial& polynomial) {
  ZeroSearch search(polynomial);
  constexpr int kParts = 8;  // the bound tells where more are wanted
  const double width = 2.0 * std::numbers::pi / kParts, first = polynomial.at(0.0).y;
  double low = 0.0, at_low = first;
  for (int k = 1; k <= kParts; ++k) {
    const bool last = k == kParts;
    const double high = last ? 2.0 * std::numbers::pi : width * k;
    const double at_high = last ? first : polynomial.at(high).y;
    search.search(low, at_low, high, at_high);
    low = high;
    at_low = at_high;
  }
  return std::move(search.found);
}

}  // namespace slipmode::orbits
