#include "bench/orbit_cases.hpp"

#include <slipmode/orbits/shooting.hpp>
#include "bench/clock.hpp"
#include "bench/orbit_peer.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::bench {
namespace {

/// Periods simulated from (3, 0) before shooting.
constexpr double kSettle = 3.0;

dynamics::HybridSystem backlash(const BacklashMass& m) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const friction::Stop stop{m.stop_stiffness, m.stop_damping, m.gap};
  return {fem::Structure(fem::Matrix(one), fem::Matrix(Eigen::MatrixXd(m.damping * one)),
                         fem::Matrix(Eigen::MatrixXd(0.0 * one))),
          {friction::Contact{.direction = Eigen::VectorXd::Ones(1), .law = friction::Clearance{stop, stop}}},
          friction::Force{m.omega, {{.amplitude = m.amplitude}}},
          {},
          one};
}

}  // namespace

Row measure_orbits(bool quick) {
  Row row;
  row.lines.push_back(fmt::format("{:>10} {:>8} {:>12} {:>12} {:>8} {:>8} {:>6} {:>6} {:>12} {:>12} {:>12}", "orbit at",
                                  "CVODE", "slipmode us", "CVODE us", "ratio", "wanted", "steps", "its", "residual",
                                  "its residual", "apart"));
  for (const double omega : {0.65, 0.4, 0.1}) {
    const BacklashMass mass{.omega = omega};
    const dynamics::HybridSystem system = backlash(mass);
    dynamics::State start = system.rest();
    start.q(0) = 3.0;
    const dynamics::State guess = orbits::settle_guess(system, start, kSettle);
    const Eigen::Vector2d guess_vector(guess.q(0), guess.v(0));
    for (const double tolerance : {1e-10, 1e-12}) {
      orbits::PeriodicOrbit own = orbits::find_orbit(system, guess);
      PeerOrbit peer = shoot_with_cvode(mass, guess_vector, tolerance);
      const double ours = median_seconds(quick ? 201 : 2001, [&] { own = orbits::find_orbit(system, guess); });
      const double theirs =
          median_seconds(quick ? 5 : 51, [&] { peer = shoot_with_cvode(mass, guess_vector, tolerance); });
      // The peer starts at phase 0; slipmode may have moved its origin off a guard.
      const double to_phase = own.period - std::fmod(own.start.time, own.period);
      const dynamics::State at = orbits::advanced(system, own.start, to_phase);
      const double apart = std::hypot(at.q(0) - peer.start(0), at.v(0) - peer.start(1));
      row.lines.push_back(
          fmt::format("{:>10} {:>8.0e} {:>12.1f} {:>12.0f} {:>8.0f} {:>8} {:>6} {:>6} {:>12.1e} {:>12.1e} {:>12.1e}",
                      omega, tolerance, 1e6 * ours, 1e6 * theirs, theirs / ours, 100, own.iterations, peer.iterations,
                      own.residual, peer.residual, apart));
      const std::string name = fmt::format("omega_{}_cvode_{:.0e}", omega, tolerance);
      row.figures.emplace_back(name + "_slipmode_us", 1e6 * ours);
      row.figures.emplace_back(name + "_cvode_us", 1e6 * theirs);
      row.figures.emplace_back(name + "_ratio", theirs / ours);
      row.timed.push_back({.name = fmt::format("orbit {} CVODE {:.0e}", omega, tolerance),
                           .ms = 1e3 * ours,
                           .ratio_cvode = theirs / ours});
    }
  }
  return row;
}

}  // namespace slipmode::bench
