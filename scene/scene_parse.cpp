#include <slipmode/core/errors.hpp>
#include <slipmode/scene/own_times.hpp>
#include "scene/internal/periods.hpp"
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

namespace slipmode::scene {

namespace {

/// What a list or a range of a drive's own key is called (see drive_key).
struct DriveValues {
  const char *key, *values, *owner;
};
constexpr std::array kDriveValues{
    DriveValues{"drive.speed", "speeds", "a belt"},
    DriveValues{"drive.frequency", "frequencies", "a shaker or a force given in Hz"},
    DriveValues{"drive.omega", "omegas", "a force given by omega"},
};

TimeSpec read_cycles(TomlReader& in, const friction::Drive& drive) {
  refuse_others<TimeSpec, TimeSpec::Cycles>(in, "the time is given in cycles too", "either cycles or seconds");
  TimeSpec::Cycles cycles = in.has("cycles") ? TimeSpec::Cycles{} : kUsualCycles;
  read_fields(in, cycles);
  if (cycles.transient_cycles >= cycles.cycles) {
    in.fail("transient_cycles", "nothing is left to keep", fmt::format("less than cycles = {}", cycles.cycles));
  }
  if ((cycles.cycles - cycles.transient_cycles) * static_cast<double>(cycles.samples) < 1.0) {
    in.fail("cycles", "no sample fits", "at least one sample after transient_cycles");
  }
  return in_seconds(cycles, drive);
}

/// On a belt what is not given is chosen by the structure's slowest period.
void choose_times(TomlReader& in, Scene& scene, TimeSpec& out_time) {
  if (in.has("duration") && in.has("sample")) return;
  const double period = scene.source.period = slowest_period(scene);
  if (!in.has("duration")) {
    if (period == 0.0) {
      in.fail("duration", "missing, and nothing vibrates by whose period it could be chosen", kPositive.text);
    }
    if (!in.has("transient")) out_time.transient = to_one_digit(kTransientPeriods * period);
    out_time.duration = out_time.transient + to_one_digit(kKeptPeriods * period);
  }
  if (in.has("sample")) return;
  constexpr double kFewest = 100.0;  // samples of a record shorter than the period
  const double longest = to_one_digit((out_time.duration - out_time.transient) / kFewest);
  out_time.sample = period == 0.0 ? longest : std::min(to_one_digit(kSamplePeriods * period), longest);
}

TimeSpec read_seconds(TomlReader& in, Scene& scene) {
  TimeSpec time;
  read_fields(in, time);
  if (in.has("duration") && time.transient >= time.duration) {
    in.fail("transient", "nothing is left to keep", fmt::format("less than duration = {}", time.duration));
  }
  if (const auto cycle = scene.drive.period()) {
    in.require("duration");
    if (!in.has("sample")) time.sample = *cycle / static_cast<double>(kUsualCycles.samples);
  } else {
    choose_times(in, scene, time);
  }
  if (time.sample > time.duration - time.transient) {
    in.fail("sample", "no sample fits",
            fmt::format("at most duration - transient = {}", time.duration - time.transient));
  }
  return time;
}

/// [time] into time, and period of the source, of `scene`.
void read_time(TomlReader in, Scene& scene) {
  TimeSpec& time = scene.time;
  const friction::Drive& drive = scene.drive;
  if (drive.period()) {
    const bool in_cycles = has_any<TimeSpec::Cycles>(in) || !has_any<TimeSpec>(in);
    time = in_cycles ? read_cycles(in, drive) : read_seconds(in, scene);
  } else {
    refuse_others<TimeSpec::Cycles, TimeSpec>(in, "counts a shaker's cycles or a force's, the drive is a belt",
                                              "duration");
    time = read_seconds(in, scene);
  }
  in.finish();
}

InitialSpec read_initial(TomlReader in, const Scene& scene) {
  InitialSpec initial;
  const bool given = in.has("displacement") || in.has("velocity");
  if (given && in.has("at")) in.fail("at", "displacement or velocity is given too", "either at, or arrays");
  read_fields(in, initial, {.without = {"displacement", "velocity"}});
  if (initial.at == InitialSpec::At::kStatic) {
    constexpr const char* kValid = "\"rest\", or displacement and velocity";
    if (scene.drive.belt() == nullptr) {
      const char* kind = scene.force ? "force" : "shaker";
      in.fail("at", fmt::format("a {} has no steady sliding to be in equilibrium with", kind), kValid);
    }
    const auto loose = [](const ContactSpec& own) { return friction::clearance(own.law) != nullptr; };
    if (std::ranges::any_of(scene.contacts, loose)) {
      in.fail("at", "with a clearance the equilibrium depends on which stops are touched", kValid);
    }
  }
  if (given) {
    initial.at = InitialSpec::At::kGiven;
    initial.displacement.assign(static_cast<std::size_t>(scene.size()), 0.0);
    initial.velocity = initial.displacement;
    read_fields(in, initial, {.without = {"at"}, .count = [&scene](std::string_view) { return scene.size(); }});
  }
  in.finish();
  return initial;
}

EnsembleSpec read_ensemble(TomlReader in, const Scene& scene) {
  refuse_values_of_other_drives(in, scene);
  EnsembleSpec ensemble;
  read_fields(in, ensemble, {.without = values_of_other_drives(scene)});
  for (const double frequency : ensemble.frequencies) {
    if (scene.force || scene.amplitude.covers(frequency, frequency)) continue;
    in.fail("frequencies", fmt::format("the amplitude curve has no value >= 0 at {} Hz", frequency),
            "frequencies the curve of drive.amplitude covers");
  }
  in.finish();
  return ensemble;
}

std::set<std::string> keys_given(const TomlDocument& document, const std::vector<std::string>& overrides) {
  std::set<std::string> given = document.written();
  for (const std::string& change : overrides) note_given(given, change.substr(0, change.find_first_of(" =")));
  for (const auto& [name, node] : document.root()) {
    if (const toml::table* table = node.as_table()) {
      for (const auto& [key, value] : *table) given.insert(fmt::format("{}.{}", name.str(), key.str()));
    }
  }
  return given;
}

std::string read_file(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw InvalidInput(fmt::format("{}: no such scene file; check the path", path.string()));
  }
  if (std::filesystem::is_directory(path)) {
    throw InvalidInput(
        fmt::format("{}: is a folder; expected a scene file such as {}/scene.toml", path.string(), path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw InvalidInput(fmt::format("{}: cannot be read; check its permissions", path.string()));
  return text.str();
}

}  // namespace

Without values_of_other_drives(const Scene& scene) {
  Without others;
  for (const DriveValues& one : kDriveValues)
    if (drive_key(scene) != one.key) others.emplace_back(one.values);
  return others;
}

void refuse_values_of_other_drives(TomlReader& in, const Scene& scene) {
  const auto own = std::ranges::find(kDriveValues, drive_key(scene), &DriveValues::key);
  const std::string drive = scene.drive.belt() != nullptr ? "a belt"
                            : scene.force == std::nullopt ? "a shaker"
                            : scene.force->frequency_hz   ? "a force given in Hz"
                                                          : "a force given by omega";
  for (const DriveValues& one : kDriveValues) {
    if (one.key == own->key) continue;
    in.refuse(one.values, fmt::format("belongs to {}, the drive is {}", one.owner, drive), own->values);
  }
}

Scene parse_scene(const std::string& text, const std::vector<std::string>& overrides, const std::string& path) {
  const TomlDocument document(text, path, overrides);
  TomlReader in(document);
  Scene scene;
  scene.source = {.path = path, .text = text, .overrides = overrides, .given = keys_given(document, overrides)};
  scene.title = in.text_or("title", "");
  scene.units = kUnits[in.choice("units", kUnits)];
  scene.structure = read_structure(in.table("structure"), scene.units);
  scene.contacts = read_contacts(in, scene);
  read_drive(in.table("drive"), scene);
  read_time(in.table_or_empty("time"), scene);
  scene.initial = read_initial(in.table_or_empty("initial"), scene);
  scene.ensemble = read_ensemble(in.table_or_empty("ensemble"), scene);
  if (scene.beam() == nullptr) {
    in.refuse("sensors", "sensors are for beams, the structure has masses", "structure.kind = \"beam\" with it");
  } else if (in.has("sensors")) {
    scene.sensors = read_sensors(in.table("sensors"), scene);
  }
  scene.reduction = read_reduction(in.table_or_empty("reduction"), scene);
  if (scene.drive.period()) {
    scene.driven = read_driven_validation(in.table_or_empty("validation"), scene);
  } else {
    scene.validation = read_validation(in.table_or_empty("validation"), scene);
  }
  scene.flow = read_table<dynamics::FlowOptions>(in.table_or_empty("flow"), scene.flow);
  in.finish();
  return scene;
}

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return parse_scene(read_file(path), overrides, path.string());
}

}  // namespace slipmode::scene
