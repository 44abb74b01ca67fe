#pragma once

#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/results/store.hpp>
#include "cli/session.hpp"

#include <vector>

namespace slipmode::cli {

/// Settling times and period detection of [validation], for attractors and orbits.
[[nodiscard]] diagnostics::SettleOptions settle_options(const scene::Scene& scene);

/// The same at each value of a sweep: waits no longer than `sweep_limit`, and audits nothing.
[[nodiscard]] diagnostics::SettleOptions sweep_settle_options(const scene::Scene& scene);

/// POMs and LNMs of the same ensemble, the kind that [reduction] names first.
///
/// Both are taken about the ensemble's mean, as S4 measures both from the static deflection: so only the directions
/// differ, and LNMs are not charged for a static deflection that a few of them cannot represent.
[[nodiscard]] std::vector<diagnostics::Candidate> pom_and_lnm(const scene::Scene& scene,
                                                              const fem::Structure& structure,
                                                              const pod::PodResult& result);

/// What a file offers for comparison: POMs and LNMs for a POD or an ensemble, the model itself for a reduced model.
/// @throws InvalidInput  when it holds none of them, or is of another size
[[nodiscard]] std::vector<diagnostics::Candidate> load_candidates(const scene::Scene& scene,
                                                                  const fem::Structure& structure,
                                                                  const std::string& file);

/// What the verdict runs by [validation] and [time]: exponents over a fifth of lyapunov_duration, a record
/// of 2,000 to 20,000 samples.
[[nodiscard]] diagnostics::ModelVerdictOptions verdict_options(const scene::Scene& scene);

/// [validation] and [reduction] as options; progress, stop flag and sink are left to the caller.
[[nodiscard]] diagnostics::ValidationOptions validation_options(const scene::Scene& scene,
                                                                const std::vector<diagnostics::Candidate>& candidates);

}  // namespace slipmode::cli
