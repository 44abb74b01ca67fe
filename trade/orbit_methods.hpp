#pragma once

#include <slipmode/core/none.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/trade/variant.hpp>

#include <string>
#include <vector>

namespace slipmode::trade {

/// A way to the periodic orbit of a scene under a force, other than shooting.
struct OrbitMethod {
  Axis axis = Axis::kHarmonics;  ///< kHarmonics, kSamples: a balance; kMixed: contacts in the time domain
  int harmonics = 9;
  int samples = 0;  ///< of a balance; 0: exact forces
  int near = 0;     ///< of a mixed orbit: orbits::MixedOptions::reach

  /// "balance, 9 harmonics", "balance, 25 harmonics, 128 samples", "mixed, 9 harmonics, near 1"
  [[nodiscard]] std::string name() const;
  /// Of `slipmode orbit find`: "--by mixed --harmonics 9 --near 1".
  [[nodiscard]] std::string options() const;
};

/// The methods along an axis. Empty where the scene's contacts, drive or size have none: balances hold stops and
/// friction behind springs, under a force or a shaker; the mixed method what the closed form does, under a force, and
/// needs a rest away from the contacts; and the exact orbit at most kAffordableSize degrees of freedom.
[[nodiscard]] std::vector<OrbitMethod> orbit_methods(Axis axis, const scene::Scene& scene);

/// One method, measured.
struct OrbitRow {
  std::string name, options;  ///< as OrbitMethod has them
  Axis axis = Axis::kScene;
  double error = kNone;  ///< sup over the period of |y − y_exact|, largest share of a contact's half range [%]
  /// Finding it from nothing: median, least and largest [s of processor]. What takes a tenth of a second runs once.
  double cpu = kNone, cpu_low = kNone, cpu_high = kNone;
  std::string failure = {};  ///< why it has no error; empty: it has
  std::string other = {};    ///< word of the orbit behind, where it is another one than the reference
};

/// Ways to a scene's periodic orbit.
struct OrbitStudy {
  OrbitRow reference;  ///< Newton's shooting from what the scene settles to: exact
  std::string word;    ///< of the orbit it found
  std::vector<OrbitRow> rows;
};

/// Solves with each method and measures its distance from the exact orbit: the reference's, or, where that is another
/// one or one of a family, the one behind. Then all are timed by turns.
/// @param repeats  timed runs of each, ≥ 1
/// @throws Interrupted  if the stop flag was set
[[nodiscard]] OrbitStudy study_orbits(const scene::Scene& scene, const std::vector<OrbitMethod>& methods, int repeats,
                                      const ParallelOptions& options = {});

/// One sentence: the fastest that keeps to a limit [%], beside shooting.
[[nodiscard]] std::string recommendation(const OrbitStudy& study, double limit);

}  // namespace slipmode::trade
