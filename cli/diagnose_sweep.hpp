#pragma once

#include <slipmode/studies/exponents.hpp>
#include "cli/diagnose.hpp"
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// What a scene's models are asked for.
struct ModelRequest {
  std::vector<std::string> files;  ///< a POD, an ensemble or a reduced model each
  bool verdict = false;
  Eigen::Index modes = 0;  ///< of bases with a choice; 0: as the scene chooses
  studies::ExponentRequest exponents;
  std::string over;  ///< KEY=FROM:TO:STEP; empty: none
  bool follow = false;

  [[nodiscard]] std::vector<results::StoreReader> stores() const { return {files.begin(), files.end()}; }
};

/// Leading exponents against one key of the scene: the full model, and a reduced one of MODELS' first kind of basis,
/// below the bifurcation diagram where a belt drives. Finished values are journalled: the same command goes on after an
/// interruption.
/// @throws InvalidInput  without an output file, for more than one file of models, keys as `slipmode sweep`
[[nodiscard]] Report diagnose_over(const Session& session, const scene::Scene& scene, const DiagnoseRequest& request,
                                   const ModelRequest& models);

}  // namespace slipmode::cli
