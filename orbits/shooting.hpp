#pragma once

#include <slipmode/orbits/periodic_orbit.hpp>

#include <optional>

namespace slipmode::orbits {

struct ShootingOptions {
  int order = 1;        ///< driven: period = order × the drive's, ≥ 1
  double period = 0.0;  ///< self-excited: guess of the period, > 0 [s]
  int segments = 1;     ///< 1: single shooting. More: states at this many equal parts of the period are unknowns
  /// Starting states of the segments, in the order of time; empty: simulated from the guess. For candidates whose
  /// trajectory leaves the orbit within a period. `segments` of them, the first replaces the guess.
  std::vector<dynamics::State> segment_guesses = {};
  /// Bound on PeriodicOrbit::residual.
  double tolerance = 1e-11;
  int max_iterations = 30;
  /// Solve x(T/2) = −x(0): symmetric orbits only, regular where they lose their symmetry. Needs a symmetric system
  /// (`is_symmetric`). With a driven order that is odd.
  bool half_period = false;
  double symmetry_tolerance = 1e-8;  ///< PeriodicOrbit::symmetric
  double marginal_band = 1e-9;       ///< Stability::kMarginal
  dynamics::FlowOptions flow = {.tolerance = 1e-13, .audit = false};
};

enum class ShootingStatus : std::uint8_t {
  kConverged,
  kSingular,    ///< Φ − 1 is singular and the residual not reachable: a fold, a symmetry breaking, or no orbit near
  kStalled,     ///< no step however short lowers the residual
  kIterations,  ///< still falling after max_iterations
  kFlowFailed,  ///< the flow itself failed on the way
  kPeriodLost,  ///< the period of a self-excited orbit fell to nothing, or the orbit shrank to an equilibrium
};

[[nodiscard]] const char* to_string(ShootingStatus status);

/// How a search for an orbit ended.
struct ShootingResult {
  ShootingStatus status = ShootingStatus::kConverged;
  /// The orbit when converged. Else how far it came: the best state, period and residuals, nothing else.
  PeriodicOrbit orbit;
  /// One sentence that says what happened, with figures, and what to try. Empty when converged.
  std::string message;

  [[nodiscard]] bool converged() const { return status == ShootingStatus::kConverged; }
};

/// Newton's method for x(T; x₀) = x₀ on the tangent flow, with a trust region on the step: steps that do not lower the
/// residual are shortened. The fundamental matrix is analytic, saltation included.
///
/// Driven: T = order × period of the drive. Self-excited: T is unknown too, the phase held by fᵀδx = 0 (f the rate of
/// the state) at an origin between two events, the middle of the longest stretch free of events; the orbit is handed
/// back with its origin there, so that it is fixed by its guards; a multiple of a shorter orbit is handed back as that.
/// Orbits through stick: Φ has no full rank, and a start in stick stays consistent (wᵀq̇ = V); all systems are solved by
/// least squares of minimum norm. Floating orbits: the solution nearest to the guess, with its family.
/// @param guess  near the orbit; a start on a guard is moved off it along the trajectory
/// @throws InvalidInput  for a period that is missing or not positive, order or segments < 1, half_period on a system
///                       that is not symmetric, a drive that is neither periodic nor constant
/// Residuals are relative: displacements to the orbit's largest displacement (or its top speed × T/2π), velocities
/// likewise. Source: S0 section 3.2 and appendix A; docs/theory/orbits.md.
[[nodiscard]] ShootingResult shoot(const dynamics::HybridSystem& system, const dynamics::State& guess,
                                   const ShootingOptions& options = {});

/// `shoot`, or a failure.
/// @throws NumericalFailure  when not converged: message, best state (q, q̇, internal), residual
[[nodiscard]] PeriodicOrbit find_orbit(const dynamics::HybridSystem& system, const dynamics::State& guess,
                                       const ShootingOptions& options = {});

/// True when x → −x with half a period's shift maps motions to motions: no constant load, contacts that press equally
/// to both sides, drives with odd harmonics only (or a belt at rest), no offsets.
[[nodiscard]] bool is_symmetric(const dynamics::HybridSystem& system);

/// The state after a simulated time, a multiple of the drive's period where there is one: what to shoot from.
/// @param periods  of the drive; of 2π/ω₁-like length `unit` where the drive has none
/// @param unit     [s]; needed for a constant drive only
[[nodiscard]] dynamics::State settle_guess(const dynamics::HybridSystem& system, const dynamics::State& start,
                                           double periods, double unit = 0.0);

/// A guess of a self-excited orbit from a simulated run.
struct RecurrenceGuess {
  dynamics::State state;
  double period = 0.0;    ///< [s]
  double mismatch = 0.0;  ///< of the states one period apart, relative to the orbit's size
};

/// Settles for `transient`, then watches a section for `duration` and hands out the return to it, of at most
/// `max_returns`, whose states match best; a shorter one is preferred where it matches within three times the best or
/// 1e-4 of the size of the states. While none matches to a thousandth it goes on watching, eight times as long at most,
/// since a motion may be chaotic for a while; where it stays so, what the first `duration` gave is handed out.
///
/// The section are events of one kind at one contact that come twice at least: releases of the first contact that has
/// them, else reversals, else others; where no events come, the first contact's displacement on its way up through its
/// mean.
/// @throws NumericalFailure  when nothing comes twice
[[nodiscard]] RecurrenceGuess recurrence_guess(const dynamics::HybridSystem& system, const dynamics::State& start,
                                               double transient, double duration, int max_returns = 16);

}  // namespace slipmode::orbits
