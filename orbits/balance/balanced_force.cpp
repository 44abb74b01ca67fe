#include "orbits/balance/internal/balanced_force.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
constexpr double kCircle = 2.0 * std::numbers::pi;

/// Where one stop presses, as the moments that coefficients are made of.
struct Occupation {
  Eigen::VectorXcd set;  ///< g_m, m = 0 … 2H
  Eigen::VectorXcd
      jumps;  ///< Σ_s ±e^{imθ_s}/2π over instants at which the force jumps: + where it is let go, − reached
  int switches = 0;
};

/// One stop with its law. @param side  +1 right, −1 left
struct StopLaw {
  friction::Stop stop;
  friction::ContactLoss loss;
  double side, omega;

  /// Depth beyond the gap, and what it presses with.
  [[nodiscard]] double depth(double y) const { return side * y - stop.gap; }
  [[nodiscard]] double press(const TrigonometricPolynomial::Value& v) const {
    return stop.stiffness * depth(v.y) + stop.damping * omega * side * v.slope;
  }
  [[nodiscard]] bool lets_go_early() const { return loss == friction::ContactLoss::kZeroForce && stop.damping > 0.0; }
  [[nodiscard]] bool presses(const TrigonometricPolynomial::Value& v) const {
    return depth(v.y) > 0.0 && (!lets_go_early() || press(v) > 0.0);
  }
};

template <class Visit>
void for_each_stop(const friction::Clearance& law, double omega, const Visit& visit) {
  if (law.left) visit(StopLaw{*law.left, law.loss, -1.0, omega});
  if (law.right) visit(StopLaw{*law.right, law.loss, 1.0, omega});
}

/// A stop's switches, and whether it presses before the first.
struct OwnSwitches {
  bool pressed = false;
  std::vector<StopSwitch> switches;
};

OwnSwitches switches_of(const StopLaw& law, const TrigonometricPolynomial& y) {
  const Eigen::Index H = y.phasors.size() - 1;
  TrigonometricPolynomial guard = y;  // side y − b
  guard.phasors *= law.side;
  guard.phasors[0] -= law.stop.gap;
  struct Border {
    double theta;
    bool at_gap;
  };
  std::vector<Border> borders;
  for (const double theta : zeros(guard)) borders.push_back({theta, true});
  if (borders.empty() && law.depth(y.at(0.0).y) <= 0.0) return {};  // never reached
  if (law.lets_go_early()) {
    TrigonometricPolynomial force = guard;
    for (Eigen::Index k = 0; k <= H; ++k)
      force.phasors[k] *= Complex(law.stop.stiffness, law.stop.damping * law.omega * static_cast<double>(k));
    for (const double theta : zeros(force)) borders.push_back({theta, false});
  }
  if (borders.empty()) return {law.presses(y.at(0.0)), {}};
  std::ranges::sort(borders, {}, &Border::theta);
  const std::size_t count = borders.size();
  const auto after = [&](std::size_t i) {
    const double next = i + 1 < count ? borders[i + 1].theta : borders[0].theta + kCircle;
    return law.presses(y.at(0.5 * (borders[i].theta + next)));
  };
  OwnSwitches out{after(count - 1), {}};
  bool before = out.pressed;
  for (std::size_t i = 0; i < count; ++i) {
    const bool now = after(i);
    if (now != before)
      out.switches.push_back(
          {borders[i].theta, law.side < 0 ? -1 : 1, now, borders[i].at_gap && law.stop.damping > 0.0});
    before = now;
  }
  return out;
}

/// @param moments  of the set and the jumps
Occupation exact_occupation(const StopLaw& law, const TrigonometricPolynomial& y, Eigen::Index moments) {
  Occupation out{Eigen::VectorXcd::Zero(moments + 1), Eigen::VectorXcd::Zero(moments + 1), 0};
  const OwnSwitches own = switches_of(law, y);
  out.switches = static_cast<int>(own.switches.size());
  if (own.pressed) out.set[0] = 1.0;
  for (const StopSwitch& at : own.switches) {
    const double sign = at.pressed ? -1.0 : 1.0;
    out.set[0] += sign * at.theta / kCircle;
    const Complex turn = std::polar(1.0, at.theta);
    Complex power = 1.0;
    for (Eigen::Index m = 0; m <= moments; ++m, power *= turn) {
      if (m > 0) out.set[m] += sign * power / Complex(0.0, kCircle * static_cast<double>(m));
      if (at.jumps) out.jumps[m] += sign / kCircle * power;
    }
  }
  return out;
}

Occupation sampled_occupation(const StopLaw& law, const TrigonometricPolynomial& y, int samples) {
  const Eigen::Index H = y.phasors.size() - 1, N = samples;
  Occupation out{Eigen::VectorXcd::Zero(2 * H + 1), Eigen::VectorXcd::Zero(2 * H + 1), 0};
  std::vector<Complex> turns;
  for (Eigen::Index n = 0; n < N; ++n)
    turns.push_back(std::polar(1.0, kCircle * static_cast<double>(n) / static_cast<double>(N)));
  bool before = law.presses(y.at(kCircle * static_cast<double>(N - 1) / static_cast<double>(N)));
  for (Eigen::Index n = 0; n < N; ++n) {
    const bool now = law.presses(y.at(kCircle * static_cast<double>(n) / static_cast<double>(N)));
    out.switches += now != before;
    before = now;
    if (!now) continue;
    for (Eigen::Index m = 0; m <= 2 * H; ++m)
      out.set[m] += turns[static_cast<std::size_t>(m * n % N)] / static_cast<double>(N);
  }
  return out;
}

/// Adds one stop's share.
void add_stop(const StopLaw& law, const TrigonometricPolynomial& y, const Occupation& where, BalancedForce& out) {
  if (where.set[0] == 0.0) return;
  const Eigen::Index H = y.phasors.size() - 1, L = (out.jacobian.rows() - 1) / 2;
  const auto moment = [](const Eigen::VectorXcd& of, Eigen::Index m) { return m < 0 ? std::conj(of[-m]) : of[m]; };
  const auto coefficient = [&](Eigen::Index k) {  // double-sided
    return k == 0 ? y.phasors[0] : k > 0 ? 0.5 * y.phasors[k] : 0.5 * std::conj(y.phasors[-k]);
  };
  for (Eigen::Index j = 0; j <= H; ++j) {
    const double twice = j == 0 ? 1.0 : 2.0;
    Complex force = law.side * law.stop.stiffness * law.stop.gap * moment(where.set, -j);
    for (Eigen::Index k = 0; k <= H; ++k) {
      const Complex gain(-law.stop.stiffness, -law.stop.damping * law.omega * static_cast<double>(k));
      const Complex plus_set = gain * moment(where.set, k - j), minus_set = std::conj(gain) * moment(where.set, -k - j);
      force += plus_set * coefficient(k);
      if (k > 0) force += minus_set * coefficient(-k);
      if (j > L || k > L) continue;
      const double jump = law.stop.damping * law.omega;
      const Complex plus = twice * (plus_set + jump * moment(where.jumps, k - j)),
                    minus = twice * (minus_set + jump * moment(where.jumps, -k - j));
      // By cosine_k and sine_k: ŷ_{±k} = (cosine ∓ i sine)/2.
      const Complex by_cosine = k == 0 ? plus : 0.5 * (plus + minus), by_sine = Complex(0.0, -0.5) * (plus - minus);
      out.jacobian(j, k) += by_cosine.real();
      if (j > 0) out.jacobian(L + j, k) -= by_cosine.imag();
      if (k > 0) out.jacobian(j, L + k) += by_sine.real();
      if (j > 0 && k > 0) out.jacobian(L + j, L + k) -= by_sine.imag();
    }
    out.phasors[j] += twice * (j == 0 ? Complex(force.real()) : force);
  }
}

}  // namespace

StopSwitches stop_switches(const friction::Clearance& law, const TrigonometricPolynomial& y, double omega) {
  StopSwitches out;
  for_each_stop(law, omega, [&](const StopLaw& own) {
    OwnSwitches found = switches_of(own, y);
    if (found.pressed) out.side = own.side < 0 ? -1 : 1;
    out.switches.insert(out.switches.end(), found.switches.begin(), found.switches.end());
  });
  std::ranges::sort(out.switches, {}, &StopSwitch::theta);
  return out;
}

StopTangent stop_tangent(const friction::Clearance& law, const TrigonometricPolynomial& y, double omega,
                         Eigen::Index moments, bool jumps) {
  StopTangent out{Eigen::VectorXcd::Zero(moments + 1), Eigen::VectorXcd::Zero(moments + 1)};
  for_each_stop(law, omega, [&](const StopLaw& own) {
    const Occupation where = exact_occupation(own, y, moments);
    out.stiffness -= own.stop.stiffness * where.set;
    if (jumps) out.stiffness += own.stop.damping * omega * where.jumps;
    out.damping -= own.stop.damping * where.set;
  });
  return out;
}

BalancedForce balanced_force(const friction::Clearance& law, const TrigonometricPolynomial& y, double omega,
                             int samples, Eigen::Index lead) {
  const Eigen::Index H = y.phasors.size() - 1;
  BalancedForce out{Eigen::VectorXcd::Zero(H + 1), Eigen::MatrixXd::Zero(2 * lead + 1, 2 * lead + 1), 0};
  for_each_stop(law, omega, [&](const StopLaw& own) {
    const Occupation where = samples == kExact ? exact_occupation(own, y, 2 * H) : sampled_occupation(own, y, samples);
    add_stop(own, y, where, out);
    out.switches += where.switches;
  });
  return out;
}

}  // namespace slipmode::orbits
