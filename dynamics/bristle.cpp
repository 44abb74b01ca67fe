#include <slipmode/dynamics/bristle.hpp>

#include <Eigen/Dense>

namespace slipmode::dynamics {

BristleStep solve_bristle(const friction::BristleForces& law, double direction, double start, double h,
                          const RadauTables::Vector8& speed) {
  // z = z₀ + hA(s − κz), hence (I + hA κ) z = z₀ + hA s and (I + hA κ) δz = hA (1 − κ′z) δs.
  using Matrix8 = RadauTables::Matrix8;
  using Vector8 = RadauTables::Vector8;
  const Matrix8 integral = h * radau().integral;
  Vector8 decay, decay_slope;
  for (int j = 0; j < kNodes; ++j) {
    const friction::BristleForces::Decay at = law.decay(direction, speed(j));
    decay(j) = at.value;
    decay_slope(j) = at.slope;
  }
  const Eigen::PartialPivLU<Matrix8> system(Matrix8::Identity() + integral * decay.asDiagonal());
  BristleStep out;
  out.z = system.solve(Vector8::Constant(start) + integral * speed);
  const Vector8 direct = Vector8::Ones() - decay_slope.cwiseProduct(out.z);
  out.force = law.stiffness * out.z + law.damping * (speed - decay.cwiseProduct(out.z)) + law.viscous * speed;
  out.slope = (law.stiffness - law.damping * decay.array()).matrix().asDiagonal() *
              system.solve(Matrix8(integral * direct.asDiagonal()));
  out.slope.diagonal() += law.damping * direct + Vector8::Constant(law.viscous);
  return out;
}

double bristle_within(double start, const RadauTables::Vector8& z, double share) {
  // The difference from the start vanishes there: share · (a polynomial of degree 7 through difference / node).
  const RadauTables& t = radau();
  const RadauTables::Vector8 scaled = (z.array() - start) / t.node.array();
  return start + share * t.lagrange(share).dot(scaled);
}

}  // namespace slipmode::dynamics
