#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/studies/command.hpp>
#include <slipmode/studies/exponents.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <string>
#include <vector>

namespace slipmode::studies {

/// One of the models that stand side by side over a key.
struct SweptModel {
  std::string title;
  std::string role;  ///< "full" or "reduced"
  Family family;
};
/// The scene's full model, and a reduced one beside it on the first of the bases: of a POD, which gives POMs and LNMs,
/// the kind that [reduction] names.
/// @param bases  a POD, an ensemble or a reduced model, or none
/// @param modes  as subjects_of
/// @throws InvalidInput  as check_values and subjects_of; for more than one of `bases`
[[nodiscard]] std::vector<SweptModel> swept_models(const scene::Scene& scene, const Over& over,
                                                   const std::vector<results::StoreReader>& bases,
                                                   Eigen::Index modes = 0);

/// Leading exponents of one model over a key, below the bifurcation diagram where a belt drives.
struct ExponentSweep {
  std::vector<diagnostics::SweepPoint> diagram;  ///< empty but under a belt
  std::vector<results::ExponentPoint> points;    ///< in the order of the values
};

struct ExponentSweepOptions {
  diagnostics::TangentOptions tangent = {};  ///< of each value; without transient where the diagram has settled it
  bool follow = false;                       ///< the diagram: each value starts where the one before it ended
  results::Journal* journal = nullptr;       ///< keeps finished values and gives back earlier ones
};

/// As tangent_options, but four exponents, and a quarter of the time of a single spectrum, where nothing else is asked.
[[nodiscard]] ExponentSweepOptions exponent_sweep_options(const scene::Scene& scene,
                                                          const std::vector<SweptModel>& models,
                                                          const ExponentRequest& request, bool follow,
                                                          const RunOptions& run = {});

/// A value, of all models, can be computed alone; where the diagram's values follow each other, none.
[[nodiscard]] Pieces pieces(const std::vector<double>& values, const ExponentSweepOptions& options);

/// What was asked, and of which models, for provenance and journals.
[[nodiscard]] std::string command_of(const Over& over, const std::vector<SweptModel>& models,
                                     const ExponentSweepOptions& options);
[[nodiscard]] std::string identity_of(const std::vector<SweptModel>& models);

/// One sweep per model, in their order: each over its one key, from its start. A value that fails is recorded in its
/// point; one that the journal leaves to others is in none.
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] std::vector<ExponentSweep> exponent_sweeps(const std::vector<SweptModel>& models,
                                                         const std::vector<double>& values,
                                                         const ExponentSweepOptions& options, const RunOptions& run);
void store(results::StoreWriter& writer, const std::vector<SweptModel>& models,
           const std::vector<ExponentSweep>& sweeps);

}  // namespace slipmode::studies
