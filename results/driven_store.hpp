#pragma once

#include <slipmode/diagnostics/attractors/driven_sweep.hpp>
#include <slipmode/diagnostics/validation/driven_compare.hpp>
#include <slipmode/results/journal.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/sweep_store.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

/// A sink that keeps finished values in a journal and takes over those it already holds. The journal must outlive it.
[[nodiscard]] diagnostics::DrivenSink driven_journal_sink(Journal& journal);

/// Names and units of what a driven sweep holds.
struct DrivenAxes {
  SweepAxis swept;
  std::string reading, reading_unit;
};

/// How much of each section a file keeps.
enum class SectionDetail {
  kAll,      ///< reading, displacement and velocity of the first contact
  kReading,  ///< the reading only
};

/// Writes `group`: a table `values` (one row per value), a table `sections` (one row per section kept) and a title.
void store_driven(StoreWriter& writer, const std::string& group, const std::string& title, const DrivenAxes& axes,
                  const Units& units, const std::vector<diagnostics::DrivenPoint>& points,
                  SectionDetail detail = SectionDetail::kAll);

/// "stick", "stick-slip, period 2", "slip, aperiodic", ...
[[nodiscard]] std::string motion_text(const diagnostics::DrivenMotion& motion);

/// How often each motion was met, most frequent first.
[[nodiscard]] std::vector<MotionCount> count_motions(const std::vector<diagnostics::DrivenPoint>& points);

/// How to wait longer, where motions still settle; else empty. @param cycles  run at each value
[[nodiscard]] std::string unsettled_note(const std::vector<diagnostics::DrivenPoint>& points, double cycles);

/// "16.9 Hz (1.2e-04), ..."
[[nodiscard]] std::string peaks_text(const std::vector<diagnostics::AmplitudePeak>& peaks);

}  // namespace slipmode::results
