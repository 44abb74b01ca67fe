#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/friction/contact.hpp>
#include <slipmode/friction/iwan.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/pod/sensors.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace slipmode::scene {

/// The end of a beam's rigid extension.
struct AtTip {};

/// Between two masses: displacement x_second − x_first.
struct Between {
  int first = 1, second = 2;  ///< numbers from 1, different
};

/// Where a contact is: number of a mass (a degree of freedom), 1..N, to ground; x on the beam or its extension [m]; the
/// beam's tip; or between two masses.
using ContactPlace = std::variant<int, double, AtTip, Between>;

/// The place as a word for tables and axes: "10", "0.35", "tip", "2-3".
[[nodiscard]] std::string to_string(const ContactPlace& place);

/// A structure given by its matrices ([structure] kind = "matrices"), each n x n; C may have a skew part.
struct MatricesSpec {
  Eigen::MatrixXd mass, damping, stiffness;
  std::string units = "dimensionless";
};

/// A joint ([[contact]] with law = "iwan") of which a contact is one element.
struct JointShare {
  friction::Iwan law;
  std::string name;
  std::size_t element = 0;  ///< in friction::elements_of
};

/// A contact of the model: one [[contact]], or one element of a joint.
struct ContactSpec {
  ContactPlace at = 1;
  friction::Law law;                     ///< law and its keys
  friction::NormalLoad normal_load;      ///< constant part > 0 [N]; a clearance has none
  double tilt_deg = 0.0;                 ///< of the slider's face (friction::Contact::tilt), |tilt| < 90
  std::string name;                      ///< default "contact 1", "contact 2", ...
  std::optional<JointShare> joint = {};  ///< where it is an element of one
};

/// What a force acts along: a place, or one number per degree of freedom.
using ForcePlace = std::variant<ContactPlace, std::vector<double>>;

/// A periodic force on the structure ([drive] kind = "force").
struct ForceSpec {
  /// amplitude sin(order ω t + phase).
  struct Harmonic {
    double amplitude = 0.0, phase = 0.0;
    int order = 1;
    ForcePlace at = ContactPlace{1};

    static constexpr auto fields() {
      return std::tuple{required("order", &Harmonic::order, "", "frequency over omega", kCount),
                        required("amplitude", &Harmonic::amplitude, "N", "amplitude", kNonNegative),
                        optional("phase", &Harmonic::phase, "rad", "phase at time 0")};
    }
  };

  double omega = 1.0;                  ///< ω > 0 [rad/s]
  std::optional<double> frequency_hz;  ///< ω/2π, when the scene gives that
  std::vector<Harmonic> harmonics;     ///< the first is of order 1 and stands in [drive] itself, see read_force
  /// Mean: a number, acting where the first harmonic does, or one number per degree of freedom [N].
  std::variant<double, std::vector<double>> mean = 0.0;
};

/// How long a run is and what is kept ([time]). What is not given is chosen by a period: see datasets/README.md.
struct TimeSpec {
  double duration = 0.0, transient = 0.0, sample = 0.5;

  static constexpr auto fields() {
    return std::tuple{optional("duration", &TimeSpec::duration, "s", "of the whole run, > transient", kPositive),
                      optional("transient", &TimeSpec::transient, "s", "not kept", kNonNegative),
                      optional("sample", &TimeSpec::sample, "s", "sampling interval", kPositive)};
  }

  /// The same in cycles of a shaker or a force: the three above are then those at the scene's own frequency (see
  /// time_at).
  struct Cycles {
    double cycles = 0.0, transient_cycles = 0.0;
    std::int64_t samples = 32;

    static constexpr auto fields() {
      return std::tuple{optional("cycles", &Cycles::cycles, "", "of the whole run, > transient_cycles", kPositive),
                        optional("transient_cycles", &Cycles::transient_cycles, "", "not kept", kNonNegative),
                        optional("samples_per_cycle", &Cycles::samples, "", "kept per cycle",
                                 {.low = 1.0, .high = std::numeric_limits<int>::max()})};
    }
  };
  std::optional<Cycles> cycles;
};

/// Where a run starts ([initial]); default rest.
struct InitialSpec {
  enum class At {
    kRest,    ///< q = 0, v = 0
    kStatic,  ///< K q = Σ w λ with λ = μ_k N in the direction of the belt at time 0 (tilt counts), v = 0
    kGiven,   ///< the arrays below
  } at = At::kRest;
  std::vector<double> displacement, velocity;  ///< for kGiven

  static constexpr auto fields() {
    return std::tuple{optional("at", &InitialSpec::at, "", "a state of its own"),
                      optional("displacement", &InitialSpec::displacement, "m", "one value per degree of freedom"),
                      optional("velocity", &InitialSpec::velocity, "m/s", "one value per degree of freedom")};
  }
};

/// Runs that feed the basis ([ensemble]); without it one run, unperturbed.
struct EnsembleSpec {
  int members = 1;
  std::uint64_t seed = 1;
  double spread = 0.0;
  std::vector<double> speeds, frequencies, omegas;  ///< those of the drive, see drive_key

  static constexpr auto fields() {
    using Own = EnsembleSpec;
    return std::tuple{optional("members", &Own::members, "", "runs per speed or frequency", kCount),
                      optional("seed", &Own::seed, "", "of the perturbations", kFromZero),
                      optional("spread", &Own::spread, "m, m/s", "standard deviation of the starts", kNonNegative),
                      optional("speeds", &Own::speeds, "m/s", "belt speeds to run at; empty: the drive's own"),
                      optional("frequencies", &Own::frequencies, "Hz",
                               "of a shaker, or of a force given in Hz, to run at; empty: the drive's own", kPositive),
                      optional("omegas", &Own::omegas, "rad/s",
                               "of a force given by omega, to run at; empty: the drive's own", kPositive)};
  }
};

/// Sensors on a beam ([sensors]): what the basis of modal functions is made from.
struct SensorSpec {
  pod::SensorKind kind = pod::SensorKind::kStrain;
  std::vector<double> x;
  double noise = 0.0;
  std::uint64_t seed = 1;

  static constexpr auto fields() {
    using Own = SensorSpec;
    return std::tuple{
        required("kind", &Own::kind, "", "what is read"),
        required("x", &Own::x, "m", "places from the clamp, at least one"),
        optional("noise", &Own::noise, "1", "standard deviation as a fraction of each sensor's rms", kNonNegative),
        optional("seed", &Own::seed, "", "of the noise", kFromZero)};
  }
};

/// What the vectors of a basis are.
enum class BasisChoice {
  kPom,        ///< POMs of all degrees of freedom, every one weighted alike
  kLnm,        ///< linear natural modes
  kPomf,       ///< proper orthogonal modal functions from the sensors (beams)
  kMassPom,    ///< POMs of all degrees of freedom in the mass metric (beams)
  kLnmStatic,  ///< linear natural modes with one static mode per contact (beams)
};

/// "pom", "lnm", "pomf", "mass-pom" or "lnm+static": the word of a scene file.
[[nodiscard]] std::string to_string(BasisChoice basis);

/// What the reduced model is made of ([reduction]).
struct ReductionSpec {
  BasisChoice basis = BasisChoice::kPom;
  pod::ModeChoice choice = {.modes = 0, .energy = 0.99};  ///< energy, or modes
  pod::FitFamily fit = pod::FitFamily::kNaturalModes;
  int functions = 0;

  static constexpr auto fields() {
    using Own = ReductionSpec;
    return std::tuple{optional("basis", &Own::basis, "", "what the vectors are"),
                      optional("fit", &Own::fit, "", "of modal functions, with sensors: what carries each POM"),
                      optional("functions", &Own::functions, "",
                               "how many of them, at most one per sensor; 0: one per sensor", kCount)};
  }
};

/// A grid of values from, from ± step, ... up to `to`.
struct Range {
  double from = 0.0, to = 0.0, step = 1.0;  ///< the direction follows from `from` and `to`

  static constexpr auto fields() {
    return std::tuple{required("from", &Range::from, "", "first value"), required("to", &Range::to, "", "last value"),
                      required("step", &Range::step, "", "between values", kPositive)};
  }

  /// The values, as diagnostics::sweep_values gives them.
  [[nodiscard]] std::vector<double> values() const;
};

/// How full and reduced models are compared on a belt ([validation]).
struct ValidationSpec {
  Range speeds = {0.5, 0.001, 0.001};
  int segments = 1;
  double transient = 1000.0, block = 5000.0, limit = 100000.0, sweep_limit = 5000.0, period_tolerance = 1e-5;
  int max_period = 64;
  double horizon = 100.0;
  int horizon_starts = 16;
  std::vector<double> orbits;
  double orbit_tolerance = 1e-8;
  std::vector<int> modes;
  double lyapunov_duration = 20000.0, cost_duration = 10000.0;
  int cost_repeats = 5;

  static constexpr auto fields() {
    using Own = ValidationSpec;
    return std::tuple{
        optional("speeds", &Own::speeds, "m/s", "belt speeds of the bifurcation diagram"),
        optional("segments", &Own::segments, "", "chains the sweep is cut into; each starts anew", kCount),
        optional("transient", &Own::transient, "s", "run first at each speed, nothing kept", kNonNegative),
        optional("block", &Own::block, "s", "then blocks of this length, each judged", kPositive),
        optional("limit", &Own::limit, "s", "until periodic or so long, >= block: attractors and orbits", kPositive),
        optional("sweep_limit", &Own::sweep_limit, "s", "the same at each value of a sweep", kPositive),
        optional("period_tolerance", &Own::period_tolerance, "1",
                 "slip states closer than this, relative to their range, count as the same", kPositive),
        optional("max_period", &Own::max_period, "", "longest period looked for, in slips", kCount),
        optional("horizon", &Own::horizon, "s", "full against reduced from shared starts, on the scene's own drive",
                 kPositive),
        optional("horizon_starts", &Own::horizon_starts, "", "how many shared starts are averaged", kCount),
        optional("orbits", &Own::orbits, "m/s", "belt speeds at which periodic orbits are compared"),
        optional("orbit_tolerance", &Own::orbit_tolerance, "1", "to which such an orbit must repeat", kPositive),
        optional("modes", &Own::modes, "", "sizes of the reduced models compared; empty: all up to 12, then fewer",
                 kCount),
        optional("lyapunov_duration", &Own::lyapunov_duration, "s", "over which the largest exponent is measured",
                 kPositive),
        optional("cost_duration", &Own::cost_duration, "s", "simulated by the timed runs; 0: no timing", kNonNegative),
        optional("cost_repeats", &Own::cost_repeats, "", "cost is the median of this many runs", kCount)};
  }
};

/// How full and reduced models are compared under a shaker or a force ([validation]).
struct DrivenValidationSpec {
  /// Which ways a sweep goes when each frequency starts where the one before ended, to show hysteresis.
  enum class Follow {
    kNone,     ///< each frequency starts from the scene's start
    kForward,  ///< as `frequencies` runs
    kBoth,     ///< and back
  };

  std::optional<Range> frequencies, omegas;  ///< one at most, see drive_key
  double cycles = 600.0, kept = 100.0;
  std::optional<double> gauge;
  std::vector<int> modes;
  std::vector<BasisChoice> bases;
  Follow follow = Follow::kNone;
  double period_tolerance = 1e-5;
  int max_period = 64;
  double cost_cycles = 600.0;
  int cost_repeats = 5;

  static constexpr auto fields() {
    using Own = DrivenValidationSpec;
    return std::tuple{
        optional("frequencies", &Own::frequencies, "Hz",
                 "of the sweep; a shaker's amplitude curve covers them; absent: no sweep", kPositive),
        optional("omegas", &Own::omegas, "rad/s", "the same of a force given by omega", kPositive),
        optional("cycles", &Own::cycles, "", "run at each frequency", kPositive),
        optional("kept", &Own::kept, "", "cycles kept, the last ones (S4 6.3.2)", kPositive),
        optional("gauge", &Own::gauge, "m", "x of the strain in Poincare sections; absent: see gauge_position"),
        optional("modes", &Own::modes, "", "sizes of the reduced models compared; empty: all up to 12, then fewer",
                 kCount),
        optional("bases", &Own::bases, "", "bases compared under a shaker; default: what structure and sensors allow"),
        optional("follow", &Own::follow, "", "which ways a sweep goes on from value to value"),
        optional("period_tolerance", &Own::period_tolerance, "1",
                 "section states closer than this, relative to their range, are the same", kPositive),
        optional("max_period", &Own::max_period, "", "longest period looked for, in cycles", kCount),
        optional("cost_cycles", &Own::cost_cycles, "", "simulated by the timed runs; 0: no timing", kNonNegative),
        optional("cost_repeats", &Own::cost_repeats, "", "cost is the median of this many runs", kCount)};
  }
};

}  // namespace slipmode::scene
