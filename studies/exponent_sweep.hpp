#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include <slipmode/studies/run_options.hpp>

#include <string>
#include <vector>

namespace slipmode::studies {

/// Leading exponents of one model over a key, below the bifurcation diagram where a belt drives.
struct ExponentSweep {
  std::vector<diagnostics::SweepPoint> diagram;  ///< empty but under a belt
  std::vector<results::ExponentPoint> points;    ///< in the order of the values
};

struct ExponentSweepOptions {
  diagnostics::TangentOptions tangent = {};  ///< of each value; without transient where the diagram has settled it
  bool follow = false;                       ///< the diagram: each value starts where the one before it ended
  results::Journal* journal = nullptr;       ///< keeps finished values and gives back earlier ones
};

/// A value, of all models, can be computed alone; where the diagram's values follow each other, none.
[[nodiscard]] Pieces pieces(const std::vector<double>& values, const ExponentSweepOptions& options);

/// One sweep per family, in their order: each over its one key, from its start. A value that fails is recorded in its
/// point; one that the journal leaves to others is in none.
/// @param families  models side by side, the full one first
/// @throws Interrupted  when the stop flag was set
[[nodiscard]] std::vector<ExponentSweep> exponent_sweeps(const std::vector<Family>& families,
                                                         const std::vector<double>& values,
                                                         const ExponentSweepOptions& options, const RunOptions& run);

}  // namespace slipmode::studies
