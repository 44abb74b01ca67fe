#include "trade/internal/laws.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/overloaded.hpp>
#include <slipmode/dynamics/prepare.hpp>

#include <fmt/format.h>
#include <array>

namespace slipmode::trade {

namespace {

constexpr std::array kSpringFactors = {0.1, 10.0, 100.0};
constexpr std::array kTanhShares = {0.1, 0.01, 0.001};

std::optional<friction::Law> rigid(const friction::Law& law) {
  using Other = std::optional<friction::Law>;
  return std::visit(Overloaded{[](const friction::CompliantCoulomb& spring) -> Other {
                                 return friction::Coulomb{spring.mu_s, spring.mu_k};
                               },
                               [](const friction::Dahl& dahl) -> Other {
                                 return friction::Coulomb{dahl.mu, dahl.mu};
                               },
                               [](const friction::LuGre& lugre) -> Other {
                                 return friction::Stribeck{lugre.mu_s, lugre.mu_k, 1.0 / lugre.stribeck_speed};
                               },
                               [](const friction::TanhRegularised& smooth) -> Other {
                                 if (smooth.alpha == 0.0) return friction::Coulomb{smooth.mu_s, smooth.mu_s};
                                 return friction::Stribeck{smooth.mu_s, smooth.mu_k, smooth.alpha};
                               },
                               [](const auto&) -> Other { return std::nullopt; }},
                    law);
}

std::optional<friction::Law> regularised(const friction::Law& law, double epsilon) {
  using Other = std::optional<friction::Law>;
  constexpr double kDecay = 0.1;  // of a static peak, over 1/ε
  const auto from_coulomb = [epsilon](double mu_s, double mu_k) -> Other {
    return friction::TanhRegularised{mu_s, mu_k, mu_s > mu_k ? kDecay / epsilon : 0.0, epsilon};
  };
  return std::visit(
      Overloaded{[&](const friction::Coulomb& coulomb) { return from_coulomb(coulomb.mu_s, coulomb.mu_k); },
                 [&](const friction::CompliantCoulomb& spring) { return from_coulomb(spring.mu_s, spring.mu_k); },
                 [&](const friction::Stribeck& stribeck) -> Other {
                   return friction::TanhRegularised{stribeck.mu_s, stribeck.mu_k, stribeck.alpha, epsilon};
                 },
                 [&](const friction::TanhRegularised& smooth) -> Other {
                   if (smooth.epsilon == epsilon) return std::nullopt;
                   return friction::TanhRegularised{smooth.mu_s, smooth.mu_k, smooth.alpha, epsilon};
                 },
                 [](const auto&) -> Other { return std::nullopt; }},
      law);
}

/// One significant digit: a name that reads well, and a value that is the one named.
double rounded(double value) { return std::stod(fmt::format("{:.0e}", value)); }

void offer(std::vector<OtherContacts>& all, std::string name, std::optional<scene::Scene> scene) {
  if (scene && can_run(*scene)) all.push_back({std::move(name), std::move(*scene)});
}

double drive_speed(const scene::Scene& scene) { return scene.drive.velocity_scale(0.0); }

}  // namespace

bool can_run(const scene::Scene& scene) {
  try {
    const dynamics::HybridSystem system = scene::build_system(scene);
    (void)dynamics::choose_method(system, scene.flow.method);
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

std::optional<scene::Scene> with_rigid_contacts(const scene::Scene& scene) {
  return with_contacts(scene, [](scene::ContactSpec& contact) {
    const auto law = rigid(contact.law);
    if (law) contact.law = *law;
    return law.has_value();
  });
}

std::optional<scene::Scene> with_springs(const scene::Scene& scene, double factor) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  std::size_t c = 0;
  return with_contacts(scene, [&](scene::ContactSpec& contact) {
    const Eigen::VectorXd& w = system.contacts()[c++].direction;
    if (auto* spring = std::get_if<friction::CompliantCoulomb>(&contact.law)) {
      spring->stiffness *= factor;
      return true;
    }
    const auto* coulomb = std::get_if<friction::Coulomb>(&contact.law);
    if (coulomb == nullptr) return false;
    const double own = w.dot(fem::multiply(system.structure().K(), w).col(0)) / (w.squaredNorm() * w.squaredNorm());
    if (!(own > 0.0)) return false;
    contact.law = friction::CompliantCoulomb{coulomb->mu_s, coulomb->mu_k, factor * own};
    return true;
  });
}

std::optional<scene::Scene> with_tanh(const scene::Scene& scene, double share) {
  const double epsilon = rounded(share * drive_speed(scene));
  if (!(epsilon > 0.0)) return std::nullopt;
  return with_contacts(scene, [epsilon](scene::ContactSpec& contact) {
    const auto law = regularised(contact.law, epsilon);
    if (law) contact.law = *law;
    return law.has_value();
  });
}

std::vector<OtherContacts> other_laws(const scene::Scene& scene) {
  std::vector<OtherContacts> all;
  offer(all, "rigid contacts", with_rigid_contacts(scene));
  for (const double factor : kSpringFactors) {
    offer(all, fmt::format("contact springs x {:g}", factor), with_springs(scene, factor));
  }
  for (const double share : kTanhShares) {
    offer(all, fmt::format("tanh, eps {:g}", rounded(share * drive_speed(scene))), with_tanh(scene, share));
  }
  return all;
}

std::vector<OtherContacts> other_loads(const scene::Scene& scene) {
  std::vector<OtherContacts> all;
  offer(all, "no normal vibration", without_normal_vibration(scene));
  offer(all, "constant load", with_constant_load(scene));
  return all;
}

std::optional<scene::Scene> with_constant_load(const scene::Scene& scene) {
  return with_contacts(scene, [](scene::ContactSpec& contact) {
    if (contact.normal_load.slope == 0.0) return false;
    contact.normal_load.slope = 0.0;
    return true;
  });
}

std::optional<scene::Scene> without_normal_vibration(const scene::Scene& scene) {
  return with_contacts(scene, [](scene::ContactSpec& contact) {
    if (!contact.normal_load.oscillator) return false;
    contact.normal_load.oscillator.reset();
    return true;
  });
}

}  // namespace slipmode::trade
