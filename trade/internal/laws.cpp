#include "trade/internal/laws.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include <slipmode/friction/simplified.hpp>

#include <fmt/format.h>
#include <array>

namespace slipmode::trade {

namespace {

constexpr std::array kSpringFactors = {0.1, 10.0, 100.0};
constexpr std::array kTanhShares = {0.1, 0.01, 0.001};

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

std::optional<scene::Scene> with_rigid_contacts(const scene::Scene& scene) { return with_laws(scene, friction::rigid); }

std::optional<scene::Scene> with_springs(const scene::Scene& scene, double factor) {
  const dynamics::HybridSystem system = scene::build_system(scene);
  std::size_t c = 0;
  return with_laws(scene, [&](const friction::Law& law) {
    const Eigen::VectorXd& w = system.contacts()[c++].direction;
    const double own = w.dot(fem::multiply(system.structure().K(), w).col(0)) / (w.squaredNorm() * w.squaredNorm());
    return friction::with_spring(law, own, factor);
  });
}

std::optional<scene::Scene> with_tanh(const scene::Scene& scene, double share) {
  const double epsilon = rounded(share * drive_speed(scene));
  if (!(epsilon > 0.0)) return std::nullopt;
  return with_laws(scene, [epsilon](const friction::Law& law) { return friction::regularised(law, epsilon); });
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
