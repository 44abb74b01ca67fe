#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>

#include <vector>

namespace slipmode::diagnostics {

/// The numbers of modes a validation tries with a candidate: those asked for, else 1 to the size of its basis.
[[nodiscard]] std::vector<Eigen::Index> modes_to_try(const pod::NamedBasis& candidate,
                                                     const ValidationOptions& options);

/// Checks what validate is given before any run starts.
/// @throws InvalidInput  as validate
void check_validation(const dynamics::HybridSystem& full, const std::vector<pod::NamedBasis>& candidates,
                      const ValidationOptions& options);

}  // namespace slipmode::diagnostics
