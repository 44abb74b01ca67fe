#pragma once

#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace slipmode::orbits {

enum class OrbitKind : std::uint8_t {
  kDriven,       ///< the period is a multiple of the drive's
  kSelfExcited,  ///< constant drive: the period is the orbit's own
};

/// Stability by Floquet multipliers, the trivial ones left out.
enum class Stability : std::uint8_t {
  kStable,
  kUnstable,
  kMarginal,  ///< a multiplier is within `marginal_band` of the unit circle and none is outside
  kUnknown,   ///< not judged: a balance whose contacts remember
};

[[nodiscard]] const char* to_string(OrbitKind kind);
[[nodiscard]] const char* to_string(Stability stability);

/// One regime of an orbit: what every contact does from `time` on.
struct RegimeSpan {
  double time = 0.0;                         ///< [s]
  std::vector<dynamics::ContactMode> modes;  ///< one per contact
};

/// A closed trajectory of a hybrid system, its fundamental matrix and what follows from it.
///
/// Coordinates of matrices and vectors: (q, q̇, internal), N = 2n + internal states.
struct PeriodicOrbit {
  dynamics::State start;  ///< on the orbit, with modes and internal states; off every guard
  double period = 0.0;    ///< [s]
  OrbitKind kind = OrbitKind::kDriven;
  int order = 1;  ///< period / period of the drive; 1 when self-excited
  /// How often a shorter orbit is passed within `period` (to 1e-6 of its size): driven orbits of order > 1 only.
  int repeats = 1;

  /// Φ = d x(T)/d x(0) over one period, saltation included, at fixed T [N x N].
  Eigen::MatrixXd monodromy;
  Eigen::VectorXcd multipliers;  ///< eigenvalues of Φ by modulus, descending; all of them [N]
  /// Multipliers 1 that belong to a family and not to stability: the flow direction of a self-excited orbit, the shift
  /// of a floating one. They are the entries of `multipliers` nearest to 1.
  int trivial_multipliers = 0;
  double leading_modulus = 0.0;  ///< largest |multiplier| without the trivial ones; 0 for N = trivial_multipliers
  Stability stability = Stability::kStable;
  /// Multipliers that are zero to rounding: one per entry into stick or more. Perturbations there die within a period.
  int zero_multipliers = 0;
  /// All multipliers but the trivial ones are zero: what is off the orbit is on it after a few periods.
  bool superstable = false;
  /// Eigenvalues of −Φ(T/2) by modulus, descending: multipliers of the half-period map with reflection, whose squares
  /// are `multipliers`. Symmetric orbits of symmetric systems only, else empty.
  Eigen::VectorXcd half_multipliers;

  std::vector<dynamics::Event> events;  ///< of one period, after `start`
  std::vector<RegimeSpan> regimes;      ///< from `start` on, the first at start.time
  /// The cyclic sequence of regimes, rotated to the lexicographically smallest: comparable between orbits. One letter
  /// per contact (see `regime_symbol`), regimes separated by blanks.
  std::string word;
  int crossings = 0;  ///< events that change what force acts at a contact

  /// x(T/2) = −x(0) within ShootingOptions::symmetry_tolerance. Looked at in symmetric systems, driven with odd order
  /// and one segment.
  bool symmetric = false;
  double asymmetry = 0.0;  ///< mismatch of x(T/2) + x(0), relative as `residual`; 0 where it is not looked at
  /// Smallest |ẏ| at which a stop is reached, over the largest |ẏ| of all events; 1 without stops reached.
  double grazing = 1.0;
  bool has_grazing = false;  ///< an event of kind kGrazing, or `grazing` below 1e-4

  /// The orbit is one of a family of orbits of the same period that fill a line or plane: `family` spans it [N x k].
  /// Empty for an isolated orbit. Floating structures in the gap, S0 section 3.2.
  Eigen::MatrixXd family;
  std::string family_note;  ///< in words; empty for an isolated orbit

  double residual = 0.0;          ///< largest mismatch of x(T) − x(0), of all segments, relative to the orbit's size
  int iterations = 0;             ///< Newton steps taken
  std::vector<double> residuals;  ///< before each Newton step and after the last
};

/// A letter per contact mode: + − slip, 0 stick, ~ smooth, x separated, g free of both stops (in the gap, or in flight
/// beyond it), l r at a stop.
[[nodiscard]] char regime_symbol(dynamics::ContactMode mode);

/// The regimes passed from a start with these modes. @param events  in time order
[[nodiscard]] std::vector<RegimeSpan> regime_sequence(double start_time, std::vector<dynamics::ContactMode> modes,
                                                      std::span<const dynamics::Event> events);

/// The word of a closed sequence of regimes: consecutive equal ones merged, also last with first, then rotated.
[[nodiscard]] std::string word_of(std::span<const RegimeSpan> regimes);
/// How often what force acts changes in it, over all contacts: as the word has it, stays too short to be told left out;
/// not where a flight is back in the gap.
[[nodiscard]] int crossings_of(std::span<const RegimeSpan> regimes);
/// A word for a line of text: its end is left out where it is long.
[[nodiscard]] std::string abridged(const std::string& word);

/// (q, q̇, internal) of a state as one vector [N], and back.
[[nodiscard]] Eigen::VectorXd stacked(const dynamics::State& state);
/// `like` with its coordinates replaced by x [N]; time and modes stay.
[[nodiscard]] dynamics::State with_coordinates(const dynamics::State& like, const Eigen::VectorXd& x);

/// The state after a time on from `state` (≥ 0) [s]; no audit.
[[nodiscard]] dynamics::State advanced(const dynamics::HybridSystem& system, const dynamics::State& state,
                                       double duration);

/// Points of the orbit at `count` equal steps of its period, the first its start.
[[nodiscard]] std::vector<dynamics::State> sample_orbit(const dynamics::HybridSystem& system,
                                                        const PeriodicOrbit& orbit, int count);

/// Size of a scalar y = rᵀq along an orbit.
struct Amplitude {
  double min = 0.0, max = 0.0;            ///< extreme values, where ẏ = 0 by root finding [unit of y]
  double min_time = 0.0, max_time = 0.0;  ///< when [s]
  double mean = 0.0;                      ///< over a period
  double alternating = 0.0;               ///< (max − min)/2
  double effective = 0.0;                 ///< root of the mean square about the mean; × √2 = amplitude of a sine
};

/// @param row  r [n]
/// @throws InvalidInput  for a row of wrong size
/// Between events y is interpolated from displacements and velocities (degree 9), panels halved until a halving changes
/// means by less than 1e-10 of the range: the last are about a thousand times as good. Extremes are roots of ẏ.
[[nodiscard]] Amplitude amplitude(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit,
                                  const Eigen::VectorXd& row);

/// Sizes of the contacts' displacements along an orbit, one per contact.
[[nodiscard]] std::vector<Amplitude> contact_amplitudes(const dynamics::HybridSystem& system,
                                                        const PeriodicOrbit& orbit);

}  // namespace slipmode::orbits
