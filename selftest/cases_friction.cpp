// Coefficients, decay of Stribeck's law, stiffness of contacts, speed of the belt.
#include "selftest/cases.hpp"
#include "selftest/small_systems.hpp"

#include <algorithm>
#include <numbers>

namespace slipmode::selftest {
namespace {

using dynamics::EventKind;
using friction::Belt;
using friction::CompliantCoulomb;
using friction::Coulomb;
using friction::Shaker;
using friction::Stribeck;

/// Samples of one mass's displacement.
Eigen::VectorXd motion(const dynamics::HybridSystem& system, const dynamics::State& start, double duration) {
  return dynamics::simulate(system, start,
                            {.duration = duration, .sample = duration / 400.0, .flow = {.tolerance = 1e-12}})
      .q.row(0);
}

double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// Without friction the belt's speed does not matter, to the last bit.
double frictionless() {
  const auto run = [](double belt) {
    return motion(one_mass(Coulomb{0.0, 0.0}, Belt::constant(belt), 0.01), state_of(1.0, 0.2), 50.0);
  };
  return distance(run(0.0), run(123.0));
}

/// μ_s = μ_k: no jump, the mass leaves the stick into q = μ N/k + (V/ω) sin ω(t − t₀), which never sticks again.
double equal_coefficients() {
  const double mu = 0.3, V = 0.2;
  const auto run = dynamics::simulate(one_mass(Coulomb{mu, mu}, Belt::constant(V)), state_of(0.0, V),
                                      {.duration = 20.0, .sample = 0.05});
  double worst = 0.0;
  for (Eigen::Index k = 0; k < run.times.size(); ++k) {
    const double t = run.times(k), t0 = mu / V;
    worst = std::max(worst, std::abs(run.q(0, k) - (t < t0 ? V * t : mu + V * std::sin(t - t0))));
  }
  return worst;
}

/// μ_s = 10⁶ μ_k: released at μ_s N/k the mass turns at 2 μ_k − that, and returns to the belt's speed where it began.
double unequal_coefficients() {
  const Coulomb law{2e5, 0.2};
  const double V = 1.0, drop = law.mu_s - law.mu_k;
  const auto run = dynamics::simulate(one_mass(law, Belt::constant(V)), state_of(law.mu_s, V), {.duration = 20.0});
  double released = 0.0;
  for (const auto& e : run.events) {
    if (e.kind == EventKind::kRelease) released = e.time;
    if (e.kind == EventKind::kStick) {
      const double slip = std::numbers::pi + 2.0 * std::atan2(V, drop);
      return std::abs(e.time - released - slip) / slip;
    }
  }
  return 1.0;
}

/// Distance of Stribeck's law from a Coulomb law over two stick-slip cycles.
double stribeck_distance(double alpha, const Coulomb& limit) {
  const auto run = [](const friction::Law& law) {
    return motion(one_mass(law, Belt::constant(0.3), 0.05), state_of(0.0, 0.3), 12.0);
  };
  return distance(run(Stribeck{0.4, 0.2, alpha}), run(limit));
}

double order(double coarse, double fine, double ratio) { return std::log(coarse / fine) / std::log(ratio); }

/// Distance of a mass behind a contact spring from the rigid contact, shaken.
double compliant_distance(double stiffness, double mu, double amplitude) {
  const Shaker shaker{.amplitude = amplitude, .frequency_hz = 1.7 / (2.0 * std::numbers::pi)};
  const auto run = [&](const friction::Law& law) {
    return motion(one_mass(law, shaker, 0.05), state_of(0.0, shaker.velocity(0.0)), 12.0);
  };
  return distance(run(CompliantCoulomb{1.2 * mu, mu, stiffness}), run(Coulomb{1.2 * mu, mu}));
}

/// On a belt at rest amplitudes fall by 2 μ_k N/k each half cycle, until μ_s N/k holds.
double belt_at_rest() {
  const auto run =
      dynamics::simulate(one_mass(Coulomb{0.4, 0.2}, Belt::constant(0.0)), state_of(10.1, 0.0), {.duration = 200.0});
  double amplitude = 10.1, sign = 1.0;
  while (amplitude > 0.4) {
    amplitude -= 0.4;
    sign = -sign;
  }
  return std::abs(run.final_state.q(0) - sign * amplitude);
}

double slow_belt(double speed) {
  const auto run = dynamics::simulate(one_mass(Coulomb{0.4, 0.2}, Belt::constant(speed), 0.1, 0.01),
                                      state_of(0.0, speed), {.duration = 0.005 / speed});
  for (const auto& e : run.events) {
    // k q + c V = μ_s N at release, q = V t, N = 0.01.
    const double expected = (0.4 * 0.01 - 0.1 * speed) / speed;
    if (e.kind == EventKind::kRelease) return std::abs(e.time - expected) / expected;
  }
  return 1.0;
}

/// Always sliding: harmonic about μ_k N/k.
double fast_belt(double speed) {
  const auto run = dynamics::simulate(one_mass(Coulomb{0.4, 0.2}, Belt::constant(speed)), state_of(0.0, 0.0),
                                      {.duration = 100.0, .sample = 0.5});
  double worst = run.events.empty() ? 0.0 : 1.0;
  for (Eigen::Index k = 0; k < run.times.size(); ++k)
    worst = std::max(worst, std::abs(run.q(0, k) - 0.2 * (1.0 - std::cos(run.times(k)))));
  return worst;
}

}  // namespace

std::vector<ExtremeCase> friction_cases() {
  return {
      {"mu = 0", "motion on a belt at rest and at speed 123, difference", 0.0, frictionless},
      {"mu_s = mu_k", "motion beside q = mu N/k + V sin", 1e-12, equal_coefficients},
      {"mu_s = 1e6 mu_k", "time of a slip beside its closed form, relative", 1e-12, unequal_coefficients},
      {"Stribeck, alpha to 0", "distance of the order in alpha from 1, to Coulomb with mu_s", 0.05,
       [] {
         return std::abs(order(stribeck_distance(1e-4, {0.4, 0.4}), stribeck_distance(1e-6, {0.4, 0.4}), 100.0) - 1.0);
       }},
      {"Stribeck, alpha to 1e5", "distance of the order in 1/alpha from 1 (log alpha/alpha), to Coulomb", 0.2,
       [] {
         return std::abs(order(stribeck_distance(1e3, {0.4, 0.2}), stribeck_distance(1e5, {0.4, 0.2}), 100.0) - 1.0);
       }},
      {"contact spring 1e4 to 1e8, stuck", "distance of the order in 1/K_c from 1", 0.05,
       [] {
         return std::abs(order(compliant_distance(1e4, 100.0, 0.8), compliant_distance(1e8, 100.0, 0.8), 1e4) - 1.0);
       }},
      {"contact spring 1e4 to 1e8, sliding", "distance of the order in 1/K_c from 1/2", 0.1,
       [] { return std::abs(order(compliant_distance(1e4, 0.3, 5.0), compliant_distance(1e8, 0.3, 5.0), 1e4) - 0.5); }},
      {"contact spring 1e2", "distance from the rigid contact, sliding", 1.0,
       [] { return compliant_distance(1e2, 0.3, 5.0); }},
      {"contact spring 1e12", "distance from the rigid contact, sliding", 1e-4,
       [] { return compliant_distance(1e12, 0.3, 5.0); }},
      {"belt speed 0", "place of rest beside its closed form", 1e-12, belt_at_rest},
      {"belt speed 1e-9", "time of release beside its closed form, relative", 1e-12, [] { return slow_belt(1e-9); }},
      {"belt speed 1e9", "motion beside the harmonic one", 1e-12, [] { return fast_belt(1e9); }},
  };
}

}  // namespace slipmode::selftest
