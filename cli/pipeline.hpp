#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include "cli/session.hpp"
#include "cli/steps.hpp"
#include "cli/validation_report.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// A part that the scene does not ask for, and the table of the scene that brings it.
struct LeftOut {
  std::string what, brought_by;
};
/// Parts of the pipeline that a scene's tables leave out.
[[nodiscard]] std::vector<LeftOut> left_out_of(const scene::Scene& scene);
/// The same for a program's and a person's summary; nothing where nothing is left out.
[[nodiscard]] Json to_json(const std::vector<LeftOut>& left_out);
[[nodiscard]] std::string left_out_text(const std::vector<LeftOut>& left_out);
/// True where a scene has what modes and reduced models are made of: an ensemble is asked for, or what needs one is.
[[nodiscard]] bool gathers_ensemble(const scene::Scene& scene);

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
  std::vector<LeftOut> left_out;
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
