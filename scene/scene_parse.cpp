#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene_words.hpp>
#include "scene/internal/scene_parts.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <sstream>

namespace slipmode::scene {

namespace {

TimeSpec read_cycles(TomlReader& in, double frequency_hz) {
  for (const char* key : {"duration", "transient", "sample"}) {
    in.refuse(key, "the time is given in cycles too", "either cycles or seconds");
  }
  TimeSpec::Cycles cycles;
  cycles.cycles = in.number("cycles", kPositive);
  cycles.transient_cycles = in.number_or("transient_cycles", cycles.transient_cycles, kNonNegative);
  cycles.samples = in.integer_or("samples_per_cycle", cycles.samples, 1, kMostCount);
  if (cycles.transient_cycles >= cycles.cycles) {
    in.fail("transient_cycles", "nothing is left to keep", fmt::format("less than cycles = {}", cycles.cycles));
  }
  if ((cycles.cycles - cycles.transient_cycles) * static_cast<double>(cycles.samples) < 1.0) {
    in.fail("cycles", "no sample fits", "at least one sample after transient_cycles");
  }
  return in_seconds(cycles, frequency_hz);
}

TimeSpec read_seconds(TomlReader& in, bool periodic) {
  TimeSpec time;
  time.duration = in.number("duration", kPositive);
  time.transient = in.number_or("transient", time.transient, kNonNegative);
  time.sample = periodic ? in.number("sample", kPositive) : in.number_or("sample", time.sample, kPositive);
  if (time.transient >= time.duration) {
    in.fail("transient", "nothing is left to keep", fmt::format("less than duration = {}", time.duration));
  }
  if (time.sample > time.duration - time.transient) {
    in.fail("sample", "no sample fits",
            fmt::format("at most duration - transient = {}", time.duration - time.transient));
  }
  return time;
}

TimeSpec read_time(TomlReader in, const friction::Drive& drive) {
  constexpr std::array kCycleKeys = {"cycles", "transient_cycles", "samples_per_cycle"};
  TimeSpec time;
  if (const auto period = drive.period()) {
    const bool counted = std::ranges::any_of(kCycleKeys, [&in](const char* key) { return in.has(key); });
    const double frequency = drive.shaker() != nullptr ? drive.shaker()->frequency_hz : 1.0 / *period;
    time = counted ? read_cycles(in, frequency) : read_seconds(in, true);
  } else {
    for (const char* key : kCycleKeys) {
      in.refuse(key, "counts a shaker's cycles or a force's, the drive is a belt", "duration");
    }
    time = read_seconds(in, false);
  }
  in.finish();
  return time;
}

InitialSpec read_initial(TomlReader in, const Scene& scene) {
  InitialSpec initial;
  const bool given = in.has("displacement") || in.has("velocity");
  if (given && in.has("at")) in.fail("at", "displacement or velocity is given too", "either at, or arrays");
  initial.at = kStarts[in.choice_or("at", 0, words_of(kStarts))].at;
  if (initial.at == InitialSpec::At::kStatic) {
    constexpr const char* kValid = "\"rest\", or displacement and velocity";
    if (scene.drive.belt() == nullptr) {
      const char* kind = scene.force ? "force" : "shaker";
      in.fail("at", fmt::format("a {} has no steady sliding to be in equilibrium with", kind), kValid);
    }
    const auto loose = [](const ContactSpec& own) { return std::holds_alternative<friction::Clearance>(own.law); };
    if (std::ranges::any_of(scene.contacts, loose)) {
      in.fail("at", "with a clearance the equilibrium depends on which stops are touched", kValid);
    }
  }
  if (given) {
    const std::vector<double> zero(static_cast<std::size_t>(scene.size()), 0.0);
    initial.at = InitialSpec::At::kGiven;
    initial.displacement = in.numbers_or("displacement", zero, kFinite, scene.size());
    initial.velocity = in.numbers_or("velocity", zero, kFinite, scene.size());
  }
  in.finish();
  return initial;
}

std::vector<double> read_frequencies(TomlReader& in, const friction::AmplitudeCurve& amplitude) {
  const std::vector<double> frequencies = in.numbers_or("frequencies", {}, kPositive);
  for (const double frequency : frequencies) {
    if (amplitude.covers(frequency, frequency)) continue;
    in.fail("frequencies", fmt::format("the amplitude curve has no value >= 0 at {} Hz", frequency),
            "frequencies the curve of drive.amplitude covers");
  }
  return frequencies;
}

EnsembleSpec read_ensemble(TomlReader in, const Scene& scene) {
  EnsembleSpec ensemble;
  ensemble.members = static_cast<int>(in.integer_or("members", ensemble.members, 1, kMostCount));
  ensemble.seed = static_cast<std::uint64_t>(in.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  ensemble.spread = in.number_or("spread", ensemble.spread, kNonNegative);
  if (scene.force) {
    for (const char* key : {"speeds", "frequencies"}) {
      in.refuse(key, "belongs to a belt or a shaker, the drive is a force",
                "no such key; change drive.omega with --set");
    }
  } else if (scene.drive.shaker() != nullptr) {
    in.refuse("speeds", "belongs to a belt, the drive is a shaker", "frequencies");
    ensemble.frequencies = read_frequencies(in, scene.amplitude);
  } else {
    in.refuse("frequencies", "belongs to a shaker, the drive is a belt", "speeds");
    ensemble.speeds = in.numbers_or("speeds", {}, kFinite);
  }
  in.finish();
  return ensemble;
}

dynamics::FlowOptions read_flow(TomlReader in) {
  dynamics::FlowOptions flow;
  flow.method = kMethods[in.choice_or("method", 0, words_of(kMethods))].method;
  flow.tolerance = in.number_or("tolerance", flow.tolerance,
                                {.low = 0.0, .high = 1.0, .above = true, .text = "a number > 0 and <= 1"});
  flow.max_events_per_window =
      static_cast<int>(in.integer_or("max_events_per_window", flow.max_events_per_window, 1, kMostCount));
  flow.zeno_window = in.number_or("zeno_window", flow.zeno_window, kNonNegative);
  in.finish();
  return flow;
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

Scene parse_scene(const std::string& text, const std::vector<std::string>& overrides, const std::string& path) {
  const TomlDocument document(text, path, overrides);
  TomlReader in(document);
  Scene scene;
  scene.source = {path, text, overrides};
  scene.title = in.text_or("title", "");
  scene.units = kUnits[in.choice("units", kUnits)];
  scene.structure = read_structure(in.table("structure"), scene.units);
  scene.contacts = read_contacts(in, scene);
  read_drive(in.table("drive"), scene);
  scene.time = read_time(in.table("time"), scene.drive);
  scene.initial = read_initial(in.table_or_empty("initial"), scene);
  scene.ensemble = read_ensemble(in.table_or_empty("ensemble"), scene);
  if (scene.beam() == nullptr) {
    in.refuse("sensors", "sensors are for beams, the structure has masses", "structure.kind = \"beam\" with it");
  } else if (in.has("sensors")) {
    scene.sensors = read_sensors(in.table("sensors"), scene);
  }
  scene.reduction = read_reduction(in.table_or_empty("reduction"), scene);
  if (scene.force) {
    in.refuse("validation", "compares under a belt or a shaker, the drive is a force",
              "no such table; find and continue orbits with 'slipmode orbit'");
  } else if (scene.drive.shaker() != nullptr) {
    scene.shaken = read_shaken_validation(in.table_or_empty("validation"), scene);
  } else {
    scene.validation = read_validation(in.table_or_empty("validation"), scene);
  }
  scene.flow = read_flow(in.table_or_empty("flow"));
  in.finish();
  return scene;
}

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return parse_scene(read_file(path), overrides, path.string());
}

}  // namespace slipmode::scene
