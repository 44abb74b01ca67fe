#pragma once

#include <slipmode/scene/scene.hpp>

#include <Eigen/Core>

namespace slipmode::trade {

/// How long everything runs. On a belt from [validation] and [time]; under a shaker whole periods from [validation];
/// under a force whole periods from [time].
struct Schedule {
  double period = 0.0;           ///< of a shaker or a force; 0 on a belt [s]
  double first_transient = 0.0;  ///< of the reference's runs, from the scene's start [s]
  double transient = 0.0;        ///< of all others, from a state of the reference's motion [s]
  double duration = 0.0;         ///< then recorded [s]
  double sample = 0.0;           ///< [s]
  Eigen::Index per_section = 0;  ///< samples per period; 0 on a belt, where slips are the section points
  double horizon = 0.0;          ///< of the comparison from shared starts [s]
  double horizon_sample = 0.0;   ///< [s]
  double gap = 0.0;              ///< between shared starts along a run of the reference [s]
  int starts = 1;                ///< shared starts from each run of the reference
  int runs = 4;                  ///< independent runs of the reference, ≥ 2: all pairs of them show the scatter
  double timed = 0.0;            ///< simulated by a timed run [s]
  int repeats = 5;               ///< of each timed run
};

/// @throws InvalidInput  for a belt whose speed is not constant: its motion never settles
[[nodiscard]] Schedule schedule_of(const scene::Scene& scene);

}  // namespace slipmode::trade
