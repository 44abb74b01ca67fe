#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/scene/scene.hpp>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace slipmode::scene {

namespace {

bool is_anchored(const fem::ChainOptions& chain) {
  return chain.left_fixed || chain.right_fixed ||
         std::ranges::any_of(chain.ground_stiffness, [](double stiffness) { return stiffness > 0.0; });
}

/// dN/dy of a contact at rest: with a normal oscillator its two springs in series.
double static_load_slope(const friction::NormalLoad& load) {
  if (!load.oscillator) return load.slope;
  const friction::NormalOscillator& own = *load.oscillator;
  return own.slope * own.spring_stiffness * own.support_stiffness / (own.spring_stiffness + own.support_stiffness);
}

/// λ/N of steady sliding, in the direction of the drive; 0 on a drive that stands still.
double sliding_coefficient(const friction::Contact& contact, double speed) {
  if (speed == 0.0) return 0.0;
  const double sign = std::copysign(1.0, speed);
  const double mu = friction::limit_coefficient(contact.law);
  return sign * (contact.tilt == 0.0 ? mu : friction::effective_coefficient(mu, contact.tilt, sign));
}

struct Equilibrium {
  Eigen::VectorXd q;        ///< [n]
  Eigen::VectorXd force;    ///< λ [nc]
  Eigen::VectorXd contact;  ///< wᵀq [nc]
};

/// K q = W λ with λ = m (N0 + N1 Wᵀq), m the signed coefficients: (I − diag(m N1) WᵀK⁻¹W) λ = m N0.
Equilibrium sliding_equilibrium(const Scene& scene, const dynamics::HybridSystem& system) {
  const auto refuse = [&scene](const std::string& what) {
    throw InvalidInput(fmt::format("{}: initial.at = \"static\": {}", scene.source.path, what));
  };
  if (scene.chain() != nullptr && !is_anchored(*scene.chain())) {
    refuse(
        "the chain is held by nothing, so there is no equilibrium; valid: \"rest\", or fix an end (structure.ends) or "
        "give ground_stiffness");
  }
  for (const friction::Contact& contact : system.contacts()) {
    if (friction::clearance(contact.law) == nullptr) continue;
    refuse(
        fmt::format("contact '{}' is a clearance, whose equilibrium depends on which stops are touched; valid: "
                    "\"rest\", or displacement and velocity",
                    contact.name));
  }
  const Eigen::SimplicialLDLT<fem::SparseMatrix> factors(fem::to_sparse(system.structure().K()));
  if (factors.info() != Eigen::Success) refuse("the stiffness matrix is singular to rounding; valid: \"rest\"");

  const auto& contacts = system.contacts();
  const auto count = static_cast<Eigen::Index>(contacts.size());
  const double speed = scene.drive.velocity(0.0);
  Eigen::MatrixXd W(system.size(), count);
  Eigen::VectorXd load(count), slope(count), coefficient(count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const friction::Contact& contact = contacts[static_cast<std::size_t>(c)];
    W.col(c) = contact.direction;
    load(c) = contact.normal_load.constant;
    slope(c) = static_load_slope(contact.normal_load);
    coefficient(c) = sliding_coefficient(contact, speed);
  }
  const Eigen::MatrixXd flexibility = W.transpose() * factors.solve(W);
  const Eigen::MatrixXd feedback = coefficient.cwiseProduct(slope).asDiagonal() * flexibility;
  Equilibrium found;
  found.force =
      (Eigen::MatrixXd::Identity(count, count) - feedback).partialPivLu().solve(coefficient.cwiseProduct(load));
  found.q = factors.solve(W * found.force);
  found.contact = W.transpose() * found.q;
  for (Eigen::Index c = 0; c < count; ++c) {
    const double normal = load(c) + slope(c) * found.contact(c);
    if (std::isfinite(normal) && normal >= 0.0) continue;
    refuse(fmt::format("the normal load of contact '{}' would be {} N; valid: \"rest\", or a smaller slope",
                       contacts[static_cast<std::size_t>(c)].name, normal));
  }
  return found;
}

/// Contacts' own states in sliding equilibrium: springs and bristles carry λ, normal oscillators rest.
Eigen::VectorXd internal_states(const dynamics::HybridSystem& system, const Equilibrium& at) {
  Eigen::VectorXd internal = Eigen::VectorXd::Zero(system.internal_size());
  Eigen::Index next = 0;
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const auto index = static_cast<Eigen::Index>(c);
    const double stiffness = friction::spring_stiffness(contact.law);
    if (stiffness > 0.0) internal(next++) = at.force(index) / stiffness;
    if (const auto& own = contact.normal_load.oscillator) {
      internal(next) =
          own->slope * at.contact(index) * own->spring_stiffness / (own->spring_stiffness + own->support_stiffness);
      next += 2;
    }
  }
  return internal;
}

/// The six lowest natural modes, each with a largest nodal displacement of 1.
Eigen::MatrixXd perturbation_shapes(const dynamics::HybridSystem& system) {
  constexpr Eigen::Index kModes = 6;
  Eigen::MatrixXd shapes = fem::natural_modes(system.structure(), std::min(kModes, system.size())).shapes;
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    shapes.col(k) /= shapes(Eigen::seq(0, Eigen::last, 2), k).cwiseAbs().maxCoeff();
  }
  return shapes;
}

void perturb(Eigen::VectorXd& vector, const Eigen::MatrixXd& shapes, double spread, Random& random) {
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) vector += spread * random.normal() * shapes.col(k);
}

}  // namespace

dynamics::State initial_state(const Scene& scene, const dynamics::HybridSystem& system) {
  dynamics::State state{.q = Eigen::VectorXd::Zero(system.size()), .v = Eigen::VectorXd::Zero(system.size())};
  switch (scene.initial.at) {
    case InitialSpec::At::kRest:
      break;
    case InitialSpec::At::kStatic: {
      const Equilibrium equilibrium = sliding_equilibrium(scene, system);
      state.q = equilibrium.q;
      state.internal = internal_states(system, equilibrium);
      break;
    }
    case InitialSpec::At::kGiven:
      state.q = Eigen::Map<const Eigen::VectorXd>(scene.initial.displacement.data(), system.size());
      state.v = Eigen::Map<const Eigen::VectorXd>(scene.initial.velocity.data(), system.size());
      break;
  }
  return state;
}

std::vector<dynamics::State> ensemble_states(const Scene& scene, const dynamics::HybridSystem& system) {
  std::vector<dynamics::State> states(static_cast<std::size_t>(scene.ensemble.members), initial_state(scene, system));
  const double spread = scene.ensemble.spread;
  const bool modal = scene.beam() != nullptr && spread > 0.0;
  const Eigen::MatrixXd shapes = modal ? perturbation_shapes(system) : Eigen::MatrixXd();
  for (std::size_t k = 0; k < states.size(); ++k) {
    Random random = Random::stream(scene.ensemble.seed, k);
    if (scene.beam() != nullptr) {
      perturb(states[k].q, shapes, spread, random);
      perturb(states[k].v, shapes, spread, random);
      continue;
    }
    for (double& x : states[k].q) x += spread * random.normal();
    for (double& x : states[k].v) x += spread * random.normal();
  }
  return states;
}

}  // namespace slipmode::scene
