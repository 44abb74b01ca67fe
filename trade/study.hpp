#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/core/sharing.hpp>
#include <slipmode/trade/clock.hpp>
#include <slipmode/trade/measures.hpp>
#include <slipmode/trade/pareto.hpp>
#include <slipmode/trade/schedule.hpp>
#include <slipmode/trade/variant.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::trade {

/// One configuration, measured.
struct Row {
  Variant variant;
  Values error = {};  ///< against the reference [%]
  /// Scatter of each error [%]: of kDx and kDe the standard error over the starts; of the others how far independent
  /// runs of the reference are from each other, or, where StudyOptions::resolve is given, the row's own standard error.
  Values noise = {};
  RunCost cost = {};
  double basis_seconds = 0.0;  ///< what its basis took to make; 0 for a full model [s of clock]
  std::string failure = {};    ///< empty, or why there are no errors

  [[nodiscard]] Offer offer(Measure measure) const {
    return {.cost = cost.cpu, .error = at(error, measure), .noise = at(noise, measure)};
  }
};

/// Errors of one configuration, as a resumed study takes them over.
struct Finished {
  Values error = {}, noise = {};
  std::string failure = {};
};

/// Runs of one configuration at most, see StudyOptions::resolve.
inline constexpr int kMostRuns = 16;

struct StudyOptions {
  Schedule schedule = {};
  /// More configurations, of all measured so far; asked again until it gives none that is new, by name. What is left to
  /// other processes is of the first ones alone. Empty function: none.
  std::function<std::vector<Variant>(const std::vector<Row>&)> more = {};
  /// The change of a statistic that matters [%]: every configuration then runs as often as the scatter of the
  /// reference's runs needs to tell it, twice at least and kMostRuns times at most. Empty: once.
  std::optional<double> resolve = {};
  /// True for a motion known to die out, see Study::dies_out.
  bool dies_out = false;
  ParallelOptions parallel = {};  ///< parallel.progress counts configurations, then timed runs
  /// What an earlier study found, by name, and where to keep what is found now; empty functions: nothing kept.
  /// Times are always taken anew: those of another process compare with nothing.
  std::function<std::optional<Finished>(const std::string& name)> recall = {};
  std::function<void(const std::string& name, const Finished&)> store = {};
  /// True for one of the first configurations that is left to another process: then nothing more is measured than the
  /// other ones' errors, and rows left have none. Empty function: none is left.
  std::function<bool(std::size_t number, const std::string& name)> leave = {};
  /// Configurations' errors, with processes that run beside this one. The one that leads measures the times.
  Sharing sharing = {};
};

struct Study {
  Row reference;          ///< its errors are zero, its noise is that between its own runs
  std::vector<Row> rows;  ///< in the order given, then those of `more`
  Schedule schedule;
  /// Of the reference's schedule.runs, from starts about the scene's: those that end on another motion than the scene's
  /// own start does. Scatter is of the latter.
  std::size_t elsewhere = 0;
  std::size_t shared_starts = 0;  ///< that dX and dE are of
  /// Nothing is settled that statistics could be of: the horizon begins at the scene's start and at others about it. Of
  /// a motion on a belt found out where StudyOptions::resolve is empty, once 1e-6 of its reach is left.
  bool dies_out = false;

  [[nodiscard]] std::vector<Offer> offers(Measure measure) const;
};

/// Measures configurations against a reference.
///
/// The reference runs schedule.runs times, from the scene's start and from others about it. Each configuration starts
/// from the first run's end, settles, and is compared as an attractor; and it runs beside the reference from shared
/// starts along all runs. Errors in parallel; then times, one thread alone, by turns. The errors are the same bytes for
/// any number of threads. A lean scene (Axis::kLean), found by the errors of others, is run from the
/// scene's own starts, and compared with runs of the reference that no other row was compared with.
/// @param scene  whose start the reference takes; `reference` may have another mesh
/// @throws InvalidInput      as build_case of the reference
/// @throws NumericalFailure  if the reference fails; other failures are recorded in their rows
/// @throws Interrupted       if the stop flag was set
[[nodiscard]] Study study(const scene::Scene& scene, const Variant& reference, const std::vector<Variant>& variants,
                          const std::vector<OfferedBasis>& bases, const StudyOptions& options);

}  // namespace slipmode::trade
