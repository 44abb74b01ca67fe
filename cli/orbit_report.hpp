#pragma once

#include <slipmode/orbits/shooting.hpp>
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// "1.42099, 0.148245", "-0.224835 ± 0.226077i": the first few multipliers.
[[nodiscard]] std::string multipliers_text(const Eigen::VectorXcd& multipliers);

/// Complex numbers as [[real, imaginary], …].
[[nodiscard]] Json complex_json(const Eigen::VectorXcd& values);

/// Everything about an orbit but its matrix and events; `amplitudes` as contact_amplitudes gives them.
[[nodiscard]] Json orbit_json(const dynamics::HybridSystem& system, const orbits::PeriodicOrbit& orbit,
                              const std::vector<orbits::Amplitude>& amplitudes);

/// The same for people.
[[nodiscard]] std::string orbit_text(const dynamics::HybridSystem& system, const orbits::PeriodicOrbit& orbit,
                                     const std::vector<orbits::Amplitude>& amplitudes);

/// Ends with that exit code, the reason first.
void fail_with(Report& out_report, int exit_code, const std::string& message);
/// The same, of a result that is kept as far as it came.
void incomplete(Report& out_report, int exit_code, const std::string& message);

/// How far a search came that found no orbit; what to try is in its message.
[[nodiscard]] Report not_found(const std::string& verb, const orbits::ShootingResult& result);

}  // namespace slipmode::cli
