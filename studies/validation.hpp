#pragma once

#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/run_options.hpp>

#include <filesystem>
#include <vector>

namespace slipmode::studies {

/// [validation] and [reduction] as options; progress, stop flag and sink are left to validate.
/// @param bases  to be compared, the one that the number of modes is chosen by first
[[nodiscard]] diagnostics::ValidationOptions validation_options(const scene::Scene& scene,
                                                                const std::vector<pod::NamedBasis>& bases);

/// Reduced models of a belt's scene against the full one, into a file with tables, sweeps and portraits. Resumable.
/// @param options  progress, stop flag and sink are set here
/// @throws Interrupted  when the stop flag was set; what was finished is kept beside the file
diagnostics::ValidationReport validate(const scene::Scene& scene, const std::vector<pod::NamedBasis>& bases,
                                       diagnostics::ValidationOptions options, const std::filesystem::path& file,
                                       const RunOptions& run);

/// The same under a shaker: over [validation] frequencies, or at the drive's own where there are none.
diagnostics::DrivenValidationReport validate_shaken(const scene::Scene& scene,
                                                    const std::vector<pod::NamedBasis>& bases,
                                                    const std::filesystem::path& file, const RunOptions& run);

}  // namespace slipmode::studies
