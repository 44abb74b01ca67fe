#include <slipmode/diagnostics/attractors/driven_sweep.hpp>

#include <slipmode/diagnostics/model.hpp>
#include <slipmode/rom/reduce.hpp>

#include <utility>

namespace slipmode::diagnostics {

DrivenModel driven_model(const DrivenCase& full, DriveAt drive) {
  return [full, drive = std::move(drive)](double parameter) {
    return DrivenCase{full.system.with_drive(drive(parameter)), full.readings, full.energy_offset};
  };
}

DrivenCase reduced_case(const DrivenCase& full, const pod::Basis& basis) {
  DrivenCase reduced{.system = rom::reduce(full.system, basis),
                     .readings = {.rows = full.readings.rows * basis.vectors, .offset = full.readings.offset},
                     .energy_offset = full.energy_offset + projection_energy(full.system, basis)};
  if (basis.mean.size() > 0) reduced.readings.offset = full.readings.of(basis.mean).col(0);
  return reduced;
}

DrivenSweep driven_sweep(const DrivenModel& model, const std::vector<double>& values, const dynamics::State& start,
                         const DrivenSweepOptions& options) {
  DrivenOptions driven = options.driven;
  driven.stop = options.parallel.stop;
  const auto settle = [&](std::size_t i, int, const dynamics::State& from) {
    const DrivenCase here = model(values[i]);
    DrivenMotion motion = settle_driven(here.system, here.readings, from, driven);
    motion.mean_energy += here.energy_offset;
    return motion;
  };
  return SweepRunner<DrivenMotion, dynamics::State>({.settle = settle,
                                                     .carry = [](const DrivenMotion& motion) { return motion.end; },
                                                     .leader = options.model},
                                                    values, start, options.mode, options.segments, options.parallel,
                                                    options.sink)
      .run_alone();
}

}  // namespace slipmode::diagnostics
