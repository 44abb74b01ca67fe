#pragma once

#include <slipmode/orbits/shooting.hpp>
#include <slipmode/results/branch_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/run_options.hpp>

#include <optional>
#include <vector>

namespace slipmode::studies {

/// Which periodic orbit is looked for and from where.
struct OrbitSearch {
  int order = 1;        ///< period in periods of the drive
  double period = 0.0;  ///< 0: order times the drive's; on a belt from a simulated recurrence [s]
  int segments = 1;     ///< of multiple shooting
  bool half = false;    ///< look for a symmetric orbit by its half period
  double tolerance = 1e-11;
  int iterations = 30;
  /// Where Newton's method begins, a state of the full model also when a reduced one is searched. Empty: the scene's
  /// start, or the end of a run from there.
  std::optional<dynamics::State> guess = {};
  bool settles = true;  ///< without a guess: a run from the scene's start comes first
  double settle = 0.0;  ///< its length in periods of the drive, or time on a belt [s]; 0: what [time] leaves out
};

/// Newton's start and options for a search.
struct SearchStart {
  dynamics::State guess;
  orbits::ShootingOptions options;
};
/// @throws InvalidInput  for a period that is no multiple of the drive's, an order without a periodic drive, a start
///                       without a period on a belt
[[nodiscard]] SearchStart search_start(const Family& model, const OrbitSearch& search);

/// A periodic orbit of the family's own model.
/// @throws InvalidInput  as search_start and orbits::shoot
[[nodiscard]] orbits::ShootingResult find_orbit(const Family& model, const OrbitSearch& search = {});

struct ContinuationRequest {
  double from = 0.0, to = 0.0;          ///< of the family's one key
  bool switches = false;                ///< also the branches that leave at symmetry breakings and period doublings
  bool sequential = false;              ///< step the key instead of the arc length: a fold ends the branch
  double step = 0.01, max_step = 0.02;  ///< along the branch; 1 is the range, or the orbit's size
  int max_points = 2000;
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

/// Branches of periodic orbits over a key.
struct Continuation {
  orbits::ShootingResult found;                ///< the orbit they begin with
  double start = 0.0;                          ///< the key's value there
  std::vector<results::NamedBranch> branches;  ///< the main one first; none where no orbit was found
};

/// Finds an orbit at the scene's own value of the key when that lies in the range, and follows it both ways; else at
/// `from`, one way.
/// @throws InvalidInput  as family_over and search_start
/// @throws Interrupted   when the stop flag was set
[[nodiscard]] Continuation continue_orbit(const scene::Scene& scene, const std::string& key,
                                          const std::optional<pod::NamedBasis>& basis, const OrbitSearch& search,
                                          const ContinuationRequest& request, const RunOptions& run = {});

}  // namespace slipmode::studies
