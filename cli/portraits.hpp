#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>
#include <vector>

namespace slipmode::cli {

/// Displacement and velocity of the first contact over a stretch of time, kept for a figure.
struct Portrait {
  std::string title;
  std::string role;  ///< "full", or the name of the reduced model's basis
  Eigen::VectorXd displacement, velocity;
};

/// Portraits of one figure, row by row.
struct PortraitSet {
  int columns = 1;
  std::vector<Portrait> portraits;
};

/// What the full model and reduced ones with fewer and fewer modes settle to at the table's speed (S4 Figure 3.7).
[[nodiscard]] PortraitSet level_portraits(const dynamics::HybridSystem& full, const diagnostics::Candidate& candidate,
                                          const diagnostics::ValidationReport& report);

/// Periodic orbits, full above reduced (S4 Figure 3.8), one column per speed at which both have one.
[[nodiscard]] PortraitSet orbit_portraits(const dynamics::HybridSystem& full, const diagnostics::Candidate& candidate,
                                          const diagnostics::ValidationReport& report);

/// Writes a group with one sub-group per portrait. An empty set writes nothing.
void store_portraits(results::StoreWriter& writer, const std::string& group, const PortraitSet& set,
                     const results::Units& units);
[[nodiscard]] PortraitSet load_portraits(const results::StoreReader& store, const std::string& group);

}  // namespace slipmode::cli
