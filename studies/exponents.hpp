#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// A scene's full model, where it starts, and the bases of reduced ones beside it.
struct Subjects {
  dynamics::HybridSystem full;
  dynamics::State start;
  std::vector<pod::NamedBasis> bases;
};
/// @param bases  a POD, an ensemble or a reduced model each
/// @param modes  as load_chosen_bases
/// @throws InvalidInput  for files without a basis, or more modes than there are
[[nodiscard]] Subjects subjects_of(const scene::Scene& scene, const std::vector<results::StoreReader>& bases,
                                   Eigen::Index modes = 0);

/// How exponents are measured where the scene's own way is not wanted.
struct ExponentRequest {
  Eigen::Index exponents = 0;
  std::optional<double> transient, duration, interval = {};

  static constexpr auto fields() {
    using Own = ExponentRequest;
    return std::tuple{
        optional("exponents", &Own::exponents, "",
                 "how many, the largest; 0: all, eight of more than 64, four over a key", kFromZero),
        optional("transient", &Own::transient, "s", "run first; else that of [time]", kNonNegative),
        optional("duration", &Own::duration, "s",
                 "measured; else that of [time], or 500 periods of a drive, over a key a quarter", kPositive),
        optional("renormalise", &Own::interval, "s",
                 "between renormalisations; else a thousandth of the duration, or the drive's period", kPositive)};
  }
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

/// Exponents of models side by side, and the verdict on them where it was asked for.
struct ModelDiagnosis {
  std::vector<results::ModelExponents> exponents;
  std::optional<diagnostics::VerdictTable> verdict;
};

/// @throws InvalidInput      for more exponents than there are directions
/// @throws NumericalFailure  when the full model fails
[[nodiscard]] ModelDiagnosis diagnose_models(const scene::Scene& scene, const Subjects& subjects,
                                             const ExponentRequest& request, bool with_verdict,
                                             const RunOptions& run = {});
[[nodiscard]] results::Content content_of(const scene::Scene& scene, std::shared_ptr<const ModelDiagnosis> diagnosis);

}  // namespace slipmode::studies
