#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/pod/basis.hpp>

namespace slipmode::diagnostics {

/// Time of one run of the same duration, full and reduced, in this process. Nothing is sampled.
struct Cost {
  double duration = 0.0;         ///< simulated [s]
  double full_wall = 0.0;        ///< median of the repeats [s of clock]
  double full_cpu = 0.0;         ///< [s of clock]
  double reduced_wall = 0.0;     ///< [s of clock]
  double reduced_cpu = 0.0;      ///< [s of clock]
  double full_setup_wall = 0.0;  ///< first run minus median: modal data, built when first needed [s of clock]
  double projection_wall = 0.0;  ///< rom::reduce and the reduced model's own set-up [s of clock]

  /// Runs of this duration after which making the basis (`basis_wall`: ensemble, decomposition) and the projection are
  /// paid for; infinite when the reduced model is not faster.
  [[nodiscard]] double break_even(double basis_wall) const;
};

/// Runs each model once to set it up, then `repeats` times by turns.
/// @param start  initial state of the full model; the reduced one starts from its projection
/// @throws InvalidInput  for duration ≤ 0, repeats < 1, and as rom::reduce
[[nodiscard]] Cost measure_cost(const dynamics::HybridSystem& full, const pod::Basis& basis,
                                const dynamics::State& start, double duration, int repeats,
                                const dynamics::FlowOptions& flow = {});

}  // namespace slipmode::diagnostics
