#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/memory_store.hpp>
#include <slipmode/studies/command.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/run_options.hpp>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// Which periodic orbit is looked for and from where.
struct OrbitSearch {
  int order = 1;
  double period = 0.0;
  int segments = 1;
  bool half = false;
  double tolerance = 1e-11;
  int iterations = 30;
  /// Where Newton's method begins, a state of the full model also when a reduced one is searched. Empty: the scene's
  /// start, or the end of a run from there.
  std::optional<dynamics::State> guess = {};
  bool settles = true;  ///< without a guess: a run from the scene's start comes first
  double settle = 0.0;

  static constexpr auto fields() {
    using Own = OrbitSearch;
    return std::tuple{
        optional("order", &Own::order, "", "period in periods of the drive", kCount),
        optional("period", &Own::period, "s",
                 "0: order times the drive's; on a belt a guess, by default from a simulated recurrence", kNonNegative),
        optional("segments", &Own::segments, "", "of multiple shooting; 1: single shooting",
                 {.low = 1.0, .high = 10000.0}),
        optional("symmetric", &Own::half, "", "look for a symmetric orbit by its half period"),
        optional("tolerance", &Own::tolerance, "1", "bound on the orbit's relative mismatch after a period", kPositive),
        optional("iterations", &Own::iterations, "", "Newton steps at most", kCount),
        optional("settle", &Own::settle, "",
                 "length of the run before, in periods of the drive, or time on a belt; 0: as [time] says",
                 kNonNegative)};
  }
};

/// Newton's start and options for a search.
struct SearchStart {
  dynamics::State guess;
  orbits::ShootingOptions options;
};
/// What of a search is not its start.
[[nodiscard]] orbits::ShootingOptions shooting_options(const Family& model, const OrbitSearch& search);
/// @throws InvalidInput  for a period that is no multiple of the drive's, an order without a periodic drive, a start
///                       without a period on a belt
[[nodiscard]] SearchStart search_start(const Family& model, const OrbitSearch& search);

/// A periodic orbit of the family's own model.
/// @throws InvalidInput  as search_start and orbits::shoot
[[nodiscard]] orbits::ShootingResult find_orbit(const Family& model, const OrbitSearch& search = {});

struct ContinuationRequest {
  double from = 0.0, to = 0.0;  ///< of the family's one key
  bool switches = false;
  bool sequential = false;
  double step = 0.01, max_step = 0.02;
  int max_points = 2000;

  static constexpr auto fields() {
    using Own = ContinuationRequest;
    return std::tuple{
        optional("switch", &Own::switches, "",
                 "also follow the branches that leave at symmetry breakings and period doublings"),
        optional("sequential", &Own::sequential, "", "step the key instead of the arc length: a fold ends the branch"),
        optional("step", &Own::step, "1", "first step along the branch; 1 is the range, or the orbit's size",
                 kPositive),
        optional("max_step", &Own::max_step, "1", "largest step", kPositive),
        optional("points", &Own::max_points, "", "orbits per branch at most", {.low = 2.0, .high = 1e7})};
  }
};

/// A model over one key, where it starts and how it is followed.
struct KeyFamily {
  double start = 0.0;  ///< the scene's own value where the range holds it, else its first end
  Family family;
  dynamics::SystemFamily systems;  ///< stops when the run is interrupted
  orbits::ContinuationOptions options;
};

/// @throws InvalidInput  for a key that cannot be varied continuously, and a scene that refuses an end of the range
[[nodiscard]] KeyFamily family_over(const scene::Scene& scene, const std::string& key,
                                    const std::optional<pod::NamedBasis>& basis, const ContinuationRequest& request,
                                    const RunOptions& run);

/// @param model  as model_basis
[[nodiscard]] std::string command_of(const std::string& key, const std::string& model, const OrbitSearch& search,
                                     const ContinuationRequest& request);

/// Branches of periodic orbits over a key.
struct Continuation {
  orbits::ShootingResult found;                ///< the orbit they begin with
  double start = 0.0;                          ///< the key's value there
  std::vector<results::NamedBranch> branches;  ///< the main one first; none where no orbit was found
};

/// Finds an orbit at the scene's own value of the key when that lies in the range, and follows it both ways; else at
/// `from`, one way.
/// @throws InvalidInput  as family_over and search_start
/// Where the stop flag is set on its way, the branch being followed ends there (BranchEnd::kInterrupted).
/// @throws Interrupted   when it was set before the first orbit was found
[[nodiscard]] Continuation continue_orbit(const scene::Scene& scene, const std::string& key,
                                          const std::optional<pod::NamedBasis>& basis, const OrbitSearch& search,
                                          const ContinuationRequest& request, const RunOptions& run = {});

/// Whether one of them was stopped on its way.
[[nodiscard]] bool is_interrupted(const std::vector<results::NamedBranch>& branches);

/// Writes an orbit, if there is one, with one period of it, sampled, and where it came from.
void store(results::StoreWriter& writer, const Family& model, const orbits::PeriodicOrbit* orbit);
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const orbits::PeriodicOrbit> orbit);

/// What is kept of branches: every point with its orbit, computed when it is written.
/// @param command  what was asked, for provenance
/// @throws Interrupted  when written after the stop flag was set
[[nodiscard]] results::Content content_of(const Family& model, double start,
                                          std::shared_ptr<const std::vector<results::NamedBranch>> branches,
                                          const std::string& command, const RunOptions& run = {});

}  // namespace slipmode::studies
