#include <slipmode/dynamics/bristle.hpp>

#include <Eigen/Dense>

namespace slipmode::dynamics {
namespace {

using Matrix8 = RadauTables::Matrix8;
using Vector8 = RadauTables::Vector8;

/// The collocated equations at given speeds: z = z₀ + hA(s − κz), hence (I + hA κ) z = z₀ + hA s and
/// (I + hA κ) δz = δz₀ + hA (1 − κ′z) δs.
struct BristleEquations {
  Matrix8 integral;
  Vector8 decay, decay_slope;
  Eigen::PartialPivLU<Matrix8> system;

  BristleEquations(const friction::BristleForces& law, double direction, double h, const Vector8& speed)
      : integral(h * radau().integral) {
    for (int j = 0; j < kNodes; ++j) {
      const friction::BristleForces::Decay at = law.decay(direction, speed(j));
      decay(j) = at.value;
      decay_slope(j) = at.slope;
    }
    system.compute(Matrix8::Identity() + integral * decay.asDiagonal());
  }
  /// 1 − κ′z
  [[nodiscard]] Vector8 direct(const Vector8& z) const { return Vector8::Ones() - decay_slope.cwiseProduct(z); }
  [[nodiscard]] Matrix8 z_by_speed(const Vector8& direct) const {
    return system.solve(Matrix8(integral * direct.asDiagonal()));
  }
  /// ∂λ/∂z at given speeds.
  [[nodiscard]] Vector8 force_by_z(const friction::BristleForces& law) const {
    return law.stiffness - law.damping * decay.array();
  }
  [[nodiscard]] Matrix8 force_by_speed(const friction::BristleForces& law, const Vector8& direct,
                                       const Matrix8& z_by_speed) const {
    Matrix8 slope = force_by_z(law).asDiagonal() * z_by_speed;
    slope.diagonal() += law.damping * direct + Vector8::Constant(law.viscous);
    return slope;
  }
};

}  // namespace

BristleStep solve_bristle(const friction::BristleForces& law, double direction, double start, double h,
                          const Vector8& speed) {
  const BristleEquations equations(law, direction, h, speed);
  BristleStep out;
  out.z = equations.system.solve(Vector8::Constant(start) + equations.integral * speed);
  const Vector8 direct = equations.direct(out.z);
  out.force = law.stiffness * out.z + law.damping * (speed - equations.decay.cwiseProduct(out.z)) + law.viscous * speed;
  out.slope = equations.force_by_speed(law, direct, equations.z_by_speed(direct));
  return out;
}

BristleVariation vary_bristle(const friction::BristleForces& law, double direction, double h, const Vector8& speed,
                              const Vector8& z) {
  const BristleEquations equations(law, direction, h, speed);
  const Vector8 direct = equations.direct(z);
  BristleVariation out;
  out.z_by_speed = equations.z_by_speed(direct);
  out.z_by_start = equations.system.solve(Vector8::Ones());
  out.force_by_speed = equations.force_by_speed(law, direct, out.z_by_speed);
  out.force_by_start = equations.force_by_z(law).cwiseProduct(out.z_by_start);
  return out;
}

double bristle_within(double start, const Vector8& z, double share) {
  // The difference from the start vanishes there: share · (a polynomial of degree 7 through difference / node).
  const RadauTables& t = radau();
  const Vector8 scaled = (z.array() - start) / t.node.array();
  return start + share * t.lagrange(share).dot(scaled);
}

}  // namespace slipmode::dynamics
