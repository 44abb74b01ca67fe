#pragma once

#include <slipmode/results/store.hpp>
#include "report/internal/json.hpp"

namespace slipmode::report {

/// What moves in a file: the last samples of a trajectory, one period of an orbit, or modes. Null where nothing does,
/// the file does not say of which structure, or that has more than 2000 degrees of freedom.
[[nodiscard]] Json animation_json(const results::StoreReader& store);

}  // namespace slipmode::report
