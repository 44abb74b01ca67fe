#pragma once

#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace slipmode::selftest {

/// Something that is not as it must be.
struct Violation {
  std::string property;  ///< which, in a word or two
  std::string what;      ///< time, contact, measured figure and limit
};

/// How near to zero each thing was that must be zero, or not negative; shares of the run's own scales.
struct ScanFigures {
  double guard = 0.0;     ///< deepest a guard was below zero while its regime lasted
  double law = 0.0;       ///< largest distance of a contact force from its law, of a stick's speed from the drive's
  double motion = 0.0;    ///< largest residual of M q̈ + C q̇ + K q = p + Σ d u + Σ w λ between samples
  double spurious = 0.0;  ///< largest value of the guard of an event, extrapolated to its time
  std::int64_t samples = 0;
  std::int64_t minima = 0;  ///< minima of guards between samples that were looked at 256 times finer
  std::int64_t events = 0;  ///< changes of a contact's mode
  bool coasts = false;      ///< a contact slid on at a speed of rounding

  void merge(const ScanFigures& other);
};

/// Limits for ScanFigures. Four samples continued leave (1/25)⁴ = 2.6e-6 of a guard's fastest part (3e-6 at most in
/// 79,000 scenes); what the rule for the motion leaves out is taken off before; the rest is rounding and the flow's
/// tolerance of 1e-9.
struct ScanLimits {
  double guard = 1e-8;
  double law = 1e-7;
  double motion = 1e-3;
  double spurious = 1e-4;
};

/// What the closed form tells a stop by, of what moves in its guard (docs/limits.md).
inline constexpr double kTold = 1e-12;

/// What collocation may leave the impulse of each contact off by in a step: its tolerance, of the law's largest force,
/// not of a small motion's [nc, N s]. Zero in closed form.
/// @param longest  that steps are [s]; the flow's own largest is not exceeded
[[nodiscard]] Eigen::VectorXd tolerated_impulses(const dynamics::HybridSystem& system,
                                                 const dynamics::FlowOptions& flow,
                                                 double longest = std::numeric_limits<double>::infinity());

/// Certifies a run from its samples alone: that every contact obeys the law of its mode, that no guard was passed
/// unnoticed, that modes change only where a guard is reached, and that the samples solve the equations of motion, in
/// the structure's own matrices by Boole's rule. Shares no code with the flow. A run that passes at this resolution
/// is a solution with no event missed and none too many.
///
/// Guards are evaluated at every sample; where three samples show a minimum whose parabola goes below zero, the run is
/// sampled again there, 256 times finer.
/// @param start    of the run, at time 0, internal states empty
/// @param options  of the run: samples of all dofs, events with their states
/// @param out_violations  what is beyond `limits`, at most one per property
[[nodiscard]] ScanFigures scan_run(const dynamics::HybridSystem& system, const dynamics::State& start,
                                   const dynamics::SimulateOptions& options, const dynamics::Trajectory& run,
                                   std::vector<Violation>& out_violations, const ScanLimits& limits = {});

}  // namespace slipmode::selftest
