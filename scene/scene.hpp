#pragma once

#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/dynamics/system.hpp>
#include <slipmode/fem/beam.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/friction/amplitude_curve.hpp>
#include <slipmode/friction/drive.hpp>
#include <slipmode/scene/specs.hpp>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace slipmode::scene {

/// Where a scene came from; kept for provenance.
struct SceneSource {
  std::string path;                    ///< as given; "<text>" when parsed from memory
  std::string text;                    ///< as read
  std::vector<std::string> overrides;  ///< "drive.speed=0.25", in order
  /// What text and overrides give: tables and their keys, "time" and "time.sample". A seed alone makes no "ensemble".
  std::set<std::string> given = {};
  double period = 0.0;  ///< slowest_period by which times were chosen; 0 where none were [s]
};

/// What [structure] may be.
using StructureSpec = std::variant<fem::ChainOptions, fem::BeamOptions, fem::MassesOptions, MatricesSpec>;

/// Everything a scene file says (TOML; keys as in datasets/README.md). Plain data: checked when read.
struct Scene {
  std::string title;
  std::string units = "dimensionless";  ///< "dimensionless" or "SI"
  StructureSpec structure;
  std::vector<ContactSpec> contacts;
  friction::Drive drive;               ///< a shaker has the amplitude of its curve at its frequency
  friction::AmplitudeCurve amplitude;  ///< of a shaker, over frequency
  std::optional<ForceSpec> force;      ///< when the drive is a force: where it acts, and its mean
  TimeSpec time;
  InitialSpec initial;
  EnsembleSpec ensemble;
  std::optional<SensorSpec> sensors;
  ReductionSpec reduction;
  ValidationSpec validation;                       ///< for a belt
  DrivenValidationSpec driven;                     ///< for a shaker or a force
  dynamics::FlowOptions flow = {.certify = true};  ///< method and tolerance from [flow]
  SceneSource source;

  /// The chain, or null.
  [[nodiscard]] const fem::ChainOptions* chain() const { return std::get_if<fem::ChainOptions>(&structure); }
  /// The beam, or null.
  [[nodiscard]] const fem::BeamOptions* beam() const { return std::get_if<fem::BeamOptions>(&structure); }
  /// Degrees of freedom of the full model.
  [[nodiscard]] Eigen::Index size() const;
  /// The title, or the name of the file where there is none.
  [[nodiscard]] std::string name() const;
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

/// A scene file for verbs to run as they run this scene: the tables that its source and overrides give, and [flow]
/// where it is not the usual one; of [time] and [validation] the keys given, since the others follow from periods.
[[nodiscard]] std::string scene_file(const Scene& scene);

/// The same scene with one value changed, checked anew. The override is added to `source.overrides`.
/// @param path   dotted: "drive.speed", "structure.masses", "contact.0.mu_s"
/// @throws InvalidInput  for an unknown path or an impossible value
[[nodiscard]] Scene set_key(const Scene& scene, const std::string& path, double value);
/// Value of any numeric key, defaults included. @throws InvalidInput if there is none of that name or it is no number
[[nodiscard]] double get_key(const Scene& scene, const std::string& path);
/// Its unit, "N/m"; "1" for a pure number, and for all in a dimensionless scene.
[[nodiscard]] std::string unit_of_key(const Scene& scene, const std::string& path);
/// Value of a key that can be varied continuously: a real number of the structure, a contact or the drive.
/// @throws InvalidInput  for a key that is not there, a word, a whole number (masses, elements), or one that is not
/// part
///                       of the model ([time], [flow]); the message says which and what would do
[[nodiscard]] double get_continuous_key(const Scene& scene, const std::string& path);

/// True when the scene, or an override of it, has that table ("ensemble", "validation", …). A seed alone makes none.
[[nodiscard]] bool has_section(const Scene& scene, const std::string& name);

/// The finite-element beam of a beam scene: rows of displacement, slope and strain, the structure of the full model.
/// @throws InvalidInput  for a chain; for damping that cannot be met
[[nodiscard]] fem::Beam build_beam(const Scene& scene);
/// The full model: structure, contacts, drive.
[[nodiscard]] dynamics::HybridSystem build_system(const Scene& scene);
/// The same on a beam that was built already.
[[nodiscard]] dynamics::HybridSystem build_system(const Scene& scene, const fem::Beam& beam);

/// A model of this structure (full or projected), with the laws and normal loads of the scene's contacts: modal data
/// are shared. @throws InvalidInput  for another number of contacts
[[nodiscard]] dynamics::HybridSystem with_laws_of(const Scene& scene, const dynamics::HybridSystem& system);

/// The drive's own key: "drive.speed" of a belt, "drive.frequency" of a shaker, of a force that or "drive.omega",
/// whichever the scene gives.
[[nodiscard]] std::string drive_key(const Scene& scene);
/// The drive at another value of that key: a belt's speed [m/s], a frequency [Hz] or ω [rad/s]; a shaker has the
/// amplitude of its curve there.
/// @throws InvalidInput  for a frequency the amplitude curve does not cover
[[nodiscard]] friction::Drive drive_at(const Scene& scene, double value);
/// The value of that key the scene itself is at (of a belt at time 0).
[[nodiscard]] double drive_parameter(const Scene& scene);
/// [time] there: a time in cycles is another one in seconds at another frequency.
[[nodiscard]] TimeSpec time_at(const Scene& scene, double value);

/// Where a run starts (see InitialSpec), at time 0. In "static" contact springs and bristles carry the sliding force
/// and normal oscillators are at rest; elsewhere contacts' own states are left to the flow (dynamics::State::internal).
/// @throws InvalidInput  "static" for a structure that is free to move as a whole, with a clearance, or when contact is
///                       lost there
[[nodiscard]] dynamics::State initial_state(const Scene& scene, const dynamics::HybridSystem& system);
/// Starts of the ensemble's members. All equal when spread = 0; member k draws from Random::stream(seed, k).
///
/// On a chain initial_state with `spread` times a standard normal number added to each displacement, then to each
/// velocity. Such noise on each degree of freedom of a beam would be all curvature: there the same number of times each
/// of the six lowest natural modes is added, scaled to a largest nodal displacement of 1, to the displacements, then to
/// the velocities.
[[nodiscard]] std::vector<dynamics::State> ensemble_states(const Scene& scene, const dynamics::HybridSystem& system);
/// Durations and flow options of [time] and [flow].
[[nodiscard]] dynamics::SimulateOptions simulate_options(const Scene& scene);

/// The scene's sensors. @throws InvalidInput  if it has none
[[nodiscard]] pod::SensorArray sensor_array(const Scene& scene, const fem::Beam& beam);
/// Their noise. @throws InvalidInput  if it has none
[[nodiscard]] pod::Noise sensor_noise(const Scene& scene);
/// Readings of the scene's sensors, with their noise [ns x T]. @throws InvalidInput  for a scene without sensors
[[nodiscard]] Eigen::MatrixXd sensor_readings(const Scene& scene, const fem::Beam& beam, const Eigen::MatrixXd& q);
/// Where the strain of Poincaré sections is read: validation.gauge, by default an eighth of the beam from the clamp
/// (S4: 0.05 m of 0.4) [m]. @throws InvalidInput  for a chain
[[nodiscard]] double gauge_position(const Scene& scene);

}  // namespace slipmode::scene
