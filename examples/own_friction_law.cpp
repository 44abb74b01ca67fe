// A friction law of one's own, by its coefficient and slope over the sliding speed: one mass on a belt, stick-slip.
#include <slipmode/dynamics/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

int main() {
  using namespace slipmode;
  // Rubber on glass, say: a hyperbola where Stribeck's law has an exponential.
  const friction::Characteristic law{.mu_s = 0.4,
                                     .mu = [](double v) { return 0.2 + 0.2 / (1.0 + 5.0 * v); },
                                     .slope = [](double v) { return -1.0 / ((1.0 + 5.0 * v) * (1.0 + 5.0 * v)); }};
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  const fem::Structure structure(one, fem::Rayleigh{.stiffness = 0.01}, one);
  const friction::Contact contact{.direction = Eigen::VectorXd::Unit(1, 0), .law = law, .normal_load = 1.0};
  const double speed = 0.1;
  const dynamics::HybridSystem system(structure, {contact}, friction::Belt::constant(speed));

  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 200.0, .sample = 0.01});
  std::printf("%zu events, energy residual %.1e, sticks %.1f %% of the time\n", run.events.size(), run.audit.residual(),
              100.0 * run.statistics.stick_time.front() / 200.0);

  // Every stick ends where the spring and the damper pull with mu_s N: q = 0.4 - 0.01 V, by statics.
  double worst = 0.0;
  int releases = 0;
  for (const dynamics::Event& event : run.events) {
    if (event.before != dynamics::ContactMode::kStick || event.time == 0.0) continue;
    worst = std::max(worst, std::abs(event.displacement - (0.4 - 0.01 * speed)));
    ++releases;
  }
  std::printf("%d releases, at most %.1e from where statics puts them\n", releases, worst);
  return releases > 5 && worst < 1e-9 && std::abs(run.audit.residual()) < 1e-9 ? 0 : 1;
}
