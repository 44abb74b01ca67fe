#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/pod/basis.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <filesystem>
#include <memory>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// [validation] and [reduction] as options; progress, stop flag and sink are left to validate.
/// @param bases  to be compared, the one that the number of modes is chosen by first
[[nodiscard]] diagnostics::ValidationOptions validation_options(const scene::Scene& scene,
                                                                const std::vector<pod::NamedBasis>& bases);

struct ValidationRequest {
  bool sweep = true;
  bool verdict = false;

  static constexpr auto fields() {
    using Own = ValidationRequest;
    return std::tuple{
        optional("sweep", &Own::sweep, "", "compare over the speeds or frequencies of [validation] too"),
        optional("verdict", &Own::verdict, "", "belt: exponents, dimensions and statistics side by side too")};
  }
};

/// A comparison, of a belt's scene or one under a shaker or a force, and what is kept of it: tables, sweeps and
/// portraits. A share of it, as one of several processes computes, is values of its sweeps alone.
struct Validation {
  scene::Scene scene;   ///< with its times, as compared
  FileProgress values;  ///< of the sweeps
  std::shared_ptr<const diagnostics::ValidationReport> belt;
  std::shared_ptr<const diagnostics::DrivenValidationReport> driven;
  results::Content content;
};

/// Reduced models against the full one, under a belt or, over [validation] frequencies or at the drive's own where
/// there are none, a shaker or a force.
/// @param bases  a result that load_bases takes
/// @param file   written, and resumable; empty: none
/// @param division  of the sweeps' values: a sweep that follows at its chains
/// @throws InvalidInput  for a basis of another size, a verdict under a shaker or a force
/// @throws Interrupted   when the stop flag was set; what was finished is kept beside the file
Validation validate(const scene::Scene& scene, const results::StoreReader& bases, const ValidationRequest& request,
                    const std::filesystem::path& file, const RunOptions& run, const Division& division = {});
/// The same of bases at hand, the one that the number of modes is chosen by first; the scene has its own times.
Validation validate(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                    const ValidationRequest& request, const std::filesystem::path& file, const RunOptions& run,
                    const Division& division = {});

}  // namespace slipmode::studies
