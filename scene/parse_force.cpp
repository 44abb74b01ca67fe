#include "scene/internal/scene_parts.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <numbers>
#include <tuple>

namespace slipmode::scene {

namespace {

ForcePlace read_force_place(TomlReader& in, const Scene& scene) {
  if (!in.has("direction")) return read_place(in, scene);
  for (const char* key : {"at", "between"}) in.refuse(key, "direction is given too", "either a place or a direction");
  std::vector<double> direction = in.numbers("direction", kFinite, scene.size());
  if (std::ranges::all_of(direction, [](double x) { return x == 0.0; })) {
    in.fail("direction", "all zero", "one number per degree of freedom, not all 0");
  }
  return direction;
}

/// A harmonic after the first; it acts where the first does when it names no place.
ForceSpec::Harmonic read_harmonic(TomlReader& in, const Scene& scene, const ForcePlace& otherwise) {
  ForceSpec::Harmonic harmonic;
  read_fields(in, harmonic);
  const bool own = in.has("at") || in.has("between") || in.has("direction");
  harmonic.at = own ? read_force_place(in, scene) : otherwise;
  in.finish();
  return harmonic;
}

/// Places compare equal when they say the same.
bool same(const ForcePlace& a, const ForcePlace& b) {
  if (a.index() != b.index()) return false;
  if (const auto* direction = std::get_if<std::vector<double>>(&a)) return *direction == std::get<1>(b);
  return to_string(std::get<ContactPlace>(a)) == to_string(std::get<ContactPlace>(b));
}

}  // namespace

ForceSpec read_force(TomlReader& in, const Scene& scene) {
  in.refuse("speed", "belongs to a belt, the drive is a force", "omega and amplitude, or kind = \"belt\"");
  ForceSpec spec;
  if (in.has("frequency")) {
    in.refuse("omega", "frequency is given too", "either omega [rad/s] or frequency [Hz]");
    spec.frequency_hz = in.number("frequency", kPositive);
    spec.omega = 2.0 * std::numbers::pi * *spec.frequency_hz;
  } else {
    spec.omega = in.number("omega", kPositive);
  }
  ForceSpec::Harmonic first;
  read_fields(in, first, {.without = {"order"}});
  first.at = read_force_place(in, scene);
  spec.harmonics = {first};
  if (in.has("harmonic")) {
    for (TomlReader& table : in.tables("harmonic")) {
      spec.harmonics.push_back(read_harmonic(table, scene, first.at));
    }
  }
  if (in.is_array("mean")) {
    spec.mean = in.numbers("mean", kFinite, scene.size());
  } else {
    spec.mean = in.number_or("mean", 0.0, kFinite);
  }
  return spec;
}

std::vector<ForcePlace> force_places(const ForceSpec& spec) {
  std::vector<ForcePlace> places;
  for (const ForceSpec::Harmonic& harmonic : spec.harmonics) {
    const bool known = std::ranges::any_of(places, [&](const ForcePlace& at) { return same(at, harmonic.at); });
    if (!known) places.push_back(harmonic.at);
  }
  return places;
}

friction::Force force_drive(const ForceSpec& spec) {
  const std::vector<ForcePlace> places = force_places(spec);
  friction::Force force{.omega = spec.omega};
  for (const ForceSpec::Harmonic& harmonic : spec.harmonics) {
    const auto place = std::ranges::find_if(places, [&](const ForcePlace& at) { return same(at, harmonic.at); });
    force.harmonics.push_back({.amplitude = harmonic.amplitude,
                               .phase = harmonic.phase,
                               .order = harmonic.order,
                               .direction = static_cast<int>(place - places.begin())});
  }
  return force;
}

}  // namespace slipmode::scene
