#pragma once

#include <slipmode/dynamics/system_family.hpp>
#include <slipmode/orbits/balance/balance.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <Eigen/Core>
#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::orbits {

enum class SpecialKind : std::uint8_t {
  kFold,              ///< the branch turns back: a multiplier passes 1
  kSymmetryBreaking,  ///< a multiplier of the half-period map passes −1: asymmetric orbits branch off
  kPeriodDoubling,    ///< a multiplier passes −1
  kNeimarkSacker,     ///< a complex pair passes the unit circle
  kGrazing,           ///< corner collision: the word gains or loses a touch of a stop, or of a separation
  kStickChange,       ///< the word gains or loses a stick
  kWordChange,        ///< the word changes in another way (a reversal comes or goes)
  kNonSmoothFold,     ///< the branch turns back where its word changes: no multiplier need pass 1
  kHopf,              ///< self-excited orbits shrink to a state of rest, which a complex pair of its rates leaves
  kCusp,              ///< of curves of folds (special_curve.hpp): two of them end in one another
};

enum class BranchEnd : std::uint8_t {
  kRange,        ///< the parameter left its range; the last point is on its end
  kMaxPoints,    ///< options.max_points reached
  kClosed,       ///< back at the start
  kMerged,       ///< it joins another one, of symmetric orbits or of rest; of a curve, see `reason`
  kLost,         ///< no step however small found the branch again; `reason` says what was seen
  kInterrupted,  ///< the family was stopped (it threw Interrupted): what was found before is there
};

[[nodiscard]] const char* to_string(SpecialKind kind);
[[nodiscard]] const char* to_string(BranchEnd end);
/// Whether a branch was followed as far as was asked.
[[nodiscard]] constexpr bool is_complete(BranchEnd end) {
  return end != BranchEnd::kLost && end != BranchEnd::kInterrupted;
}

struct ContinuationOptions {
  double from = 0.0, to = 1.0;  ///< range of the parameter, in either order
  /// Which way to go first: towards the upper end of the range (+1) or the lower (−1).
  int direction = 1;
  bool both_ways = false;  ///< then also the other way; points are put in order along the branch
  /// Steps are lengths along the branch; 1 is the first orbit's size, and the whole range of the parameter. Where the
  /// orbit grows, max_step grows with it, but not what of it is the parameter's.
  double step = 0.01, min_step = 1e-9, max_step = 0.05;
  int max_points = 2000;
  /// Pseudo-arclength follows folds. Without, the parameter itself is stepped, and a fold ends the branch.
  bool arclength = true;
  bool locate = true;              ///< special points, else only their brackets' ends are known to the reader
  double locate_tolerance = 1e-9;  ///< of the parameter, relative to its range (and below 1e-8 in the parameter)
  ShootingOptions shooting = {};   ///< order, segments, tolerance, flow
};

struct BranchPoint {
  double parameter = 0.0;
  PeriodicOrbit orbit;
  double arclength = 0.0;  ///< from the first point, scaled
  /// On branches of balances: the series that `orbit` is said of (see continue_balance), and the true error of the
  /// first contact's displacement [m]; NaN: not looked at, infinite: no orbit lies behind.
  std::optional<Balance> balance = {};
  double true_error = std::numeric_limits<double>::quiet_NaN();
  /// On curves of special points (special_curve.hpp): the key that is solved for.
  std::optional<double> other = {};
};

/// A point where the branch changes its kind, found by root finding on converged orbits.
struct SpecialPoint {
  SpecialKind kind = SpecialKind::kFold;
  double parameter = 0.0;
  double uncertainty = 0.0;              ///< width of the last bracket [unit of the parameter]
  PeriodicOrbit orbit;                   ///< the converged orbit nearest to it
  std::size_t before = 0;                ///< it lies between points[before] and points[before + 1]
  std::complex<double> multiplier = {};  ///< the critical one; of the half-period map at a symmetry breaking
  Eigen::VectorXd direction;  ///< its eigenvector, real part (q, q̇, internal) [N]; empty for word changes and balances
  std::string note;           ///< e.g. the words on both sides
  std::optional<Balance> balance = {};  ///< on branches of balances, as BranchPoint has it
  std::optional<double> other = {};     ///< on curves, as BranchPoint has it
};

/// A curve of orbits over a parameter. Kept as far as it was found.
struct Branch {
  std::vector<BranchPoint> points;
  std::vector<SpecialPoint> special;
  BranchEnd end = BranchEnd::kRange;
  std::string reason;  ///< one sentence, with figures and what to try; for both ways: of both ends
};

/// Follows an orbit over a parameter by predictor and corrector.
///
/// Unknowns (x₁ … x_m, [ln T], p): closing conditions, phase where T is unknown, and the distance along the tangent
/// (Keller). dF/dp by central differences of the flow. Driven orbits keep their phase of the drive as its period
/// changes; the phase is set anew where an event comes near the origin, so start.time differs along the branch. Steps
/// adapt to the corrector's iterations and to the tangent's turning. Between points, test functions (see
/// docs/theory/orbits.md) are watched for changes of sign and the word for changes; each is located.
/// @param orbit      at `parameter`, converged
/// @throws InvalidInput  for a range without length, a start outside it, steps that are not positive, a family whose
///                       system is of another size than the orbit
[[nodiscard]] Branch continue_orbit(const dynamics::SystemFamily& family, const PeriodicOrbit& orbit, double parameter,
                                    const ContinuationOptions& options);

/// Orbits of the branch that leaves at a symmetry breaking (same period, both mirror images) or a period doubling
/// (twice the period), at a distance from the special point along its critical direction.
/// @param distance  in units of the orbit's size; tried again at a half, a quarter … when no orbit is found
/// @return          one or two points to continue from (with `order` doubled in the options after a period doubling)
/// @throws InvalidInput      for a special point of another kind, or outside the range of the options
/// @throws NumericalFailure  when no orbit is found
[[nodiscard]] std::vector<BranchPoint> switch_branch(const dynamics::SystemFamily& family, const SpecialPoint& special,
                                                     const ContinuationOptions& options, double distance = 0.02);

}  // namespace slipmode::orbits
