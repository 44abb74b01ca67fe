#pragma once

#include "cli/diagnose.hpp"
#include "cli/diagnose_subjects.hpp"

namespace slipmode::cli {

/// Leading exponents against one key of the scene: the full model, and a reduced one of MODELS' first kind of basis,
/// below the bifurcation diagram where a belt drives. Finished values are journalled: the same command goes on after an
/// interruption.
/// @throws InvalidInput  without an output file, for more than one file of models, keys as `slipmode sweep`
[[nodiscard]] Report diagnose_over(const Session& session, const scene::Scene& scene, const DiagnoseRequest& request,
                                   const ModelRequest& models);

}  // namespace slipmode::cli
