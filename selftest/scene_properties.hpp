#pragma once

#include <slipmode/core/parallel.hpp>
#include "selftest/law_scan.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace slipmode::selftest {

/// What one random scene showed.
struct SceneCheck {
  std::uint64_t index = 0;
  ScanFigures scan;
  double energy = 0.0;       ///< |residual| of the energy audit
  double restart = 0.0;      ///< distance at the end between the run and one taken up at an event, mode and all
  double cut = 0.0;          ///< the same of the run and one in two pieces
  double reduction = 0.0;    ///< distance at the end between full and all-modes reduced model, as a share of sizes
  std::string refused;       ///< why, in a word or two, where the method says with a message that this is beyond it
  bool still = false;        ///< nothing moved: not judged
  std::uint64_t digest = 0;  ///< of final state and event times
  std::vector<Violation> violations;
};

/// Builds a scene, runs it and checks:
/// - its text: parse, write, parse again gives the same text and the same matrices;
/// - the run, by scan_run with samples a hundredth of the flow's largest step apart;
/// - the energy audit, and of one scene in four that of a longer run;
/// and where rounding does not say what follows (ScanFigures::coasts):
/// - the run taken up again at one of its events, in the mode it is in (exactly on a guard);
/// - the run in two pieces, cut anywhere, a little before and a little after an event: same state at the end, same
///   events in either piece, but for those that runs from starts rounded otherwise have at other times;
/// - the model reduced on all modes of a random basis with a random mean, and of one of the house's own (natural modes,
///   with static ones, proper orthogonal ones in either metric): same modes at the end, same state.
/// Cost some milliseconds.
/// @param seed, index  choose that event and the bases
[[nodiscard]] SceneCheck check_scene(const std::string& text, std::uint64_t seed, std::uint64_t index);

/// The same of scene `index` of `seed` (random_scene.hpp).
[[nodiscard]] SceneCheck check_random_scene(std::uint64_t seed, std::uint64_t index);

/// Many scenes together.
struct SceneSurvey {
  std::int64_t scenes = 0, still = 0;
  std::int64_t coasting = 0;                    ///< what slides by rounding alone: not compared with other runs
  std::map<std::string, std::int64_t> refused;  ///< how many for each reason
  ScanFigures scan;
  double energy = 0.0, restart = 0.0, cut = 0.0, reduction = 0.0;  ///< largest
  std::uint64_t digest = 0;        ///< of all scenes' digests in order: the same for any threads
  std::vector<SceneCheck> failed;  ///< those with violations, in order

  /// Adds the scenes that follow. Digests depend on how a survey is cut into blocks.
  void merge(SceneSurvey next);
};

/// Scenes first … first + count − 1 of a seed, on several threads. @throws Interrupted
[[nodiscard]] SceneSurvey survey_random_scenes(std::uint64_t seed, std::uint64_t first, std::uint64_t count,
                                               const ParallelOptions& parallel);

/// Runs `starts` starts of scene `index` at once on one shared system, then again in order on one thread.
/// @return true when all bytes of the final states and event times agree
[[nodiscard]] bool same_bytes_on_threads(std::uint64_t seed, std::uint64_t index, int threads, int starts = 8);

}  // namespace slipmode::selftest
