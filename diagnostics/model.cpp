#include "diagnostics/model.hpp"

#include "core/errors.hpp"
#include "rom/reduce.hpp"

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include <cmath>

namespace slipmode::diagnostics {

namespace {

/// Friction coefficient in steady sliding; for the smooth law its own formula, which kinetic_coefficient does not
/// serve.
double sliding_coefficient(const friction::Law& law, double speed) {
  const auto* smooth = std::get_if<friction::TanhRegularised>(&law);
  if (smooth == nullptr) return friction::kinetic_coefficient(law, speed);
  const double sign = std::tanh(speed / smooth->epsilon);
  const friction::Stribeck curve{.mu_s = smooth->mu_s, .mu_k = smooth->mu_k, .alpha = smooth->alpha};
  return sign * friction::kinetic_coefficient(curve, speed * sign);
}

}  // namespace

Model belt_model(const dynamics::HybridSystem& full) {
  return {.system = [full](double speed) { return full.with_drive(friction::Belt::constant(speed)); }};
}

Model reduced_belt_model(const dynamics::HybridSystem& full, const pod::Basis& basis) {
  const dynamics::HybridSystem reduced = rom::reduce(full, basis);
  const Eigen::VectorXd& mean = basis.mean;
  double offset = 0.0;
  if (mean.size() > 0) {
    offset = 0.5 * mean.dot(fem::multiply(full.structure().K(), mean).col(0));
    if (full.load().size() > 0) offset -= full.load().dot(mean);
  }
  return {.system = [reduced](double speed) { return reduced.with_drive(friction::Belt::constant(speed)); },
          .basis = basis,
          .energy_offset = offset};
}

dynamics::State lifted(const Model& model, const dynamics::State& state) {
  return model.basis ? rom::lift(*model.basis, state) : state;
}

dynamics::State restarted(const dynamics::State& state) { return {.time = 0.0, .q = state.q, .v = state.v}; }

dynamics::State sliding_equilibrium(const dynamics::HybridSystem& system) {
  const double speed = system.drive().velocity(0.0);
  Eigen::VectorXd force = system.load().size() > 0 ? system.load() : Eigen::VectorXd::Zero(system.size());
  for (const friction::Contact& contact : system.contacts()) {
    if (speed == 0.0) continue;
    const double lambda = contact.normal_load * sliding_coefficient(contact.law, std::abs(speed));
    force += contact.direction * std::copysign(lambda, speed);
  }
  dynamics::State state = system.rest();
  state.modes = {};
  const Eigen::SimplicialLDLT<fem::SparseMatrix> factor(fem::to_sparse(system.structure().K()));
  const Eigen::VectorXd pivots = factor.vectorD();
  const bool singular = factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-14 * pivots.cwiseAbs().maxCoeff());
  if (singular) {
    throw InvalidInput(
        fmt::format("static equilibrium: expected a positive definite stiffness, found one singular to rounding "
                    "({} dofs; the structure can move as a rigid body). Fix an end, or start from rest",
                    system.size()));
  }
  state.q = factor.solve(force);
  return state;
}

}  // namespace slipmode::diagnostics
