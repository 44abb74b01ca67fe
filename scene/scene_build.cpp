#include "core/errors.hpp"
#include "core/random.hpp"
#include "diagnostics/sweep.hpp"
#include "scene/scene.hpp"

#include <fmt/format.h>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace slipmode::scene {

namespace {

double kinetic_friction(const ContactSpec& contact) {
  return contact.normal_load * friction::limit_coefficient(contact.law);
}

bool is_anchored(const fem::ChainOptions& chain) {
  return chain.left_fixed || chain.right_fixed ||
         std::ranges::any_of(chain.ground_stiffness, [](double stiffness) { return stiffness > 0.0; });
}

Eigen::VectorXd static_deflection(const Scene& scene, const dynamics::HybridSystem& system) {
  if (!is_anchored(scene.structure)) {
    throw InvalidInput(
        fmt::format("{}: initial.at = \"static\": the chain is held by nothing, so there is no equilibrium; valid: "
                    "\"rest\", or fix "
                    "an end (structure.ends) or give ground_stiffness",
                    scene.source.path));
  }
  const double speed = scene.drive.velocity(0.0);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(system.size());
  for (const ContactSpec& contact : scene.contacts) {
    if (speed != 0.0) force(contact.at - 1) += std::copysign(kinetic_friction(contact), speed);
  }
  const Eigen::SimplicialLDLT<fem::SparseMatrix> factors(fem::to_sparse(system.structure().K()));
  if (factors.info() != Eigen::Success) {
    throw InvalidInput(
        fmt::format("{}: initial.at = \"static\": the stiffness matrix is singular to rounding; valid: \"rest\"",
                    scene.source.path));
  }
  return factors.solve(force);
}

}  // namespace

std::vector<double> Range::values() const { return diagnostics::sweep_values(from, to, step); }

dynamics::HybridSystem build_system(const Scene& scene) {
  fem::Structure structure = fem::chain(scene.structure);
  std::vector<friction::Contact> contacts;
  for (const ContactSpec& spec : scene.contacts) {
    friction::Contact contact;
    contact.direction = Eigen::VectorXd::Unit(structure.size(), spec.at - 1);
    contact.law = spec.law;
    contact.normal_load = spec.normal_load;
    contact.name = spec.name;
    contacts.push_back(std::move(contact));
  }
  return {std::move(structure), std::move(contacts), scene.drive};
}

dynamics::State initial_state(const Scene& scene, const dynamics::HybridSystem& system) {
  dynamics::State state{.q = Eigen::VectorXd::Zero(system.size()), .v = Eigen::VectorXd::Zero(system.size())};
  switch (scene.initial.at) {
    case InitialSpec::At::kRest:
      break;
    case InitialSpec::At::kStatic:
      state.q = static_deflection(scene, system);
      break;
    case InitialSpec::At::kGiven:
      state.q = Eigen::Map<const Eigen::VectorXd>(scene.initial.displacement.data(), system.size());
      state.v = Eigen::Map<const Eigen::VectorXd>(scene.initial.velocity.data(), system.size());
      break;
  }
  return state;
}

std::vector<dynamics::State> ensemble_states(const Scene& scene, const dynamics::HybridSystem& system) {
  std::vector<dynamics::State> states(static_cast<std::size_t>(scene.ensemble.members), initial_state(scene, system));
  for (std::size_t k = 0; k < states.size(); ++k) {
    Random random = Random::stream(scene.ensemble.seed, k);
    for (double& x : states[k].q) x += scene.ensemble.spread * random.normal();
    for (double& x : states[k].v) x += scene.ensemble.spread * random.normal();
  }
  return states;
}

dynamics::SimulateOptions simulate_options(const Scene& scene) {
  dynamics::SimulateOptions options;
  options.duration = scene.time.duration;
  options.transient = scene.time.transient;
  options.sample = scene.time.sample;
  options.flow = scene.flow;
  return options;
}

}  // namespace slipmode::scene
