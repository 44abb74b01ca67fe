#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/diagnostics/validation/verdict.hpp>
#include "cli/session.hpp"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// What a scene's models are asked for.
struct ModelRequest {
  std::vector<std::string> files;  ///< a POD, an ensemble or a reduced model each
  bool verdict = false;
  Eigen::Index modes = 0;      ///< of bases with a choice; 0: as the scene chooses
  Eigen::Index exponents = 0;  ///< 0: all, eight of more than 64 directions; over a key: four
  std::optional<double> transient, duration, interval;
  std::string over;  ///< KEY=FROM:TO:STEP; empty: none
  bool follow = false;
};

/// The full model, and the reduced ones that files give.
struct DiagnoseSubjects {
  dynamics::HybridSystem full;
  dynamics::State start;
  std::vector<pod::NamedBasis> candidates;
};

/// @throws InvalidInput  for files without a basis, or more modes than there are
[[nodiscard]] DiagnoseSubjects diagnose_subjects(const scene::Scene& scene, const ModelRequest& request);

/// Times as asked, else by the scene: its transient; the longer of duration and transient, or 500 periods of a drive;
/// a thousand intervals, or one per period.
[[nodiscard]] diagnostics::TangentOptions tangent_options(const Session& session, const scene::Scene& scene,
                                                          const dynamics::HybridSystem& full,
                                                          const ModelRequest& request);

}  // namespace slipmode::cli
