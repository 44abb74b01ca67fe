// A mass between two stops under a harmonic force: a periodic orbit, its multipliers, and its branch over the
// frequency.
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/branches/continuation.hpp>

#include <cmath>
#include <cstdio>

namespace {

using namespace slipmode;

dynamics::HybridSystem oscillator(double omega) {
  const fem::Structure mass = fem::masses({.mass = {1.0}, .links = {{.first = 0, .second = 1, .damping = 0.05}}});
  const friction::Stop stop{.stiffness = 4.0, .damping = 0.5, .gap = 1.0};
  const friction::Contact play{.direction = Eigen::VectorXd::Ones(1), .law = friction::Clearance{stop, stop}};
  const friction::Force force{.omega = omega, .harmonics = {{.amplitude = 1.0}}};
  return {mass, {play}, force, {}, Eigen::MatrixXd::Ones(1, 1)};
}

}  // namespace

int main() {
  dynamics::State guess = oscillator(1.4).rest();
  guess.q(0) = 2.5;
  const orbits::PeriodicOrbit orbit = orbits::find_orbit(oscillator(1.4), guess);
  std::printf("omega 1.4: period %.6f, multipliers %.4f %.4f\n", orbit.period, orbit.multipliers(0).real(),
              orbit.multipliers(1).real());

  const orbits::Branch branch =
      orbits::continue_orbit(oscillator, orbit, 1.4, {.from = 1.4, .to = 0.6, .direction = -1});
  double breaking = 0.0;
  for (const orbits::SpecialPoint& point : branch.special) {
    std::printf("omega %.6f: %s\n", point.parameter, to_string(point.kind));
    if (point.kind == orbits::SpecialKind::kSymmetryBreaking) breaking = point.parameter;
  }

  // Besselink, Table 4.1, orbit C: 0.6086 and 0.3085; text to Figure 4.2: the symmetric orbit is unstable below 0.7.
  const bool as_printed =
      std::abs(orbit.multipliers(0) - 0.6086) < 1e-4 && std::abs(orbit.multipliers(1) - 0.3085) < 1e-4;
  return as_printed && std::abs(breaking - 0.70) < 0.005 ? 0 : 1;
}
