#include <slipmode/friction/measured.hpp>

#include <slipmode/friction/characteristic.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>

namespace slipmode::friction {
namespace {

/// The monotone cubic through a law's points.
class Curve {
 public:
  explicit Curve(const Measured& law) : v_(law.speeds), mu_(law.coefficients), slopes_(v_.size(), 0.0) {
    slopes_.front() = secant(0);
    for (std::size_t k = 1; k + 1 < v_.size(); ++k) {
      const double before = secant(k - 1), after = secant(k);
      if (!(before * after > 0.0)) continue;
      const double h0 = v_[k] - v_[k - 1], h1 = v_[k + 1] - v_[k];
      slopes_[k] = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / before + (h1 + 2.0 * h0) / after);
    }
  }

  [[nodiscard]] double value(double speed) const {
    if (speed >= v_.back()) return mu_.back();
    if (speed <= 0.0) return mu_.front() + slopes_.front() * speed;
    const std::size_t k = interval(speed);
    const double h = v_[k + 1] - v_[k], s = (speed - v_[k]) / h, r = 1.0 - s;
    return r * r * ((1.0 + 2.0 * s) * mu_[k] + s * h * slopes_[k]) +
           s * s * ((1.0 + 2.0 * r) * mu_[k + 1] - r * h * slopes_[k + 1]);
  }

  [[nodiscard]] double slope(double speed) const {
    if (speed >= v_.back()) return 0.0;
    if (speed <= 0.0) return slopes_.front();
    const std::size_t k = interval(speed);
    const double s = (speed - v_[k]) / (v_[k + 1] - v_[k]), r = 1.0 - s;
    return 6.0 * r * s * secant(k) + r * (1.0 - 3.0 * s) * slopes_[k] + s * (1.0 - 3.0 * r) * slopes_[k + 1];
  }

  /// Over the points' intervals that have a share in [from, to].
  [[nodiscard]] LawBounds bounds(double from, double to) const {
    LawBounds most;
    if (from < 0.0) most.slope = std::abs(slopes_.front());
    for (std::size_t k = 0; k + 1 < v_.size(); ++k) {
      if (v_[k] > to || v_[k + 1] < from) continue;
      // The slope's Bernstein coefficients, and what is between them.
      const double a = slopes_[k], c = slopes_[k + 1], b = 3.0 * secant(k) - a - c;
      most.slope = std::max({most.slope, std::abs(a), std::abs(b), std::abs(c)});
      most.curve = std::max(most.curve, 2.0 / (v_[k + 1] - v_[k]) * std::max(std::abs(b - a), std::abs(c - b)));
    }
    return most;
  }

 private:
  std::vector<double> v_, mu_, slopes_;

  [[nodiscard]] double secant(std::size_t k) const { return (mu_[k + 1] - mu_[k]) / (v_[k + 1] - v_[k]); }
  [[nodiscard]] std::size_t interval(double speed) const {
    return static_cast<std::size_t>(std::upper_bound(v_.begin(), v_.end() - 1, speed) - v_.begin()) - 1;
  }
};

}  // namespace

double Measured::kinetic_coefficient(double speed) const { return Curve(*this).value(speed); }

double Measured::fastest_rate(const Pace& pace) const {
  const auto [least, most] = std::ranges::minmax(coefficients);
  const double steepest = Curve(*this).bounds(0.0, speeds.back()).slope;
  return steepest * pace.load * pace.mobility + (most > least ? steepest / (most - least) : 0.0) * pace.acceleration;
}

ContactForces Measured::forces(double normal_load) const {
  const auto curve = std::make_shared<const Curve>(*this);
  return Characteristic{.mu_s = mu_s,
                        .mu = [curve](double speed) { return curve->value(speed); },
                        .slope = [curve](double speed) { return curve->slope(speed); },
                        .bounds = [curve](double from, double to) { return curve->bounds(from, to); },
                        .most = std::ranges::max(coefficients)}
      .forces(normal_load);
}

std::optional<LawFault> fault_of(const Measured& law) {
  constexpr double kRounding = 1e-12;
  const std::vector<double>&v = law.speeds, &mu = law.coefficients;
  if (v.size() < 2 || v.front() != 0.0) {
    return LawFault{"speeds", v.empty() ? "none" : fmt::format("{} from {} m/s", v.size(), v.front()),
                    "two or more, the first 0"};
  }
  const auto back = std::ranges::adjacent_find(v, std::ranges::greater_equal());
  if (back != v.end())
    return LawFault{"speeds", fmt::format("{} m/s before {}", back[0], back[1]), "speeds that ascend"};
  if (mu.size() != v.size()) {
    return LawFault{"coefficients", fmt::format("{} for {} speeds", mu.size(), v.size()), "one per speed"};
  }
  if (law.mu_s < mu.front() * (1.0 - kRounding)) {
    return LawFault{"mu_s", fmt::format("{}, less than the first coefficient, {}", law.mu_s, mu.front()),
                    "at least that (static friction holds at least as much as sliding friction)"};
  }
  return std::nullopt;
}

}  // namespace slipmode::friction
