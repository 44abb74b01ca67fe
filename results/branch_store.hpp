#pragma once

#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/results/table.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// A followed branch with where it came from.
struct NamedBranch {
  std::string title;  ///< "main branch", "from symmetry breaking at 0.7017"
  orbits::Branch branch;
};

/// Writes the group `branches`: one sub-group per branch with its points, special points and why it ended.
/// @param family  gives the systems whose contacts' amplitudes are measured
void store_branches(StoreWriter& writer, const std::string& key, const std::vector<NamedBranch>& branches,
                    const dynamics::SystemFamily& family);

/// Writes the group `curves` in the same way: of special points, each at its values of both keys.
/// @param keys    the one that is solved for, and the curves' parameter
/// @param family  over both
void store_curves(StoreWriter& writer, const std::vector<std::string>& keys, const std::vector<NamedBranch>& curves,
                  const dynamics::PlaneFamily& family);

/// What figures need of a stored branch.
struct StoredBranch {
  std::string title, end, reason;
  Table points, special;
  Eigen::MatrixXd modulus;  ///< |multiplier| by size [points x N]
};

/// @throws InvalidInput  when the file holds no branches, or damaged ones
[[nodiscard]] std::vector<StoredBranch> load_branches(const StoreReader& store);
[[nodiscard]] std::vector<StoredBranch> load_curves(const StoreReader& store);

}  // namespace slipmode::results
