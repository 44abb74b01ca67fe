#pragma once

#include <slipmode/results/store.hpp>
#include <slipmode/studies/run_options.hpp>
#include "report/internal/json.hpp"

namespace slipmode::report {

/// The motions behind a bifurcation diagram, computed now: what the full model and reduced ones of up to eight numbers
/// of modes settle to at up to 64 speeds of the validation's sweep, and the motion itself at about 24 of them, the
/// scene's own and those of its orbits among them. Null where there is no belt, no sweep, no reduced model, or more
/// than 2000 degrees of freedom.
/// @param bases  the POD beside the validation
[[nodiscard]] Json linked_motions(const results::StoreReader& validation, const results::StoreReader& bases,
                                  const studies::RunOptions& run);

}  // namespace slipmode::report
