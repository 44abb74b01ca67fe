#pragma once

#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace slipmode::diagnostics {

/// The slip state of S4 section 3.5.3: where a contact was when it began to slip.
struct SlipState {
  double time = 0.0;
  int contact = 0;
  double displacement = 0.0;  ///< wᵀq + offset [m]
};

/// The releases among events, in time order.
[[nodiscard]] std::vector<SlipState> slip_states(std::span<const dynamics::Event> events);

enum class Motion {
  kPeriodic,
  kAperiodic,  ///< enough slips seen, no period up to max_period
  kUndecided,  ///< too few slips to say, or still settling to a period
  kSticking,   ///< no slip: every contact stuck all the time
  kSliding,    ///< no stick: steady sliding, or oscillation without stick, which slip states cannot tell apart
};

[[nodiscard]] const char* to_string(Motion motion);

struct PeriodOptions {
  /// Largest difference of slip states one period apart, relative to the contact's `scale`; of times, relative to T.
  double tolerance = 1e-5;
  int max_period = 64;  ///< in slips of the section contact
  int repeats = 3;      ///< periods that must be seen to repeat
  /// Slips that must match at least, so that a short visit near an unstable orbit is no period …
  int min_matches = 20;
  /// … unless fewer of them cover so much time [s]; 0: no exception. For slow belts, where one slip takes ages.
  double long_stretch = 0.0;
  /// Reach of each contact's motion [m]; empty: the range of its slip states (or their size, if they are all equal).
  std::vector<double> scale = {};
};

struct PeriodResult {
  Motion motion = Motion::kUndecided;
  int period = 0;         ///< slips of the section contact per period; 0 unless periodic
  double T = 0.0;         ///< period in time, mean over the matched repeats [s]; 0 unless periodic
  int contact = -1;       ///< section contact: the one that slips most often, the lowest if several do
  double mismatch = 0.0;  ///< largest relative difference of slips `period` apart in the matched stretch
  /// How well the period is told from its divisors: mismatch / (smallest mismatch of a divisor). 0: clear, as when no
  /// divisor comes near. Near 1: the motion still decays towards a shorter period, and waiting will tell.
  double doubt = 0.0;
};

/// Whether the differences between a motion and itself p passes before fall from eighth to eighth of the record, by a
/// tenth at least in all, to a tenth of its reach. Those of a chaotic motion fall in order once in 8! = 40,000 tries.
/// @param count       of differences; fewer than p in an eighth: false
/// @param difference  relative to the reach, of a place in time order
[[nodiscard]] bool is_settling(std::size_t count, std::size_t p, const std::function<double(std::size_t)>& difference);

/// Period of the last slips. First the smallest p for which slip states p apart agree within tolerance over the last
/// max(repeats·p, min_matches) slips (see long_stretch), at a constant time apart; with several contacts, every slip of
/// every contact in that stretch must have its partner one T before. Simultaneous slips may come in any order.
///
/// A slow decay towards a shorter period q can pass that test for a multiple p of q first, by chance of its phase. So a
/// divisor q that repeats within 100 tolerances and not ten times worse than p is taken instead (`mismatch` then
/// exceeds the tolerance and `doubt` says by how much p is better). A doubling whose split is below tolerance counts as
/// not doubled.
/// @param slips   in time order
/// @param states  optional, one column (q; v) per slip: then the whole state must repeat too, relative to the largest
///                column norm about the mean
/// @throws InvalidInput  for options out of range, slips out of order, a state matrix of the wrong width
[[nodiscard]] PeriodResult detect_period(std::span<const SlipState> slips, const PeriodOptions& options = {},
                                         const Eigen::MatrixXd* states = nullptr);

}  // namespace slipmode::diagnostics
