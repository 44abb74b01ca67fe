#include "orbits/balance/internal/balance_orbit.hpp"
#include "orbits/balance/internal/balanced_law.hpp"

#include <slipmode/orbits/balance/hill.hpp>
#include <slipmode/orbits/floquet.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <algorithm>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;

/// The regimes passed, as an orbit has them.
std::vector<RegimeSpan> balance_regimes(const dynamics::HybridSystem& system, const Balance& balance) {
  struct Switch {
    double theta;
    std::size_t contact;
    ContactMode after;
  };
  std::vector<Switch> switches;
  std::vector<RegimeSpan> out(1);
  const TrigonometricPolynomial d = counterpart_motion(system.drive(), balance.order, balance.harmonics);
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const BalancedLaw law = balanced_law(system.contacts()[c], c);
    const Passage own = passage(law, seen_by(law, polynomial_of(balance.displacement[c]), d), balance.omega);
    out.front().modes.push_back(own.first);
    for (const Passage::Switch& at : own.switches) switches.push_back({at.theta, c, at.after});
  }
  std::ranges::stable_sort(switches, {}, &Switch::theta);
  for (const Switch& at : switches) {
    std::vector<ContactMode> modes = out.back().modes;
    modes[at.contact] = at.after;
    out.push_back({at.theta / balance.omega, std::move(modes)});
  }
  return out;
}

/// The even orders' largest sum of amplitudes, as a share of the odd ones'.
double asymmetry_of(const Balance& balance) {
  double even = 0.0, odd = 0.0;
  for (const Harmonics& y : balance.displacement) {
    const Eigen::VectorXd amplitude = y.amplitude();
    double own_even = 0.0, own_odd = 0.0;
    for (Eigen::Index k = 0; k < amplitude.size(); ++k) (k % 2 == 0 ? own_even : own_odd) += amplitude[k];
    even = std::max(even, own_even);
    odd = std::max(odd, own_odd);
  }
  return odd > 0.0 ? even / odd : even;
}

}  // namespace

PeriodicOrbit in_terms_of_an_orbit(const dynamics::HybridSystem& system, const Balance& balance, double marginal_band,
                                   double symmetry_tolerance) {
  PeriodicOrbit orbit;
  orbit.start = state_of(system, balance);
  orbit.period = 2.0 * std::numbers::pi / balance.omega;
  orbit.order = balance.order;
  orbit.residual = balance.residual;
  orbit.iterations = balance.iterations;
  orbit.crossings = balance.switches;
  orbit.regimes = balance_regimes(system, balance);
  orbit.start.modes = orbit.regimes.front().modes;
  orbit.word = word_of(orbit.regimes);
  if (is_symmetric(system) && balance.order % 2 == 1) {
    orbit.asymmetry = asymmetry_of(balance);
    orbit.symmetric = orbit.asymmetry <= symmetry_tolerance;
  }
  orbit.trivial_multipliers = balance.family ? static_cast<int>(balance.rigid.size()) : 0;
  if (has_memory(system)) {
    orbit.stability = Stability::kUnknown;
    return orbit;
  }
  if (orbit.symmetric) {
    orbit.half_multipliers = hill_multipliers(system, balance, {.half_period = true});
    orbit.multipliers = orbit.half_multipliers.array().square();
  } else {
    orbit.multipliers = hill_multipliers(system, balance);
  }
  set_stability(orbit, marginal_band);
  return orbit;
}

}  // namespace slipmode::orbits
