#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// A scene's full model, where it starts, and the bases of reduced ones beside it.
struct Subjects {
  dynamics::HybridSystem full;
  dynamics::State start;
  std::vector<pod::NamedBasis> bases;
};
/// @param files  a POD, an ensemble or a reduced model each
/// @param modes  as load_chosen_bases
/// @throws InvalidInput  for files without a basis, or more modes than there are
[[nodiscard]] Subjects subjects_of(const scene::Scene& scene, const std::vector<std::string>& files,
                                   Eigen::Index modes = 0);

/// How exponents are measured where the scene's own way is not wanted.
struct ExponentRequest {
  Eigen::Index exponents = 0;                                ///< 0: all, eight of more than 64 directions
  std::optional<double> transient, duration, interval = {};  ///< [s]
};
/// Times as asked, else by the scene: its transient; the longer of duration and transient, or 500 periods of a drive;
/// a thousand intervals, or one per period.
[[nodiscard]] diagnostics::TangentOptions tangent_options(const scene::Scene& scene, const dynamics::HybridSystem& full,
                                                          const ExponentRequest& request, const RunOptions& run = {});

/// Exponents of all subjects, the full one first, side by side. A model that fails says why, unless it is alone.
[[nodiscard]] std::vector<results::ModelExponents> model_exponents(const Subjects& subjects,
                                                                   const diagnostics::TangentOptions& options,
                                                                   const RunOptions& run = {});

/// Exponents, dimensions, delay, embedding, spectrum and stick of all subjects side by side.
/// @throws as diagnostics::model_verdict
[[nodiscard]] diagnostics::VerdictTable model_verdict(const scene::Scene& scene, const Subjects& subjects,
                                                      const diagnostics::TangentOptions& options,
                                                      const RunOptions& run = {});

}  // namespace slipmode::studies
