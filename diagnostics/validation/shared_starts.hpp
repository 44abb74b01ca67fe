#pragma once

// Full against reduced from states of the full model's attractor.

#include <slipmode/diagnostics/validation/compare.hpp>
#include <slipmode/pod/basis.hpp>

#include <vector>

namespace slipmode::diagnostics {

/// `count` states of the motion that begins at `start`, the first being `start`, `gap` apart.
[[nodiscard]] std::vector<dynamics::State> states_along(const dynamics::HybridSystem& system,
                                                        const dynamics::State& start, int count, double gap,
                                                        const dynamics::FlowOptions& flow);

/// A full state's projection as the reduced model's start.
[[nodiscard]] dynamics::State on_subspace(const fem::Structure& structure, const pod::Basis& basis,
                                          const dynamics::State& state);

/// Deviation over the records of all shared starts, each up to the horizon.
/// @param starts  of the full model; both models begin at their projections
/// @throws InvalidInput  if the full model does not move
[[nodiscard]] Deviation deviation_up_to_horizon(const fem::Structure& structure, const Model& full,
                                                const Model& reduced, double parameter,
                                                const std::vector<dynamics::State>& starts, double horizon,
                                                double sample, const dynamics::FlowOptions& flow);

/// Root mean square distance of states to a basis, of their size about their mean; 0 where they are all equal [%].
[[nodiscard]] double distance_to_basis(const fem::Structure& structure, const pod::Basis& basis,
                                       const std::vector<dynamics::State>& states);

}  // namespace slipmode::diagnostics
