#include <slipmode/diagnostics/model.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slipmode::diagnostics {

Model belt_model(const dynamics::HybridSystem& full) {
  return {.system = [full](double speed) { return full.with_drive(friction::Belt::constant(speed)); }};
}

double projection_energy(const dynamics::HybridSystem& full, const pod::Basis& basis) {
  const Eigen::VectorXd& mean = basis.mean;
  if (mean.size() == 0) return 0.0;
  const double energy = 0.5 * mean.dot(fem::multiply(full.structure().K(), mean).col(0));
  return full.load().size() > 0 ? energy - full.load().dot(mean) : energy;
}

Model reduced_belt_model(const dynamics::HybridSystem& full, const pod::Basis& basis) {
  const dynamics::HybridSystem reduced = rom::reduce(full, basis);
  return {.system = [reduced](double speed) { return reduced.with_drive(friction::Belt::constant(speed)); },
          .basis = basis,
          .energy_offset = [offset = projection_energy(full, basis)](double) { return offset; }};
}

double energy_offset_at(const Model& model, double parameter) {
  return model.energy_offset ? model.energy_offset(parameter) : 0.0;
}

dynamics::State lifted(const Model& model, const dynamics::State& state) {
  return model.basis ? rom::lift(*model.basis, state) : state;
}

double mean_energy(const dynamics::HybridSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& q,
                   const Eigen::Ref<const Eigen::MatrixXd>& v) {
  const fem::Structure& structure = system.structure();
  double sum = 0.5 * v.cwiseProduct(fem::multiply(structure.M(), v)).sum() +
               0.5 * q.cwiseProduct(fem::multiply(structure.K(), q)).sum();
  if (system.load().size() > 0) sum -= (system.load().transpose() * q).sum();
  return sum / static_cast<double>(q.cols());
}

dynamics::State sliding_equilibrium(const dynamics::HybridSystem& system) {
  const double speed = system.drive().velocity(0.0);
  Eigen::VectorXd force = system.load().size() > 0 ? system.load() : Eigen::VectorXd::Zero(system.size());
  for (const friction::Contact& contact : system.contacts()) {
    if (speed == 0.0) continue;
    const double lambda = contact.normal_load.constant * friction::kinetic_coefficient(contact.law, std::abs(speed));
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

Eigen::VectorXd resting_place(const dynamics::HybridSystem& system) {
  if (system.drive().belt() == nullptr) return Eigen::VectorXd::Zero(system.size());
  try {
    return sliding_equilibrium(system).q;
  } catch (const InvalidInput&) {
    return Eigen::VectorXd::Zero(system.size());
  }
}

pod::Basis lnms_at_rest(const dynamics::HybridSystem& system, Eigen::Index L) {
  pod::Basis modes = rom::lnm_basis(system.structure(), L);
  modes.mean = resting_place(system);
  return modes;
}

}  // namespace slipmode::diagnostics
