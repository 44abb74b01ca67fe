#pragma once

#include <slipmode/pod/basis.hpp>
#include <slipmode/results/store.hpp>

#include <Eigen/Core>
#include <optional>
#include <string>

namespace slipmode::results {

/// FILE of a model named "rom:FILE"; nothing for another name.
[[nodiscard]] std::optional<std::string> reduced_file(const std::string& model);

/// Basis of a file that 'slipmode reduce' made. @param size  of the full model
/// @throws InvalidInput  for a file without a reduced model, or one of another size
[[nodiscard]] pod::Basis reduced_basis(const StoreReader& store, Eigen::Index size);

}  // namespace slipmode::results
