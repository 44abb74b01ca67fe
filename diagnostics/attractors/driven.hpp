#pragma once

#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/dynamics/simulate.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace slipmode::diagnostics {

/// Linear readings of a state, rows · q + offset: what a strain gauge, or any sensor, says of a model.
struct Readings {
  Eigen::MatrixXd rows;    ///< m x n
  Eigen::VectorXd offset;  ///< m; empty: zero. What an affine reduced basis leaves at a = 0

  /// One column per column of q [m x T].
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& q) const;
};

/// What the contacts do over the cycles kept. A compliant contact sticks at every reversal, however little, while its
/// spring is turned round, and under μ_s > μ_k often while it slides: an episode of stick shorter than
/// DrivenOptions::micro_stick is called micro-stick.
enum class DrivenLabel : std::uint8_t {
  kStick,       ///< every contact sticks all the time, and no contact point jumps
  kStickSlip,   ///< neither of the others
  kSlip,        ///< no stick but micro-stick
  kNoFriction,  ///< no contact has friction: there are stops alone
};

/// Whether motion repeats with the drive.
enum class DrivenRepeat : std::uint8_t {
  kPeriodic,
  kSettling,   ///< not yet within tolerance, but nearer to repeating in each quarter of the cycles kept
  kAperiodic,  ///< no period up to max_period, not even nearly
  kUndecided,  ///< too few cycles kept to tell, or within 100 tolerances of repeating
};

[[nodiscard]] const char* to_string(DrivenLabel label);
[[nodiscard]] const char* to_string(DrivenRepeat repeat);

struct DrivenPeriod {
  DrivenRepeat repeat = DrivenRepeat::kUndecided;
  int period = 0;  ///< in drive periods; that approached by a settling motion; else 0
  /// Largest difference of points a period apart, relative to the scales; NaN where nothing nearly repeats.
  double mismatch = 0.0;
};

/// Smallest number of drive periods after which section points repeat within tolerance, looked for among the last
/// max(3 p, 20) points and the p before them.
/// @param points      one column per section, in order; every row is compared [m x T]
/// @param scale       reach of each row's motion, > 0 where the row moves [m]
/// @param tolerance   > 0, relative to the scale
/// @param max_period  ≥ 1
/// @throws InvalidInput  for sizes that do not fit or options out of range
[[nodiscard]] DrivenPeriod driven_period(const Eigen::MatrixXd& points, const Eigen::VectorXd& scale, double tolerance,
                                         int max_period);

struct DrivenOptions {
  double cycles = 600.0;         ///< of the drive, run in all; whole number ≥ 2 (S4 section 6.3.2)
  double kept = 100.0;           ///< of them kept, the last ones; whole number in [1, cycles)
  double tolerance = 1e-5;       ///< section points closer than this, relative to the reach of the motion, are the same
  int max_period = 64;           ///< in drive periods
  double micro_stick = 0.05;     ///< stick shorter than this is micro-stick, in drive periods
  int samples = 16;              ///< per cycle, for reach, root mean square and energy; ≥ 1
  double exponent_cycles = 0.0;  ///< the largest Lyapunov exponent is measured over so many cycles more; 0: not
  dynamics::FlowOptions flow = {};
  const StopFlag* stop = nullptr;  ///< polled during the exponent's measurement
};

/// The motion that a shaker or a force makes a system settle to, over the cycles kept. Sections are those of the drive
/// (friction::Drive::section_time).
struct DrivenMotion {
  double frequency_hz = 0.0;            ///< of the drive
  Eigen::MatrixXd readings = {};        ///< at each section [m x kept]
  Eigen::MatrixXd contact_q = {};       ///< wᵀq + offset at each section [nc x kept, m]
  Eigen::MatrixXd contact_v = {};       ///< wᵀq̇ at each section [nc x kept, m/s]
  Eigen::VectorXd mean = {}, rms = {};  ///< of each reading; rms about the mean, over all samples [m]
  DrivenLabel label = DrivenLabel::kStickSlip;
  DrivenPeriod period = {};
  double stick_fraction = 0.0;   ///< share of the time in stick, see stick_share(); micro-stick included
  double longest_stick = 0.0;    ///< of any contact, in drive periods
  std::int64_t separations = 0;  ///< losses of contact
  std::int64_t jumps = 0;        ///< of contact points behind their springs
  std::int64_t events = 0;       ///< in all cycles, those not kept included
  double mean_energy = 0.0;      ///< of HybridSystem::energy over all samples [J]
  double audit_residual = 0.0;   ///< of the whole run; NaN where flow.audit is off
  std::optional<LyapunovExponent> exponent = {};
  dynamics::State end = {};  ///< at a section, a whole number of periods after the start
};

/// The state at a driven system's first section from time 0 on: run to it from a start at time 0, as simulate() would;
/// one of a later time was at a section of another drive, and is handed on, so that phase is continuous.
[[nodiscard]] dynamics::State at_first_section(const dynamics::HybridSystem& system, const dynamics::State& start);

/// Runs a driven system for `cycles` of its drive from its first section on, see at_first_section().
/// @throws InvalidInput      for a drive without a period (amplitude 0 has one), options out of range,
///                           readings of another size, and as simulate
/// @throws NumericalFailure  as simulate
[[nodiscard]] DrivenMotion settle_driven(const dynamics::HybridSystem& system, const Readings& readings,
                                         const dynamics::State& start, const DrivenOptions& options = {});

}  // namespace slipmode::diagnostics
