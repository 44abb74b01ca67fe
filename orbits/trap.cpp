#include <slipmode/orbits/trap.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/orbits/floquet.hpp>

#include <cmath>
#include <numbers>

namespace slipmode::orbits {

namespace {

/// Unit vectors all round: on the circle evenly, else along the axes and at random.
Eigen::MatrixXd directions(Eigen::Index size) {
  constexpr Eigen::Index kMany = 32;
  Eigen::MatrixXd all(size, kMany + (size > 2 ? 2 * size : 0));
  Random random(1);
  for (Eigen::Index k = 0; k < kMany; ++k) {
    if (size == 2) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / kMany;
      all.col(k) << std::cos(angle), std::sin(angle);
    } else {
      for (double& entry : all.col(k)) entry = random.normal();
      all.col(k).normalize();
    }
  }
  if (size > 2)
    all.rightCols(2 * size) << Eigen::MatrixXd::Identity(size, size), -Eigen::MatrixXd::Identity(size, size);
  return all;
}

/// L with LᵀL = Σ_k (Φᵀ)ᵏ D² Φᵏ: ‖LΦδ‖² = ‖Lδ‖² − ‖Dδ‖².
Eigen::MatrixXd adapted_metric(const Eigen::MatrixXd& monodromy, const Eigen::VectorXd& weight) {
  Eigen::MatrixXd sum = weight.cwiseAbs2().asDiagonal(), power = monodromy;
  for (int doubling = 0; doubling < 64; ++doubling) {
    const Eigen::MatrixXd more = power.transpose() * sum * power;
    sum += more;
    if (more.norm() < 1e-16 * sum.norm()) break;
    power = Eigen::MatrixXd(power * power);
  }
  return Eigen::LLT<Eigen::MatrixXd>(sum).matrixU();
}

}  // namespace

Trap measure_trap(const dynamics::HybridSystem& system, const dynamics::State& centre, double duration,
                  const Eigen::VectorXd& scale, const dynamics::FlowOptions& flow) {
  constexpr int kRadii = 5, kShrinkings = 24;
  constexpr double kSlowest = 1.0 - 1e-6;
  Trap trap{.centre = stacked(centre), .modes = centre.modes};
  const Eigen::MatrixXd monodromy = dynamics::tangent_flow(system, centre, duration, flow).monodromy;
  if (!(std::abs(sorted_eigenvalues(monodromy)(0)) < kSlowest)) return trap;
  trap.L = adapted_metric(monodromy, scale.cwiseInverse());
  const Eigen::MatrixXd back =
      trap.L.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(trap.L.rows(), trap.L.cols()));
  const Eigen::MatrixXd image = trap.L * monodromy * back, from = back * directions(trap.centre.size());
  trap.contraction = Eigen::JacobiSVD<Eigen::MatrixXd>(image).singularValues()(0);
  const double wanted = 0.5 * (1.0 + trap.contraction);
  const auto draws_in = [&](double radius) {
    for (Eigen::Index k = 0; k < from.cols(); ++k) {
      try {
        // Springs keep their modes; what sticks rigidly at the centre need not, away from it.
        const dynamics::State state =
            dynamics::handed_on(system, with_coordinates(centre, trap.centre + radius * from.col(k)), centre.time);
        const Eigen::VectorXd end = stacked(advanced(system, state, duration));
        if (!((trap.L * (end - trap.centre)).norm() <= wanted * radius)) return false;
      } catch (const NumericalFailure&) {
        return false;
      }
    }
    return true;
  };
  int passed = 0;
  for (int halving = 0; halving < kShrinkings; ++halving) {
    passed = draws_in(std::ldexp(1.0, -halving)) ? passed + 1 : 0;
    if (passed < kRadii) continue;
    trap.radius = 0.5 * std::ldexp(1.0, kRadii - 1 - halving);
    break;
  }
  return trap;
}

}  // namespace slipmode::orbits
