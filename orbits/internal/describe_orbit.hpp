#pragma once

#include "orbits/internal/shooting_problem.hpp"

namespace slipmode::orbits {

/// The middle of the longest stretch between events of a closed trajectory, as a time after its start [s]. Without
/// events: 0.
[[nodiscard]] double middle_of_longest_stretch(double start_time, double period,
                                               const std::vector<dynamics::Event>& events);

/// Distance in time from the start to the nearest event, either way round [s]; infinite without events.
[[nodiscard]] double distance_to_events(double start_time, double period, const std::vector<dynamics::Event>& events);

/// Everything an orbit says about itself, from a converged evaluation: fundamental matrix, multipliers, regimes, word,
/// symmetry, grazing, family.
[[nodiscard]] PeriodicOrbit describe_orbit(ShootingProblem& problem, const ShootingEvaluation& at,
                                           const ShootingOptions& options);

}  // namespace slipmode::orbits
