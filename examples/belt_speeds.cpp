// Ten masses on a belt, one motion after another over the belt's speed. Nothing is written to a file.
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/fem/chain.hpp>

#include <cmath>
#include <cstdio>

int main() {
  using namespace slipmode;
  const friction::Contact contact{.direction = Eigen::VectorXd::Unit(10, 9),
                                  .law = friction::Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0},
                                  .normal_load = 3.0};
  const dynamics::HybridSystem chain(fem::chain({.damping = 0.006}), {contact}, friction::Belt::constant(0.45));

  const diagnostics::SweepResult result =
      diagnostics::sweep(diagnostics::belt_model(chain), diagnostics::sweep_values(0.47, 0.45, 0.01),
                         diagnostics::sliding_equilibrium(chain), {.mode = SweepMode::kFollow});
  for (const diagnostics::SweepPoint& point : result.points) {
    const diagnostics::PeriodResult& motion = point.settled.period;
    std::printf("V = %.2f: %s, period %.5f with %d slip(s)\n", point.parameter, to_string(motion.motion), motion.T,
                motion.period);
  }

  // At 0.45 an independent program with fixed steps finds one slip every 45.10211 (datasets/chain10/expected.toml).
  const diagnostics::PeriodResult& last = result.points.back().settled.period;
  return last.period == 1 && std::abs(last.T - 45.10211) < 1e-4 ? 0 : 1;
}
