#pragma once

#include <slipmode/results/store.hpp>
#include <slipmode/results/units.hpp>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slipmode::results {

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

/// Writes a group with one sub-group per portrait. An empty set writes nothing.
void store_portraits(StoreWriter& writer, const std::string& group, const PortraitSet& set, const Units& units);
[[nodiscard]] PortraitSet load_portraits(const StoreReader& store, const std::string& group);

}  // namespace slipmode::results
