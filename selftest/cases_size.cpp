// Sizes of structures, and damping from none to huge.
#include <slipmode/fem/beam.hpp>
#include <slipmode/fem/modes.hpp>
#include "selftest/cases.hpp"
#include "selftest/small_systems.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace slipmode::selftest {
namespace {

using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

/// Undamped mass on a belt, μ_s > μ_k: slip (π + 2φ)/ω with tan φ = V/(ω d), stick 2 d/V, d = (μ_s − μ_k) N/k.
double stick_slip_period(double drop, double belt) {
  return std::numbers::pi + 2.0 * std::atan2(belt, drop) + 2.0 * drop / belt;
}

/// Relative error of the time from release to release.
double period_error(const Coulomb& law, double belt) {
  const double period = stick_slip_period(law.mu_s - law.mu_k, belt);
  const auto run =
      dynamics::simulate(one_mass(law, Belt::constant(belt)), state_of(law.mu_s, belt), {.duration = 3.2 * period});
  std::vector<double> releases;
  for (const auto& e : run.events)
    if (e.kind == dynamics::EventKind::kRelease) releases.push_back(e.time);
  if (releases.size() < 3) return 1.0;
  return std::abs(releases[2] - releases[1] - period) / period;
}

/// How far the contact of a long chain is from that of a hundred masses before a wave is back from the far end.
double long_chain_distance(int masses) {
  const auto motion = [](int n) {
    const auto chain = uniform_chain(n, Stribeck{0.4, 0.2, 8.0}, 0.2, 0.006, {0.25});
    return dynamics::simulate(chain, chain.rest(),
                              {.duration = 30.0,
                               .sample = 0.5,
                               .output = dynamics::SimulateOptions::Output::kContacts,
                               .flow = {.tolerance = 1e-12}})
        .contact_q;
  };
  return (motion(masses) - motion(100)).cwiseAbs().maxCoeff();
}

/// Relative error of mode `mode` of a uniform cantilever, βL = 1.87510407, 4.69409113 (Blevins 1979, table 8-1; the
/// digits here solve cos βL cosh βL = −1).
double beam_error(int elements, Eigen::Index mode = 0) {
  static constexpr std::array<double, 2> kRoots = {1.8751040687119611, 4.6940911329741746};
  fem::BeamOptions options;  // EI = ρA = 1
  options.spans = {
      {.length = 1.0, .width = 0.1, .thickness = 0.1, .youngs_modulus = 12e4, .density = 100.0, .elements = elements}};
  const fem::Beam beam(options);
  const double omega = fem::natural_modes(beam.structure(), 2).omega(mode);
  const double root = kRoots[static_cast<std::size_t>(mode)];
  return std::abs(omega / (root * root) - 1.0);
}

/// Largest distance of one mass, let go at x = 1 with ẋ = −0.3, from x(t); no friction.
template <class Expected>
double free_motion_error(double dashpot, double duration, const Expected& expected) {
  const auto run = dynamics::simulate(one_mass(Coulomb{0.0, 0.0}, Belt::constant(9.0), dashpot), state_of(1.0, -0.3),
                                      {.duration = duration, .sample = duration / 64.0});
  double worst = 0.0;
  for (Eigen::Index k = 0; k < run.times.size(); ++k)
    worst = std::max(worst, std::abs(run.q(0, k) - expected(run.times(k))));
  return worst;
}

double overdamped_error(double dashpot, double duration) {
  const double root = std::sqrt(dashpot * dashpot / 4.0 - 1.0), fast = -dashpot / 2.0 - root, slow = 1.0 / fast;
  const double b = (-0.3 - slow) / (fast - slow), a = 1.0 - b;
  return free_motion_error(dashpot, duration,
                           [&](double t) { return a * std::exp(slow * t) + b * std::exp(fast * t); });
}

double undamped_drift() {
  dynamics::State start{0.0, Eigen::VectorXd::LinSpaced(10, 0.1, 1.0), Eigen::VectorXd::LinSpaced(10, 1.0, -0.5)};
  const auto chain = uniform_chain(10, Coulomb{0.0, 0.0}, 0.2, 0.0);
  const auto run = dynamics::simulate(chain, start, {.duration = 1e5});
  const double energy = chain.energy(start);
  return std::abs(chain.energy(run.final_state) - energy) / energy;
}

double two_mass_error() {
  const Eigen::VectorXd omega = fem::natural_modes(fem::chain({.masses = 2, .right_fixed = true})).omega;
  return std::max(std::abs(omega(0) - 1.0), std::abs(omega(1) - std::numbers::sqrt3));
}

double audit_of_ten() {
  const auto chain = uniform_chain(10, Stribeck{0.4, 0.2, 8.0}, 0.2);
  return std::abs(dynamics::simulate(chain, chain.rest(), {.duration = 2e4}).audit.residual());
}

}  // namespace

std::vector<ExtremeCase> size_cases() {
  const char* wave = "contact beside that of 100 masses, until the far end is felt";
  const char* frequency = "first frequency beside its transcendental equation, relative";
  const char* digits = "first frequency: rounding grows as n^4 (limit: eps n^4), relative";
  return {
      {"1 mass", "stick-slip period beside its closed form, relative", 1e-12,
       [] {
         return period_error({0.4, 0.2}, 0.1);
       }},
      {"2 masses", "frequencies 1 and √3 between walls", 1e-14, two_mass_error},
      {"10 masses", "energy audit over 2e4 units, Stribeck", 1e-9, audit_of_ten},
      {"1,000 masses", wave, 1e-9, [] { return long_chain_distance(1000); }},
      {"10,000 masses", wave, 1e-9, [] { return long_chain_distance(10000); }},
      {"2 beam elements", frequency, 1e-3, [] { return beam_error(2); }},
      {"2, 4, 8 elements", "distance of the order of convergence from 4, second mode", 0.2,
       [] { return std::abs(std::log2(beam_error(4, 1) / beam_error(8, 1)) - 4.0); }},
      {"200 elements", digits, 3.6e-7, [] { return beam_error(200); }},
      {"2,000 elements", digits, 3.6e-3, [] { return beam_error(2000); }},
      {"damping 0", "drift of energy over 1e5 units, ten masses, relative", 1e-12, undamped_drift},
      {"damping critical", "free motion beside (1 + 0.7 t) e^-t", 1e-14,
       [] { return free_motion_error(2.0, 8.0, [](double t) { return (1.0 + 0.7 * t) * std::exp(-t); }); }},
      {"damping 100 times critical", "free motion beside its two exponentials", 1e-12,
       [] { return overdamped_error(200.0, 600.0); }},
      {"damping 5e5 times critical", "free motion beside its two exponentials", 1e-12,
       [] { return overdamped_error(1e6, 0.1); }},
  };
}

}  // namespace slipmode::selftest
