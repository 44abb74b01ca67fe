#include "orbits/balance/internal/clearance_balance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
using dynamics::ContactMode;
constexpr double kCircle = 2.0 * std::numbers::pi;

/// An instant at which a stop begins to press, or lets go.
struct StopSwitch {
  double theta = 0.0;
  bool pressed = false;  ///< after it
  bool jumps = false;    ///< the force does, by ∓ c ẏ: a damped stop that is reached, or let go at its gap
};

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
    if (now != before) out.switches.push_back({borders[i].theta, now, borders[i].at_gap && law.stop.damping > 0.0});
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
      if (m > 0) out.set[m] += Complex(0.0, -sign / (kCircle * static_cast<double>(m))) * power;
      if (at.jumps) out.jumps[m] += sign / kCircle * power;
    }
  }
  return out;
}

Occupation sampled_occupation(const StopLaw& law, const TrigonometricPolynomial& y, int samples) {
  const Eigen::Index H = y.phasors.size() - 1, N = samples;
  Occupation out{Eigen::VectorXcd::Zero(2 * H + 1), Eigen::VectorXcd::Zero(2 * H + 1), 0};
  const std::vector<Complex> turns = sample_turns(samples);
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

ContactMode mode_at(double side) { return side < 0.0 ? ContactMode::kLeftStop : ContactMode::kRightStop; }

}  // namespace

ForceTangent BalancedClearance::tangent(const TrigonometricPolynomial& y, double omega, Eigen::Index moments,
                                        bool jumps) const {
  ForceTangent out{Eigen::VectorXcd::Zero(moments + 1), Eigen::VectorXcd::Zero(moments + 1)};
  for_each_stop(law, omega, [&](const StopLaw& own) {
    const Occupation where = exact_occupation(own, y, moments);
    out.stiffness -= own.stop.stiffness * where.set;
    if (jumps) out.stiffness += own.stop.damping * omega * where.jumps;
    out.damping -= own.stop.damping * where.set;
  });
  return out;
}

BalancedClearance BalancedClearance::at_share(double share) const {
  BalancedClearance out = *this;
  if (out.law.left) out.law.left->gap *= share;
  if (out.law.right) out.law.right->gap *= share;
  return out;
}

BalancedForce BalancedClearance::force(const TrigonometricPolynomial& y, double omega, int samples,
                                       const Orders& leading) const {
  const Eigen::Index H = y.phasors.size() - 1;
  BalancedForce out(H, leading);
  for_each_stop(law, omega, [&](const StopLaw& own) {
    const Occupation where = samples == kExact ? exact_occupation(own, y, 2 * H) : sampled_occupation(own, y, samples);
    add_linear(y,
               {.stiffness = own.stop.stiffness,
                .damping = own.stop.damping * omega,
                .constant = own.side * own.stop.stiffness * own.stop.gap,
                .set = where.set,
                .jumps = where.jumps},
               out);
    out.switches += where.switches;
  });
  return out;
}

Passage BalancedClearance::passage(const TrigonometricPolynomial& y, double omega) const {
  Passage out{ContactMode::kGap, {}};
  for_each_stop(law, omega, [&](const StopLaw& own) {
    const OwnSwitches found = switches_of(own, y);
    if (found.pressed) out.first = mode_at(own.side);
    for (const StopSwitch& at : found.switches)
      out.switches.push_back({at.theta, at.pressed ? mode_at(own.side) : ContactMode::kGap});
  });
  std::ranges::sort(out.switches, {}, &Passage::Switch::theta);
  return out;
}

std::complex<double> BalancedClearance::impedance(double omega) const {
  Complex out = 0.0;
  for (const friction::Stop& stop : law.stops()) out += 0.5 * Complex(stop.stiffness, omega * stop.damping);
  return out;
}

double BalancedClearance::strongest(double omega) const {
  double most = 0.0;
  for (const friction::Stop& stop : law.stops())
    most = std::max(most, std::hypot(stop.stiffness, omega * stop.damping));
  return most;
}

}  // namespace slipmode::orbits
