#include <slipmode/core/errors.hpp>
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace slipmode::scene {

namespace {

friction::Belt read_belt(TomlReader& in) {
  for (const char* key : {"frequency", "amplitude", "phase"}) {
    in.refuse(key, "belongs to a shaker or a force, the drive is a belt", "speed, or kind = \"shaker\" or \"force\"");
  }
  friction::Belt belt;
  if (in.is_table("speed")) {
    TomlReader ramp = in.table("speed");
    read_fields(ramp, belt);
    if (belt.ramp_end <= belt.ramp_begin) ramp.fail("end", "not after begin", fmt::format("> {}", belt.ramp_begin));
    ramp.finish();
  } else {
    belt = friction::Belt::constant(in.number("speed", kFinite));
  }
  return belt;
}

friction::AmplitudeCurve read_curve(TomlReader in) {
  friction::AmplitudeCurve curve;
  const auto given = std::ranges::count_if(std::array{"polynomial", "table", "exponential"},
                                           [&in](const char* key) { return in.has(key); });
  in.finish();
  if (in.has("exponential")) {
    curve.kind = read_table<friction::AmplitudeCurve::Exponential>(in.table("exponential"));
  } else if (in.has("table")) {
    curve.kind = friction::AmplitudeCurve::Table{in.pairs("table", kPositive, kNonNegative)};
  } else {
    curve.kind = friction::AmplitudeCurve::Polynomial{in.numbers("polynomial", kFinite)};
  }
  const char* key = in.has("exponential") ? "exponential" : in.has("table") ? "table" : "polynomial";
  constexpr const char* kValid =
      "exactly one of polynomial = [a0, a1, ...], table = [[f, A], ...] with f ascending, exponential = { at, "
      "amplitude, decay }";
  if (given > 1) in.fail(key, "another curve is given too", kValid);
  try {
    friction::validate(curve);
  } catch (const InvalidInput& error) {
    in.fail(key, error.what(), kValid);
  }
  return curve;
}

friction::AmplitudeCurve read_amplitude(TomlReader& in) {
  if (in.is_table("amplitude")) return read_curve(in.table("amplitude"));
  const Limits limits{.low = 0.0, .text = "a number >= 0, or a curve { polynomial | table | exponential = ... }"};
  return {friction::AmplitudeCurve::Constant{in.number("amplitude", limits)}};
}

}  // namespace

void read_drive(TomlReader in, Scene& scene) {
  const std::string kind = kDrives[in.choice("kind", kDrives)];
  if (kind == "belt") {
    scene.drive = read_belt(in);
    in.finish();
    return;
  }
  if (kind == "force") {
    scene.force = read_force(in, scene);
    in.finish();
    scene.drive = force_drive(*scene.force);
    return;
  }
  in.refuse("speed", "belongs to a belt, the drive is a shaker", "frequency and amplitude, or kind = \"belt\"");
  in.refuse("omega", "belongs to a force, the drive is a shaker", "frequency, or kind = \"force\"");
  friction::Shaker shaker;
  read_fields(in, shaker, {.without = {"amplitude"}});
  scene.amplitude = read_amplitude(in);
  try {
    shaker.amplitude = scene.amplitude.at(shaker.frequency_hz);
  } catch (const InvalidInput& error) {
    in.fail("frequency", error.what(), "a frequency the amplitude curve covers");
  }
  in.finish();
  scene.drive = shaker;
}

}  // namespace slipmode::scene
