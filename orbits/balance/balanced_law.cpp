#include "orbits/balance/internal/balanced_law.hpp"

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <cmath>
#include <complex>
#include <utility>

namespace slipmode::orbits {
namespace {

/// A Jenkins element of constant limits.
BalancedJenkins jenkins_of(const friction::CompliantCoulomb& law, const friction::Contact& contact, std::size_t c) {
  const auto refuse = [&](const std::string& key, const std::string& found) {
    throw InvalidInput(
        fmt::format("harmonic balance: contact.{}.{} {}, or find this orbit by shooting", c, key, found));
  };
  if (law.mu_s != law.mu_k)
    refuse("mu_s", fmt::format("= {} is not mu_k = {}, so the force jumps where '{}' begins to slide; make them equal",
                               law.mu_s, law.mu_k, contact.name));
  if (!contact.normal_load.is_constant())
    refuse("normal_load", fmt::format("of '{}' varies; give it a constant one", contact.name));
  const friction::ContactForces forces = friction::contact_forces(contact);
  return {.stiffness = law.stiffness, .upper = forces.limit(1.0), .lower = forces.limit(-1.0)};
}

}  // namespace

BalancedLaw balanced_law(const friction::Contact& contact, std::size_t c) {
  if (const auto* clearance = std::get_if<friction::Clearance>(&contact.law)) return BalancedClearance{*clearance};
  if (const auto* compliant = std::get_if<friction::CompliantCoulomb>(&contact.law))
    return jenkins_of(*compliant, contact, c);
  if (friction::ContactForces forces = friction::contact_forces(contact); forces.kind == friction::LawKind::kSmooth)
    return BalancedSmooth{std::move(forces)};
  throw InvalidInput(fmt::format(
      "harmonic balance holds clearances, Coulomb friction behind a contact spring and friction without stick "
      "(contact.{}.law = \"clearance\", \"compliant\", \"tanh\", or a \"table\" with mu_s = 0), and contact "
      "'{}' has another law; give it a contact spring, or find this orbit by shooting, which holds every law",
      c, contact.name));
}

ForceTangent tangent(const BalancedLaw& law, const TrigonometricPolynomial& y, double omega, Eigen::Index moments,
                     bool jumps) {
  if (const auto* clearance = std::get_if<BalancedClearance>(&law)) return clearance->tangent(y, omega, moments, jumps);
  return std::get<BalancedSmooth>(law).tangent(y, omega, moments);
}

std::optional<double> own_state(const BalancedLaw& law, const TrigonometricPolynomial& y) {
  if (const auto* jenkins = std::get_if<BalancedJenkins>(&law)) return jenkins->stretch(y);
  return std::nullopt;
}

std::vector<BalancedLaw> balanced_laws(const dynamics::HybridSystem& system) {
  std::vector<BalancedLaw> out;
  for (std::size_t c = 0; c < system.contacts().size(); ++c) out.push_back(balanced_law(system.contacts()[c], c));
  return out;
}

TrigonometricPolynomial counterpart_motion(const friction::Drive& drive, int order, Eigen::Index harmonics) {
  TrigonometricPolynomial d{Eigen::VectorXcd::Zero(harmonics + 1)};
  if (const friction::Shaker* shaker = drive.shaker(); shaker != nullptr && order <= harmonics)
    d.phasors[order] = shaker->amplitude * std::complex<double>(std::sin(shaker->phase), -std::cos(shaker->phase));
  return d;
}

TrigonometricPolynomial seen_by(const BalancedLaw& law, const TrigonometricPolynomial& y,
                                const TrigonometricPolynomial& d) {
  return follows_drive(law) ? TrigonometricPolynomial{y.phasors - d.phasors} : y;
}

}  // namespace slipmode::orbits
