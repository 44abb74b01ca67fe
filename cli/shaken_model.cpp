#include "cli/shaken_model.hpp"

#include <slipmode/results/units.hpp>

#include <fmt/format.h>

namespace slipmode::cli {

bool is_shaken(const scene::Scene& scene) { return scene.drive.shaker() != nullptr; }

diagnostics::DrivenCase shaken_case(const scene::Scene& scene) {
  if (scene.beam() == nullptr) {
    const dynamics::HybridSystem system = scene::build_system(scene);
    return {.system = system, .readings = {.rows = system.contacts().front().direction.transpose(), .offset = {}}};
  }
  const fem::Beam beam = scene::build_beam(scene);
  const Eigen::VectorXd gauge = beam.strain_row(scene::gauge_position(scene));
  return {.system = scene::build_system(scene, beam), .readings = {.rows = gauge.transpose(), .offset = {}}};
}

std::string reading_name(const scene::Scene& scene) {
  if (scene.beam() == nullptr) return "displacement of " + scene.contacts.front().name;
  return fmt::format("strain at x = {:g} m", scene::gauge_position(scene));
}

std::string reading_unit(const scene::Scene& scene) {
  return scene.beam() != nullptr ? "1" : results::Units::of(scene.units).length;
}

diagnostics::DriveAt drive_over_frequency(const scene::Scene& scene) {
  return [scene](double frequency) { return scene::drive_at(scene, frequency); };
}

diagnostics::DrivenOptions driven_options(const scene::Scene& scene) {
  return {.cycles = scene.shaken.cycles,
          .kept = scene.shaken.kept,
          .tolerance = scene.shaken.period_tolerance,
          .max_period = scene.shaken.max_period,
          .flow = scene.flow};
}

dynamics::State second_start(const scene::Scene& scene, const dynamics::HybridSystem& system) {
  constexpr double kSpread = 1e-4;
  scene::Scene other = scene;
  other.ensemble.members = 1;
  other.ensemble.seed = scene.ensemble.seed + 1;
  if (other.ensemble.spread == 0.0) other.ensemble.spread = kSpread;
  return scene::ensemble_states(other, system).front();
}

}  // namespace slipmode::cli
