#pragma once

#include <slipmode/diagnostics/attractors/driven.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/pod/basis.hpp>

#include <functional>
#include <vector>

namespace slipmode::diagnostics {

/// A system under a shaker or a force, and what is read from it.
struct DrivenCase {
  dynamics::HybridSystem system;
  Readings readings = {};
  double energy_offset = 0.0;  ///< added to mean energies, as Model::energy_offset [J]
};

/// A driven model for every value of a parameter: the drive's frequency, amplitude, friction, stiffness, load …
/// Called from several threads at once: must not change anything.
using DrivenModel = std::function<DrivenCase(double parameter)>;

/// The drive at a value of the parameter (a shaker's frequency, with its amplitude there).
using DriveAt = std::function<friction::Drive(double parameter)>;

/// The model whose drive alone depends on the parameter; modal data are shared by all values.
[[nodiscard]] DrivenModel driven_model(const DrivenCase& full, DriveAt drive);

/// A case projected on a basis: the same readings, taken of the lifted state. Energies are those of the lifted state.
/// @throws InvalidInput  as rom::reduce
[[nodiscard]] DrivenCase reduced_case(const DrivenCase& full, const pod::Basis& basis);

using DrivenPoint = SweptValue<DrivenMotion>;
using DrivenSink = SinkOf<DrivenMotion>;
using DrivenSweep = SweepOf<DrivenMotion>;

struct DrivenSweepOptions {
  SweepMode mode = SweepMode::kIndependent;
  std::size_t segments = 1;  ///< as SweepOptions::segments
  int model = 0;             ///< SweptValue::model of the points: tells apart sweeps that share a sink
  DrivenOptions driven = {};
  ParallelOptions parallel = {};
  DrivenSink sink = {};
};

/// settle_driven at each value, in parallel; resumable as sweep(). In kFollow each value starts from the section state
/// at which the one before ended. Same bytes for any number of threads.
/// @param start  in the model's coordinates; its time does not matter
/// @throws InvalidInput  as sweep and settle_driven
[[nodiscard]] DrivenSweep driven_sweep(const DrivenModel& model, const std::vector<double>& values,
                                       const dynamics::State& start, const DrivenSweepOptions& options = {});

}  // namespace slipmode::diagnostics
