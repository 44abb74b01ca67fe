#pragma once

#include <slipmode/core/sweep_runner.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace slipmode::orbits {

/// A driven motion seen once per period of the drive, at times start + k·T, after its transient.
struct Strobe {
  Eigen::MatrixXd section = {};  ///< row · q at each section kept [m x kept]
  /// (max − min)/2 of each row's displacement over the periods kept: S1 (17) [m].
  Eigen::VectorXd alternating = {};
  /// Root of the mean square about the mean over the periods kept [m]. S1 (18) is √2 times that: the amplitude of a
  /// sine, and of a sine only.
  Eigen::VectorXd effective = {};
  int order = 0;          ///< smallest number of periods after which the section repeats; 0: none up to max_order
  double mismatch = 0.0;  ///< largest distance of section states `order` apart, relative to the motion; 0 without order
  dynamics::State end = {};

  [[nodiscard]] bool is_periodic() const { return order > 0; }
  /// |√2 effective − alternating| / alternating of a row: S1 calls a motion periodic where this vanishes. It vanishes
  /// for sines; periodic motion with harmonics fails the test. @throws InvalidInput  for a row that is not there
  [[nodiscard]] double sine_gap(Eigen::Index row) const;
};

struct StrobeOptions {
  Eigen::MatrixXd rows = {};  ///< displacements watched, row · q [m x n]
  int periods = 600;          ///< of the drive, run in all, ≥ 2
  int kept = 100;             ///< of them kept, the last ones, 1 … periods − 1
  int samples = 64;           ///< per period, for amplitudes, ≥ 8: errors fall with its fourth power
  double tolerance = 1e-5;    ///< section states nearer than this, relative to the motion, are the same, > 0
  int max_order = 32;         ///< ≥ 1
  bool follow = false;        ///< each value starts where the one before it ended, in phase; values run in order then
  dynamics::FlowOptions flow = {.audit = false};
};

using StrobePoint = SweptValue<Strobe>;
using StrobeSink = SinkOf<Strobe>;
using StrobeMap = SweepOf<Strobe>;

/// One driven motion. @throws InvalidInput  for options out of range, a drive without period, and as simulate
/// @throws NumericalFailure  as simulate
[[nodiscard]] Strobe strobe(const dynamics::HybridSystem& system, const dynamics::State& start,
                            const StrobeOptions& options);

/// Settled motion over one parameter: a stroboscopic bifurcation diagram with amplitudes and verdicts. Without `follow`
/// values run side by side; the bytes are the same for any number of threads. A NumericalFailure is recorded in its
/// point; a following value then starts where the failed one did.
/// @param system  the system at a value; called from several threads
/// @param start   where its motion begins (with `follow` the first one's)
/// @throws InvalidInput  for no values, and as strobe
/// Source: S0 Figure 4.7; S1 (17)-(19), Figures 4 and 5.
[[nodiscard]] StrobeMap strobe_map(const std::function<dynamics::HybridSystem(double)>& system,
                                   const std::function<dynamics::State(const dynamics::HybridSystem&)>& start,
                                   const std::vector<double>& values, const StrobeOptions& options,
                                   const ParallelOptions& parallel = {}, const StrobeSink& sink = {});

}  // namespace slipmode::orbits
