#pragma once

#include "dynamics/simulate.hpp"
#include "dynamics/system.hpp"
#include "fem/chain.hpp"
#include "friction/contact.hpp"
#include "friction/drive.hpp"
#include "pod/basis.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace slipmode::scene {

/// A friction contact on one mass of the chain ([[contact]]).
struct ContactSpec {
  int at = 1;                ///< mass number, 1..N
  friction::Law law;         ///< law, mu_s, mu_k, alpha, epsilon
  double normal_load = 1.0;  ///< N > 0 [N]
  std::string name;          ///< default "contact 1", "contact 2", ...
};

/// How long a run is and what is kept ([time]).
struct TimeSpec {
  double duration = 0.0;   ///< of the whole run, > transient [s]
  double transient = 0.0;  ///< not kept, ≥ 0 [s]
  double sample = 0.5;     ///< sampling interval, > 0 [s]
};

/// Where a run starts ([initial]); default rest.
struct InitialSpec {
  enum class At {
    kRest,    ///< q = 0, v = 0
    kStatic,  ///< K q = Σ w μ_k N sign(belt speed at time 0), v = 0
    kGiven,   ///< the arrays below
  } at = At::kRest;
  std::vector<double> displacement;  ///< N values (kGiven) [m]
  std::vector<double> velocity;      ///< N values (kGiven) [m/s]
};

/// Runs that feed the basis ([ensemble]); without it one run, unperturbed.
struct EnsembleSpec {
  int members = 1;             ///< runs per speed, ≥ 1
  std::uint64_t seed = 1;      ///< of the perturbations
  double spread = 0.0;         ///< standard deviation of each start's displacements and velocities, ≥ 0 [m], [m/s]
  std::vector<double> speeds;  ///< belt speeds to run at; empty: the drive's own [m/s]
};

/// What the reduced model is made of ([reduction]).
struct ReductionSpec {
  pod::BasisKind basis = pod::BasisKind::kPom;            ///< pom | lnm
  pod::ModeChoice choice = {.modes = 0, .energy = 0.99};  ///< energy, or modes
};

/// A grid of values from, from ± step, ... up to `to`.
struct Range {
  double from = 0.0, to = 0.0, step = 1.0;  ///< step > 0; the direction follows from `from` and `to`

  /// The values, as diagnostics::sweep_values gives them.
  [[nodiscard]] std::vector<double> values() const;
};

/// How full and reduced models are compared ([validation]).
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

/// Where a scene came from; kept for provenance.
struct SceneSource {
  std::string path;                    ///< as given; "<text>" when parsed from memory
  std::string text;                    ///< as read
  std::vector<std::string> overrides;  ///< "drive.speed=0.25", in order
};

/// Everything a scene file says (TOML; keys as in datasets/README.md). Plain data: checked when read.
struct Scene {
  std::string title;
  std::string units = "dimensionless";  ///< "dimensionless" or "SI"
  fem::ChainOptions structure;
  std::vector<ContactSpec> contacts;
  friction::Drive drive;
  TimeSpec time;
  InitialSpec initial;
  EnsembleSpec ensemble;
  ReductionSpec reduction;
  ValidationSpec validation;
  dynamics::FlowOptions flow;  ///< method and tolerance from [flow]
  SceneSource source;
};

/// Reads and checks a scene.
/// @param overrides  "path=value" each, applied in order: drive.speed=0.25, contact.0.mu_s=0.5, time={duration=10.0}.
///                   Values are TOML; a bare word counts as a string. Array tables are numbered from 0.
/// @throws InvalidInput  "file:line: key = value: what is wrong; valid: ..." for a missing file, bad TOML, an unknown
/// or
///                       missing key, a wrong type, an impossible value; overrides are named instead of the line
[[nodiscard]] Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});
/// Same from a text; `path` is only used in messages.
[[nodiscard]] Scene parse_scene(const std::string& text, const std::vector<std::string>& overrides = {},
                                const std::string& path = "<text>");

/// A complete scene file that parses to the same scene, every default written out.
[[nodiscard]] std::string scene_to_toml(const Scene& scene);

/// The same scene with one value changed, checked anew. The override is added to `source.overrides`.
/// @param path   dotted: "drive.speed", "structure.masses", "contact.0.mu_s"
/// @throws InvalidInput  for an unknown path or an impossible value
[[nodiscard]] Scene set_key(const Scene& scene, const std::string& path, double value);
/// Value of any numeric key, defaults included. @throws InvalidInput if there is none of that name or it is no number
[[nodiscard]] double get_key(const Scene& scene, const std::string& path);

/// The full model: chain, contacts, drive.
[[nodiscard]] dynamics::HybridSystem build_system(const Scene& scene);
/// Where a run starts (see InitialSpec), at time 0.
/// @throws InvalidInput  "static" for a structure that is free to move as a whole
[[nodiscard]] dynamics::State initial_state(const Scene& scene, const dynamics::HybridSystem& system);
/// Starts of the ensemble's members: initial_state with `spread` times a standard normal number added to each
/// displacement, then to each velocity; member k draws from Random::stream(seed, k). All equal when spread = 0.
[[nodiscard]] std::vector<dynamics::State> ensemble_states(const Scene& scene, const dynamics::HybridSystem& system);
/// Durations and flow options of [time] and [flow].
[[nodiscard]] dynamics::SimulateOptions simulate_options(const Scene& scene);

}  // namespace slipmode::scene
