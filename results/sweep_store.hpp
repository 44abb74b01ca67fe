#pragma once

#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/scene.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// A sink that keeps finished values in a journal and takes over those it already holds. The journal must outlive it.
[[nodiscard]] diagnostics::SweepSink journal_sink(Journal& journal);

/// What a sweep was over.
struct SweepAxis {
  std::string key;    ///< "drive.speed"
  std::string label;  ///< for an axis: "belt speed V"
  std::string units;
};
[[nodiscard]] SweepAxis sweep_axis(const scene::Scene& scene, const std::string& key);
/// Writes `key`, `label` and `values` of an axis into a group.
void store_axis(StoreWriter& writer, const std::string& group, const SweepAxis& axis,
                const std::vector<double>& values);

/// Writes `group`: a table `values` (one row per value), a table `slips` (one row per slip state) and a title.
void store_sweep(StoreWriter& writer, const std::string& group, const std::string& title, const SweepAxis& axis,
                 const Units& units, const std::vector<diagnostics::SweepPoint>& points);

/// "period 5", or the kind of motion.
[[nodiscard]] std::string motion_text(const diagnostics::PeriodResult& period);

/// How often each kind of motion was met: periodic ones by period, then the others.
struct MotionCount {
  std::string motion;
  std::size_t values = 0;
};
[[nodiscard]] std::vector<MotionCount> count_motions(const std::vector<diagnostics::SweepPoint>& points);

/// What "undecided" means and what to do about it; empty where no value is.
[[nodiscard]] std::string undecided_note(const std::vector<diagnostics::SweepPoint>& points, const Units& units);

}  // namespace slipmode::results
