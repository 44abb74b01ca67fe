#pragma once

// The readers of a scene's tables. Each throws as TomlReader does.

#include <slipmode/scene/scene.hpp>
#include "scene/internal/toml_fields.hpp"

#include <set>
#include <string>

namespace slipmode::scene {

/// A position computed by hand may miss an end by rounding; fem::Beam takes as much.
inline constexpr double kEndSlack = 1e-12;

/// Length of a beam's spans; with its rigid extension [m].
[[nodiscard]] double beam_length(const fem::BeamOptions& beam);
[[nodiscard]] double beam_reach(const fem::BeamOptions& beam);

/// The fields of a span that a theory has not.
[[nodiscard]] Without without_shear(fem::BeamTheory theory);
/// The fields of [ensemble] and [validation] that hold values of another drive's own key, see drive_key.
[[nodiscard]] Without values_of_other_drives(const Scene& scene);
/// The fields of DrivenValidationSpec that a scene has not.
[[nodiscard]] Without without_in_validation(const Scene& scene);
/// Refuses values_of_other_drives, naming the one that is this drive's own.
void refuse_values_of_other_drives(TomlReader& in, const Scene& scene);

/// [structure] of any kind.
[[nodiscard]] StructureSpec read_structure(TomlReader in, const std::string& units);
/// [structure] kind = "masses" and "matrices", the kind read already.
[[nodiscard]] fem::MassesOptions read_masses(TomlReader& in, const std::string& units);
[[nodiscard]] MatricesSpec read_matrices(TomlReader& in, const std::string& units);
/// The structure of matrices that were read.
[[nodiscard]] fem::Structure structure_of(const MatricesSpec& spec);
/// `at` or `between` on the structure of `scene`.
[[nodiscard]] ContactPlace read_place(TomlReader& in, const Scene& scene);
/// [[contact]] on the structure of `scene`.
[[nodiscard]] std::vector<ContactSpec> read_contacts(TomlReader& in, const Scene& scene);
/// What `law` of a [[contact]] may be: a law, or a joint, which is contacts of another law side by side. Its words are
/// those of friction::law_words and, last, the joint's.
using LawSpec = std::variant<friction::Law, friction::Iwan>;
[[nodiscard]] std::vector<std::string> law_spec_words();
/// The law of one [[contact]] and its keys.
[[nodiscard]] LawSpec read_law(TomlReader& in);
/// [drive] into drive and amplitude of `scene`.
void read_drive(TomlReader in, Scene& scene);
/// [drive] kind = "force", the kind read already.
[[nodiscard]] ForceSpec read_force(TomlReader& in, const Scene& scene);
/// The drive of a force: its harmonics act along force_places, each place once.
[[nodiscard]] friction::Force force_drive(const ForceSpec& spec);
[[nodiscard]] std::vector<ForcePlace> force_places(const ForceSpec& spec);
/// [sensors] on the beam of `scene`.
[[nodiscard]] SensorSpec read_sensors(TomlReader in, const Scene& scene);
/// [reduction] with the sensors of `scene`.
[[nodiscard]] ReductionSpec read_reduction(TomlReader in, const Scene& scene);
/// [validation] on a belt, and under a shaker or a force.
[[nodiscard]] ValidationSpec read_validation(TomlReader in, const Scene& scene);
[[nodiscard]] DrivenValidationSpec read_driven_validation(TomlReader in, const Scene& scene);

/// The time in seconds of a time in cycles of a drive.
[[nodiscard]] TimeSpec in_seconds(const TimeSpec::Cycles& cycles, const friction::Drive& drive);

/// Adds the key of an override to SceneSource::given.
void note_given(std::set<std::string>& out_given, const std::string& key);

}  // namespace slipmode::scene
