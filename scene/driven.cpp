#include <slipmode/scene/driven.hpp>

#include <fmt/format.h>

namespace slipmode::scene {

bool is_shaken(const Scene& scene) { return scene.drive.shaker() != nullptr; }

bool is_driven(const Scene& scene) { return scene.drive.period().has_value(); }

diagnostics::DrivenCase driven_case(const Scene& scene) {
  if (scene.beam() == nullptr) {
    const dynamics::HybridSystem system = build_system(scene);
    return {.system = system, .readings = {.rows = system.contacts().front().direction.transpose(), .offset = {}}};
  }
  const fem::Beam beam = build_beam(scene);
  const Eigen::VectorXd gauge = beam.strain_row(gauge_position(scene));
  return {.system = build_system(scene, beam), .readings = {.rows = gauge.transpose(), .offset = {}}};
}

std::string reading_name(const Scene& scene) {
  if (scene.beam() == nullptr) return "displacement of " + scene.contacts.front().name;
  return fmt::format("strain at x = {:g} m", gauge_position(scene));
}

std::string reading_unit(const Scene& scene) { return scene.beam() == nullptr && scene.units == "SI" ? "m" : "1"; }

diagnostics::DriveAt drive_over_own_key(const Scene& scene) {
  return [scene](double value) { return drive_at(scene, value); };
}

dynamics::State second_start(const Scene& scene, const dynamics::HybridSystem& system) {
  constexpr double kSpread = 1e-4;
  Scene other = scene;
  other.ensemble.members = 1;
  other.ensemble.seed = scene.ensemble.seed + 1;
  if (other.ensemble.spread == 0.0) other.ensemble.spread = kSpread;
  return ensemble_states(other, system).front();
}

}  // namespace slipmode::scene
