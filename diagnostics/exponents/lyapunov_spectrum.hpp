#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace slipmode::diagnostics {

/// What the equations say about the sum of the exponents, beside the sum itself; all per unit of time [1/s].
struct VolumeBalance {
  double viscous = 0.0;   ///< mean of −tr M⁻¹C on what sticking contacts leave free, stops' dashpots included
  double friction = 0.0;  ///< mean of −λ'(s) wᵀM⁻¹w over the contacts that slide
  /// ln |det| of saltations: reversals, and what entering and leaving stick does to the volume of what survives.
  double events = 0.0;
  double revived = 0.0;  ///< growth of the directions that stick had lost and slip gives back until the next stick
  double sum = 0.0;      ///< of the finite exponents
  int unexplained = 0;   ///< events whose volumes are not accounted for: coinciding ones; 0: the balance is complete

  /// What `sum` must be. Without stick the mean divergence, saltations included.
  [[nodiscard]] double expected() const { return viscous + friction + events - revived; }
};

/// Lyapunov exponents in descending order and how they were reached. Units of time are the system's.
struct LyapunovSpectrum {
  Eigen::VectorXd nats = {};     ///< [k, 1/s]; −∞ for directions that are lost for good
  Eigen::VectorXd error = {};    ///< see standard errors in docs/theory/lyapunov-spectrum.md; 0 beside −∞ [k]
  Eigen::MatrixXd halves = {};   ///< exponents of either half of the record [k x 2]
  Eigen::Index size = 0;         ///< N, directions there are
  Eigen::Index lost = 0;         ///< exponents of −∞ among the N
  double dimension = 0.0;        ///< Kaplan-Yorke; NaN where the k exponents are too few to tell
  double dimension_error = 0.0;  ///< by leaving out one stretch of the eight at a time
  double duration = 0.0;         ///< measured over [s]
  double interval = 0.0;         ///< of `rates` [s]
  Eigen::MatrixXd rates = {};    ///< expansion rate of every direction in every interval [k x m, 1/s]
  double shortest = 0.0;         ///< shortest time between renormalisations that was needed; 0 for a map [s]
  bool self_excited = false;     ///< no time in the equations: unless at rest, one exponent is zero
  std::optional<VolumeBalance> balance = {};  ///< with all N exponents, where PhaseVolume applies
  std::string failure = {};                   ///< empty, or why the run ended early: what was measured before is given
  dynamics::State end = {};                   ///< where it ended; empty for a map

  /// Exponents in bits per unit of time, the unit of S4 (3.25).
  [[nodiscard]] Eigen::VectorXd bits() const;
  /// The exponents as they were after each interval: means of `rates` so far [k x m].
  [[nodiscard]] Eigen::MatrixXd running() const;
  /// Largest exponent above zero by more than four standard errors.
  [[nodiscard]] bool is_chaotic() const;
  /// Not so, but above zero by more than one, or by an error that is not known (fewer than eight intervals), and
  /// neighbours part by more than a factor e over the record.
  [[nodiscard]] bool is_undecided() const;
};

struct TangentOptions {
  double transient = 1000.0;   ///< run before anything [s]
  double duration = 20000.0;   ///< measured over [s]
  double alignment = 0.1;      ///< of the duration, run before measuring so that the directions find their order
  double interval = 20.0;      ///< between renormalisations; halved by itself where directions collapse within one [s]
  Eigen::Index exponents = 0;  ///< how many, the largest; 0: all N
  std::uint64_t seed = 1;      ///< of the first directions
  dynamics::FlowOptions flow = {.audit = false};
  const StopFlag* stop = nullptr;  ///< polled at renormalisations
  ProgressCallback progress = {};  ///< after every interval
};

/// All Lyapunov exponents of a hybrid system, from its tangent flow with saltation at events.
///
/// State (q, q̇, contacts' own states), length by energy (EnergyMetric). A self-excited system has one exponent zero,
/// the direction of the motion itself; a driven one does not: its phase is a parameter. As many exponents are −∞ as
/// directions are lost at once where most contacts stick together (rigid ones; behind a spring: slide). Directions that
/// slip gives back are carried until the next stick for the balance of volumes, and never again as exponents.
///
/// Cost per unit of time: the motion's and N k more per step; independent of the interval but for k² N per interval.
/// @param start  a phase of the drive goes with start.time; a belt's clock starts at 0
/// @throws InvalidInput      for options out of range, a belt whose speed still changes after the transient
/// @throws NumericalFailure  as simulate, before 16 intervals have been measured; later ones end in `failure`
/// @throws Interrupted       if the stop flag was set
/// Source: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980); Müller, Chaos, Solitons & Fractals 5 (1995)
/// 1671; docs/theory/lyapunov-spectrum.md.
[[nodiscard]] LyapunovSpectrum lyapunov_spectrum(const dynamics::HybridSystem& system, const dynamics::State& start,
                                                 const TangentOptions& options = {});

/// Moves a state that the callable holds by one time step, and these directions with it: Dφ · directions [N x k].
using TangentMap = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& directions)>;

struct TangentMapOptions {
  Eigen::Index size = 0;       ///< N
  Eigen::Index exponents = 0;  ///< 0: all
  double time_step = 1.0;      ///< of one application; 1 for a map
  int alignment = 1000;        ///< applications before measuring
  int steps = 20000;           ///< applications measured
  std::uint64_t seed = 1;
};

/// The same for any smooth map or flow.
/// @throws InvalidInput  for options out of range, or images of another size
[[nodiscard]] LyapunovSpectrum lyapunov_spectrum(const TangentMap& step, const TangentMapOptions& options);

}  // namespace slipmode::diagnostics
