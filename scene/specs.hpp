#pragma once

#include <slipmode/friction/contact.hpp>
#include <slipmode/pod/pomf.hpp>
#include <slipmode/pod/sensors.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
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

/// A contact ([[contact]]).
struct ContactSpec {
  ContactPlace at = 1;
  friction::Law law;                 ///< law and its keys
  friction::NormalLoad normal_load;  ///< constant part > 0 [N]; a clearance has none
  double tilt_deg = 0.0;             ///< of the slider's face (friction::Contact::tilt), |tilt| < 90
  std::string name;                  ///< default "contact 1", "contact 2", ...
};

/// What a force acts along: a place, or one number per degree of freedom.
using ForcePlace = std::variant<ContactPlace, std::vector<double>>;

/// A periodic force on the structure ([drive] kind = "force").
struct ForceSpec {
  /// amplitude sin(order ω t + phase).
  struct Harmonic {
    double amplitude = 0.0;  ///< ≥ 0 [N]
    double phase = 0.0;      ///< [rad]
    int order = 1;           ///< ≥ 1
    ForcePlace at = ContactPlace{1};
  };

  double omega = 1.0;                  ///< ω > 0 [rad/s]
  std::optional<double> frequency_hz;  ///< ω/2π, when the scene gives that
  std::vector<Harmonic> harmonics;     ///< the first is of order 1 and stands in [drive] itself, see read_force
  /// Mean: a number, acting where the first harmonic does, or one number per degree of freedom [N].
  std::variant<double, std::vector<double>> mean = 0.0;
};

/// How long a run is and what is kept ([time]).
struct TimeSpec {
  double duration = 0.0;   ///< of the whole run, > transient [s]
  double transient = 0.0;  ///< not kept, ≥ 0 [s]
  double sample = 0.5;     ///< sampling interval, > 0 [s]

  /// The same in cycles of a shaker or a force: the three above are then those at the scene's own frequency (see
  /// time_at).
  struct Cycles {
    double cycles = 0.0;            ///< > transient_cycles
    double transient_cycles = 0.0;  ///< ≥ 0
    std::int64_t samples = 32;      ///< kept per cycle, ≥ 1
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
  std::vector<double> displacement;  ///< one value per degree of freedom (kGiven) [m]
  std::vector<double> velocity;      ///< one value per degree of freedom (kGiven) [m/s]
};

/// Runs that feed the basis ([ensemble]); without it one run, unperturbed.
struct EnsembleSpec {
  int members = 1;                  ///< runs per speed or frequency, ≥ 1
  std::uint64_t seed = 1;           ///< of the perturbations
  double spread = 0.0;              ///< standard deviation of the starts, ≥ 0 [m], [m/s] (see ensemble_states)
  std::vector<double> speeds;       ///< belt speeds to run at; empty: the drive's own [m/s]
  std::vector<double> frequencies;  ///< shaker frequencies to run at; empty: the drive's own [Hz]
};

/// Sensors on a beam ([sensors]): what the basis of modal functions is made from.
struct SensorSpec {
  pod::SensorKind kind = pod::SensorKind::kStrain;
  std::vector<double> x;   ///< places from the clamp, at least one [m]
  double noise = 0.0;      ///< standard deviation as a fraction of each sensor's rms, ≥ 0
  std::uint64_t seed = 1;  ///< of the noise
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
  /// Of modal functions: what carries each POM. Only with sensors.
  pod::FitFamily fit = pod::FitFamily::kNaturalModes;
  int functions = 0;  ///< how many of them, at most one per sensor; 0: one per sensor
};

/// A grid of values from, from ± step, ... up to `to`.
struct Range {
  double from = 0.0, to = 0.0, step = 1.0;  ///< step > 0; the direction follows from `from` and `to`

  /// The values, as diagnostics::sweep_values gives them.
  [[nodiscard]] std::vector<double> values() const;
};

/// How full and reduced models are compared on a belt ([validation]).
struct ValidationSpec {
  Range speeds = {0.5, 0.001, 0.001};  ///< belt speeds of the bifurcation diagram [m/s]
  int segments = 1;                    ///< chains the sweep is cut into; each starts anew
  double transient = 1000.0;           ///< run first at each speed, nothing kept [s]
  double block = 5000.0;               ///< then blocks of this length, each judged [s]
  double limit = 100000.0;             ///< until periodic or so long, ≥ block: attractors and orbits [s]
  double sweep_limit = 5000.0;         ///< the same at each value of a sweep, > 0 [s]
  double period_tolerance = 1e-5;      ///< slip states closer than this, relative to their range, count as the same
  int max_period = 64;                 ///< longest period looked for, in slips
  double horizon = 100.0;              ///< full against reduced from shared starts, on the scene's own drive [s]
  int horizon_starts = 16;             ///< how many shared starts are averaged
  std::vector<double> orbits;          ///< belt speeds at which periodic orbits are compared [m/s]
  double orbit_tolerance = 1e-8;       ///< to which such an orbit must repeat
  std::vector<int> modes;              ///< sizes of the reduced models compared; empty: 1..N
  double lyapunov_duration = 20000.0;  ///< over which the largest exponent is measured [s]
  double cost_duration = 10000.0;      ///< simulated by the timed runs; 0: no timing [s]
  int cost_repeats = 5;                ///< cost is the median of this many runs
};

/// How full and reduced models are compared under a shaker ([validation]).
struct ShakenValidationSpec {
  /// Which ways a sweep goes when each frequency starts where the one before ended, to show hysteresis.
  enum class Follow {
    kNone,     ///< each frequency starts from the scene's start
    kForward,  ///< as `frequencies` runs
    kBoth,     ///< and back
  };

  std::optional<Range> frequencies;  ///< of the sweep [Hz]; the amplitude curve covers them; absent: no sweep
  double cycles = 600.0;             ///< run at each frequency, > kept
  double kept = 100.0;               ///< cycles kept, the last ones, > 0 (S4 6.3.2)
  std::optional<double> gauge;       ///< x of the strain in Poincaré sections [m]; absent: see gauge_position
  std::vector<int> modes;            ///< sizes of the reduced models compared; empty: 1..N
  std::vector<BasisChoice> bases;    ///< bases compared; default: what the scene's structure and sensors allow
  Follow follow = Follow::kNone;
  double period_tolerance = 1e-5;  ///< section states closer than this, relative to their range, are the same
  int max_period = 64;             ///< longest period looked for, in cycles
  double cost_cycles = 600.0;      ///< simulated by the timed runs; 0: no timing
  int cost_repeats = 5;            ///< cost is the median of this many runs
};

}  // namespace slipmode::scene
