#pragma once

#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include "report/internal/json.hpp"

#include <Eigen/Core>
#include <optional>
#include <string>

namespace slipmode::report {

/// "A chain of 10 masses; contact 1 at 10 (stribeck); belt at V = 0.2".
[[nodiscard]] std::string model_text(const scene::Scene& scene);

/// What a validation on a belt says of the reduced model, as questions with answers: is it to be trusted, where, what
/// it saves, how accurate it is. Each has a tone, "good", "fair" or "poor".
/// @throws InvalidInput  when the file lacks a table
[[nodiscard]] Json belt_answers(const results::StoreReader& validation);

/// A reduced model by its basis and number of modes.
struct NamedModel {
  std::string basis;
  Eigen::Index modes = 0;
};
/// Of a validation under a shaker or a force: the reduced model that answers speak of. Nothing where none gave a
/// settled motion.
[[nodiscard]] std::optional<NamedModel> told_of_driven(const results::StoreReader& validation);

/// The same as belt_answers of a validation under a shaker or a force.
[[nodiscard]] Json driven_answers(const results::StoreReader& validation);

}  // namespace slipmode::report
