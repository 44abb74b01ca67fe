// A structure from matrices of one's own, rubbed by a belt at two places.
#include <slipmode/dynamics/simulate.hpp>

#include <cmath>
#include <cstdio>

int main() {
  using namespace slipmode;
  const Eigen::MatrixXd M = Eigen::Vector3d(2.0, 1.0, 1.0).asDiagonal();
  const Eigen::MatrixXd K{{2.0, -1.0, 0.0}, {-1.0, 2.0, -1.0}, {0.0, -1.0, 1.0}};
  const fem::Structure structure(M, fem::Rayleigh{.mass = 0.1}, K);

  const friction::Coulomb law{.mu_s = 0.3, .mu_k = 0.3};
  const friction::Contact first{.direction = Eigen::VectorXd::Unit(3, 0), .law = law, .normal_load = 1.0};
  const friction::Contact last{.direction = Eigen::VectorXd::Unit(3, 2), .law = law, .normal_load = 2.0};
  const dynamics::HybridSystem system(structure, {first, last}, friction::Belt::constant(0.2));

  const dynamics::Trajectory run = dynamics::simulate(system, system.rest(), {.duration = 800.0});
  const Eigen::VectorXd q = run.final_state.q;
  std::printf("%zu events, energy residual %.1e, q = %.9f %.9f %.9f\n", run.events.size(), run.audit.residual(), q(0),
              q(1), q(2));

  // The belt drags with 0.3 and 0.6 until the masses rest: the springs carry 0.9, 0.6 and 0.6, by statics.
  const Eigen::Vector3d expected(0.9, 1.5, 2.1);
  return (q - expected).norm() < 1e-9 && std::abs(run.audit.residual()) < 1e-9 ? 0 : 1;
}
