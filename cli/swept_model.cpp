#include "cli/swept_model.hpp"

#include <slipmode/rom/reduce.hpp>

namespace slipmode::cli {

diagnostics::Model swept_model(const scene::Scene& scene, const std::string& key,
                               const std::optional<pod::Basis>& basis) {
  if (key == "drive.speed" && scene.drive.is_constant()) {
    const dynamics::HybridSystem full = scene::build_system(scene);
    return basis ? diagnostics::reduced_belt_model(full, *basis) : diagnostics::belt_model(full);
  }
  const auto full_at = [scene, key](double value) { return scene::build_system(scene::set_key(scene, key, value)); };
  if (!basis) return {.system = full_at};
  return {.system = [full_at, basis = *basis](double value) { return rom::reduce(full_at(value), basis); },
          .basis = basis,
          .energy_offset = [full_at, basis = *basis](
                               double value) { return diagnostics::projection_energy(full_at(value), basis); }};
}

}  // namespace slipmode::cli
