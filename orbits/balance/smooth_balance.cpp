#include "orbits/balance/internal/smooth_balance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;

constexpr int kMostSamples = 1 << 15;
constexpr double kAlias = 1e-13;  ///< of the force

/// Sums over instants at equal distances around the circle.
class Sampled {
 public:
  /// @param orders   H, of the force's coefficients @param moments  M ≥ H, of f′
  Sampled(const BalancedSmooth& law, const TrigonometricPolynomial& y, double omega, Eigen::Index orders,
          Eigen::Index moments)
      : law_(law),
        speed_(derivative(y)),
        omega_(omega),
        force_(Eigen::VectorXcd::Zero(orders + 1)),
        slope_(Eigen::VectorXcd::Zero(moments + 1)) {}

  void begin(int samples) {
    samples_ = samples;
    add(0.0);
  }
  /// Instants halfway between those there are.
  void halve() {
    add(std::numbers::pi / samples_);
    samples_ *= 2;
  }
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] double largest() const { return largest_; }
  /// Of λ [H + 1].
  [[nodiscard]] Eigen::VectorXcd phasors() const {
    Eigen::VectorXcd out = 2.0 / samples_ * force_.conjugate();
    out[0] *= 0.5;
    return out;
  }
  /// (1/2π) ∫ e^{imθ} f′ dθ [M + 1].
  [[nodiscard]] Eigen::VectorXcd moments() const { return slope_ / samples_; }

 private:
  void add(double first) {
    const Eigen::RowVectorXd speeds = values_around(speed_, first, samples_);
    for (Eigen::Index n = 0; n < speeds.size(); ++n) {
      double slope = 0.0;
      const double here = law_.at(-omega_ * speeds[n], slope);
      largest_ = std::max(largest_, std::abs(here));
      const Complex turn = std::polar(1.0, first + 2.0 * std::numbers::pi * static_cast<double>(n) / samples_);
      Complex power = 1.0;
      for (Eigen::Index m = 0; m < slope_.size(); ++m, power *= turn) {
        slope_[m] += slope * power;
        if (m < force_.size()) force_[m] += here * power;
      }
    }
  }

  const BalancedSmooth& law_;
  TrigonometricPolynomial speed_;  ///< dy/dθ
  double omega_, largest_ = 0.0;
  int samples_ = 0;
  Eigen::VectorXcd force_, slope_;
};

/// @param samples  kExact: as many as the force's coefficients need
Sampled sampled(const BalancedSmooth& law, const TrigonometricPolynomial& y, double omega, int samples,
                Eigen::Index moments) {
  const Eigen::Index H = y.phasors.size() - 1;
  Sampled out(law, y, omega, H, moments);
  if (samples != kExact) {
    out.begin(samples);
    return out;
  }
  out.begin(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max<Eigen::Index>(64, 4 * H)))));
  Eigen::VectorXcd before = out.phasors();
  while (out.samples() < kMostSamples) {
    out.halve();
    const Eigen::VectorXcd now = out.phasors();
    if ((now - before).cwiseAbs().maxCoeff() <= kAlias * out.largest()) break;
    before = now;
  }
  return out;
}

}  // namespace

double BalancedSmooth::at(double v, double& out_slope) const {
  if (share > 0.0) return law.smooth(share * v, out_slope) / share;
  static_cast<void>(law.smooth(0.0, out_slope));
  return out_slope * v;
}

BalancedSmooth BalancedSmooth::at_share(double of_it) const { return {law, of_it}; }

double BalancedSmooth::strongest(double omega) const {
  double slope = 0.0;
  static_cast<void>(law.smooth(0.0, slope));
  return omega * std::abs(slope);
}

BalancedForce BalancedSmooth::force(const TrigonometricPolynomial& y, double omega, int samples,
                                    const Orders& leading) const {
  const Eigen::Index H = y.phasors.size() - 1;
  BalancedForce out(H, leading);
  const Sampled sums = sampled(*this, y, omega, samples, 2 * H);
  // The derivatives are those of a damper that f′ weighs: of what add_linear gives, these alone.
  add_linear(y, {.damping = omega, .set = sums.moments()}, out);
  out.phasors.setZero();
  const Eigen::VectorXcd phasors = sums.phasors();
  const Orders orders = leading.up_to(H);
  for (Eigen::Index a = 0; a < orders.count; ++a) out.phasors[orders.at(a)] = phasors[orders.at(a)];
  return out;
}

ForceTangent BalancedSmooth::tangent(const TrigonometricPolynomial& y, double omega, Eigen::Index moments) const {
  return {Eigen::VectorXcd::Zero(moments + 1), -sampled(*this, y, omega, kExact, moments).moments()};
}

}  // namespace slipmode::orbits
