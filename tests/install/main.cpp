#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>

#include <cmath>
#include <cstdio>

// A belt drags the last of ten masses for 50 time units; the energy balance must close.
int main() {
  using namespace slipmode;
  const friction::Contact contact{.direction = Eigen::VectorXd::Unit(10, 9),
                                  .law = friction::Stribeck{.mu_s = 0.4, .mu_k = 0.2, .alpha = 8.0},
                                  .normal_load = 3.0};
  const dynamics::HybridSystem system(fem::chain({.damping = 0.006}), {contact}, friction::Belt::constant(0.2));
  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 50.0, .sample = 0.5});
  std::printf("%zu events, energy residual %.1e, last mass at %.6f\n", run.events.size(), run.audit.residual(),
              run.q(9, run.q.cols() - 1));
  return std::abs(run.audit.residual()) < 1e-9 && run.q.allFinite() ? 0 : 1;
}
