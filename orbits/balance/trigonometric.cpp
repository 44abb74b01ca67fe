#include "orbits/balance/internal/trigonometric.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

constexpr double kNarrowest = 1e-9;
constexpr int kParts = 32;  ///< that a circle is first cut into: the bound tells where more are wanted
constexpr int kLanes = 2 * kParts;

/// Numbers at as many angles.
using Lanes = Eigen::Array<double, kLanes, 1>;

/// Points on the unit circle.
struct Turns {
  Lanes cosine, sine;

  /// At n · `distance`.
  explicit Turns(double distance) {
    for (int n = 0; n < kLanes; ++n) {
      cosine[n] = std::cos(n * distance);
      sine[n] = std::sin(n * distance);
    }
  }
  [[nodiscard]] Turns turned_by(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    Turns out = *this;
    out.cosine = c * cosine - s * sine;
    out.sine = s * cosine + c * sine;
    return out;
  }
};

/// Horner's rule at all of them together: for one angle each of its steps waits for the one before.
Lanes values_on(const TrigonometricPolynomial& polynomial, const Turns& turns) {
  Lanes re = Lanes::Zero(), im = re, before;
  for (Eigen::Index k = polynomial.phasors.size() - 1; k > 0; --k) {
    before = re + polynomial.phasors[k].real();
    im += polynomial.phasors[k].imag();
    re = before * turns.cosine - im * turns.sine;
    im = before * turns.sine + im * turns.cosine;
  }
  return re + polynomial.phasors[0].real();
}

class ZeroSearch {
 public:
  explicit ZeroSearch(const TrigonometricPolynomial& polynomial) : polynomial_(polynomial) {
    for (Eigen::Index k = 1; k < polynomial.phasors.size(); ++k)
      curvature_ += static_cast<double>(k * k) * std::abs(polynomial.phasors[k]);
  }

  /// @param centre  value and slope in the middle
  void search(double low, double at_low, double high, double at_high, const TrigonometricPolynomial::Value& centre) {
    const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
    const auto [y, slope] = centre;
    if (std::abs(y) > std::abs(slope) * half + 0.5 * curvature_ * half * half) return;
    if (std::abs(slope) > curvature_ * half || half < 0.5 * kNarrowest) {
      if ((at_low < 0.0) != (at_high < 0.0)) found.push_back(zero_between(polynomial_, low, at_low < 0.0, high));
      return;
    }
    search(low, at_low, middle, y, polynomial_.at(0.5 * (low + middle)));
    search(middle, y, high, at_high, polynomial_.at(0.5 * (middle + high)));
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
  constexpr double kDistance = 2.0 * std::numbers::pi / kLanes;
  static const Turns turns(kDistance);
  const Lanes y = values_on(polynomial, turns), slope = values_on(derivative(polynomial), turns);
  ZeroSearch search(polynomial);
  for (int n = 0; n < kLanes; n += 2)
    search.search(kDistance * n, y[n], kDistance * (n + 2), y[(n + 2) % kLanes], {y[n + 1], slope[n + 1]});
  return std::move(search.found);
}

Eigen::RowVectorXd values_around(const TrigonometricPolynomial& y, double first, int points) {
  const double distance = 2.0 * std::numbers::pi / points;
  const Turns turns(distance);
  Eigen::RowVectorXd out(points);
  for (int begin = 0; begin < points; begin += kLanes) {
    const Lanes here = values_on(y, turns.turned_by(first + begin * distance));
    const int count = std::min(kLanes, points - begin);
    out.segment(begin, count) = here.head(count).matrix().transpose();
  }
  return out;
}

}  // namespace slipmode::orbits
