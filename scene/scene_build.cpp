#include <slipmode/core/errors.hpp>
#include <slipmode/core/overloaded.hpp>
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <numbers>

namespace slipmode::scene {

namespace {

const fem::BeamOptions& beam_of(const Scene& scene, const char* what) {
  if (scene.beam() != nullptr) return *scene.beam();
  throw InvalidInput(fmt::format("{}: structure.kind = \"{}\": {} is for beams; valid: a scene with kind = \"beam\"",
                                 scene.source.path, kStructures[scene.structure.index()], what));
}

const SensorSpec& sensors_of(const Scene& scene) {
  if (scene.sensors) return *scene.sensors;
  throw InvalidInput(fmt::format("{}: sensors: missing table; add [sensors] with kind and x", scene.source.path));
}

/// Row over the degrees of freedom that gives the contact's displacement.
Eigen::VectorXd direction(const ContactPlace& place, const fem::Structure& structure, const fem::Beam* beam) {
  const Eigen::Index n = structure.size();
  if (const int* mass = std::get_if<int>(&place)) return Eigen::VectorXd::Unit(n, *mass - 1);
  if (const auto* pair = std::get_if<Between>(&place)) {
    return Eigen::VectorXd::Unit(n, pair->second - 1) - Eigen::VectorXd::Unit(n, pair->first - 1);
  }
  const double* x = std::get_if<double>(&place);
  return beam->displacement_row(x != nullptr ? *x : beam->reach());
}

Eigen::VectorXd direction(const ForcePlace& place, const fem::Structure& structure, const fem::Beam* beam) {
  if (const auto* at = std::get_if<ContactPlace>(&place)) return direction(*at, structure, beam);
  return Eigen::Map<const Eigen::VectorXd>(std::get<1>(place).data(), structure.size());
}

/// What a force's mean and harmonics act along.
struct ForceRows {
  Eigen::VectorXd load;
  Eigen::MatrixXd directions;
};

ForceRows force_rows(const Scene& scene, const fem::Structure& structure, const fem::Beam* beam) {
  if (!scene.force) return {};
  const std::vector<ForcePlace> places = force_places(*scene.force);
  ForceRows rows;
  rows.directions.resize(structure.size(), static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index k = 0; k < rows.directions.cols(); ++k) {
    rows.directions.col(k) = direction(places[static_cast<std::size_t>(k)], structure, beam);
  }
  if (const double* mean = std::get_if<double>(&scene.force->mean)) {
    if (*mean != 0.0) rows.load = *mean * rows.directions.col(0);
  } else {
    const auto& list = std::get<1>(scene.force->mean);
    rows.load = Eigen::Map<const Eigen::VectorXd>(list.data(), structure.size());
  }
  return rows;
}

void give_law(const ContactSpec& spec, friction::Contact& out_contact) {
  out_contact.law = spec.law;
  out_contact.normal_load = spec.normal_load;
  out_contact.tilt = spec.tilt_deg * std::numbers::pi / 180.0;
}

dynamics::HybridSystem assemble(const Scene& scene, fem::Structure structure, const fem::Beam* beam) {
  std::vector<friction::Contact> contacts;
  for (const ContactSpec& spec : scene.contacts) {
    friction::Contact contact;
    contact.direction = direction(spec.at, structure, beam);
    give_law(spec, contact);
    contact.name = spec.name;
    contacts.push_back(std::move(contact));
  }
  ForceRows force = force_rows(scene, structure, beam);
  return {std::move(structure), std::move(contacts), scene.drive, std::move(force.load), std::move(force.directions)};
}

}  // namespace

std::string Scene::name() const {
  return title.empty() ? std::filesystem::path(source.path).filename().string() : title;
}

Eigen::Index Scene::size() const {
  return std::visit(Overloaded{[](const fem::ChainOptions& own) -> Eigen::Index { return own.masses; },
                               [](const fem::BeamOptions& own) -> Eigen::Index {
                                 Eigen::Index nodes = 0;  // the clamped one has no freedom
                                 for (const fem::BeamSpan& span : own.spans) nodes += span.elements;
                                 return 2 * nodes;
                               },
                               [](const fem::MassesOptions& own) { return static_cast<Eigen::Index>(own.mass.size()); },
                               [](const MatricesSpec& own) { return own.mass.rows(); }},
                    structure);
}

fem::Beam build_beam(const Scene& scene) { return fem::Beam(beam_of(scene, "a finite-element beam")); }

dynamics::HybridSystem build_system(const Scene& scene) {
  return std::visit(
      Overloaded{[&](const fem::ChainOptions& own) { return assemble(scene, fem::chain(own), nullptr); },
                 [&](const fem::BeamOptions&) { return build_system(scene, build_beam(scene)); },
                 [&](const fem::MassesOptions& own) { return assemble(scene, fem::masses(own), nullptr); },
                 [&](const MatricesSpec& own) { return assemble(scene, structure_of(own), nullptr); }},
      scene.structure);
}

dynamics::HybridSystem build_system(const Scene& scene, const fem::Beam& beam) {
  return assemble(scene, beam.structure(), &beam);
}

dynamics::HybridSystem with_laws_of(const Scene& scene, const dynamics::HybridSystem& system) {
  std::vector<friction::Contact> contacts = system.contacts();
  if (contacts.size() != scene.contacts.size()) {
    throw InvalidInput(fmt::format("{}: expected the {} contacts of the model, found {}", scene.source.path,
                                   contacts.size(), scene.contacts.size()));
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) give_law(scene.contacts[c], contacts[c]);
  return system.with_laws(std::move(contacts));
}

std::string drive_key(const Scene& scene) {
  if (scene.drive.belt() != nullptr) return "drive.speed";
  return scene.force && !scene.force->frequency_hz ? "drive.omega" : "drive.frequency";
}

friction::Drive drive_at(const Scene& scene, double value) {
  if (const friction::Force* force = scene.drive.force())
    return friction::Force{scene.force->frequency_hz ? 2.0 * std::numbers::pi * value : value, force->harmonics};
  const friction::Shaker* shaker = scene.drive.shaker();
  if (shaker == nullptr) return friction::Belt::constant(value);
  return friction::Shaker{scene.amplitude.at(value), value, shaker->phase};
}

double drive_parameter(const Scene& scene) {
  if (scene.force) return scene.force->frequency_hz.value_or(scene.force->omega);
  const friction::Shaker* shaker = scene.drive.shaker();
  return shaker != nullptr ? shaker->frequency_hz : scene.drive.velocity(0.0);
}

TimeSpec in_seconds(const TimeSpec::Cycles& cycles, const friction::Drive& drive) {
  const double frequency_hz = drive.frequency_hz();
  return {.duration = cycles.cycles / frequency_hz,
          .transient = cycles.transient_cycles / frequency_hz,
          .sample = 1.0 / (frequency_hz * static_cast<double>(cycles.samples)),
          .cycles = cycles};
}

TimeSpec time_at(const Scene& scene, double value) {
  return scene.time.cycles ? in_seconds(*scene.time.cycles, drive_at(scene, value)) : scene.time;
}

dynamics::SimulateOptions simulate_options(const Scene& scene) {
  dynamics::SimulateOptions options;
  options.duration = scene.time.duration;
  options.transient = scene.time.transient;
  options.sample = scene.time.sample;
  options.flow = scene.flow;
  return options;
}

pod::SensorArray sensor_array(const Scene& scene, const fem::Beam& beam) {
  const SensorSpec& sensors = sensors_of(scene);
  return {beam, pod::sensors_at(sensors.kind, sensors.x)};
}

pod::Noise sensor_noise(const Scene& scene) {
  const SensorSpec& sensors = sensors_of(scene);
  return {.deviation = sensors.noise, .scale = pod::NoiseScale::kRelativeRms, .seed = sensors.seed};
}

Eigen::MatrixXd sensor_readings(const Scene& scene, const fem::Beam& beam, const Eigen::MatrixXd& q) {
  const Eigen::MatrixXd exact = sensor_array(scene, beam).readings(q);
  return scene.sensors->noise > 0.0 ? pod::with_noise(exact, sensor_noise(scene)) : exact;
}

double gauge_position(const Scene& scene) {
  return scene.driven.gauge.value_or(beam_length(beam_of(scene, "a gauge")) / 8.0);
}

}  // namespace slipmode::scene
