#pragma once

#include <slipmode/diagnostics/attractors/model.hpp>
#include <slipmode/scene/scene.hpp>

#include <optional>
#include <string>

namespace slipmode::cli {

/// The scene's model with one of its keys as the parameter, projected when a basis is given: energies are those of
/// lifted states at every value. Under a constant belt's speed all values share modal data.
[[nodiscard]] diagnostics::Model swept_model(const scene::Scene& scene, const std::string& key,
                                             const std::optional<pod::Basis>& basis = {});

}  // namespace slipmode::cli
