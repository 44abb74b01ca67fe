#pragma once

#include "cli/session.hpp"
#include "cli/steps.hpp"
#include "diagnostics/validate.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// What the whole pipeline did, in the order it did it. Parts the scene does not ask for are empty.
struct PipelineResult {
  struct Stage {
    std::string name;
    double wall = 0.0;  ///< [s]
  };
  std::vector<Stage> stages;
  Eigen::VectorXd slipping, sticking;                ///< lowest circular frequencies
  std::optional<diagnostics::EnsembleRun> ensemble;  ///< without its snapshots
  Eigen::Index snapshots = 0;
  std::optional<pod::PodResult> pod;
  Eigen::Index chosen = 0;
  std::optional<diagnostics::ValidationReport> validation;
  std::vector<std::string> files, figures;  ///< names in the folder

  /// Wall time of ensemble, POD and reduction: what a reduced model costs before its first run [s].
  [[nodiscard]] double basis_wall() const;
};

/// Runs what the scene asks for and leaves files and figures in `folder`.
[[nodiscard]] PipelineResult run_pipeline(const Session& session, const scene::Scene& scene,
                                          const std::filesystem::path& folder);

/// Summary of a pipeline for programs and for people.
[[nodiscard]] Json to_json(const PipelineResult& result, const scene::Scene& scene);
[[nodiscard]] std::string summary_text(const PipelineResult& result, const scene::Scene& scene);

}  // namespace slipmode::cli
