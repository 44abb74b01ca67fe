#pragma once

#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/shaken_modes.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::studies {

/// A part that the scene does not ask for, and the table of the scene that brings it.
struct LeftOut {
  std::string what, brought_by;
};

/// What the whole pipeline did, in the order it did it. Parts the scene does not ask for are empty.
struct PipelineResult {
  struct Stage {
    std::string name;
    double wall = 0.0;  ///< [s]
  };
  std::vector<Stage> stages;
  Eigen::VectorXd slipping, sticking;                ///< lowest circular frequencies [rad/s]
  std::optional<diagnostics::EnsembleRun> ensemble;  ///< without its snapshots
  Eigen::Index snapshots = 0;
  std::optional<pod::PodResult> pod;                                ///< under a belt
  std::optional<results::ShakenModes> shaken_modes;                 ///< under a shaker
  Eigen::Index chosen = 0;                                          ///< modes of the reduced models written
  std::string reduced = {};                                         ///< "POM", "LNM": what [reduction] names
  double captured = 0.0;                                            ///< share of the energy in so many of these
  std::shared_ptr<const diagnostics::ValidationReport> validation;  ///< under a belt
  std::shared_ptr<const diagnostics::DrivenValidationReport> driven_validation;  ///< under a shaker or a force
  std::vector<LeftOut> left_out;
  std::vector<std::string> files, figures;  ///< names in the folder

  /// Wall time of ensemble, POD and reduction: what a reduced model costs before its first run [s].
  [[nodiscard]] double basis_wall() const;
};

/// From a scene to figures: modes, a trajectory, an ensemble, proper orthogonal modes, reduced models, their comparison
/// with the full one. Runs what the scene's tables ask for and leaves files and figures in `folder`, which exists.
/// @throws InvalidInput, NumericalFailure  as the parts; what was finished stays in the folder
/// @throws Interrupted  when the stop flag was set; the same call goes on from there
PipelineResult pipeline(const scene::Scene& scene, const std::filesystem::path& folder, const RunOptions& run = {});

}  // namespace slipmode::studies
