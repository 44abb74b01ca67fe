#include "cli/orbit_family.hpp"

#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>
#include <charconv>
#include <cmath>
#include <numbers>

namespace slipmode::cli {
namespace {

using friction::Drive;

/// The drive at a value of the key, where no scene need be built anew for it; else null.
std::function<Drive(double)> drive_over(const scene::Scene& scene, const std::string& key) {
  if (key == "drive.speed" && scene.drive.is_constant()) {
    return [](double speed) { return Drive(friction::Belt::constant(speed)); };
  }
  if (key == "drive.omega" && scene.force) {
    return [scene](double omega) { return scene::drive_at(scene, omega); };
  }
  if (key == "drive.frequency") {
    const double factor = scene.force ? 2.0 * std::numbers::pi : 1.0;
    return [scene, factor](double frequency) { return scene::drive_at(scene, factor * frequency); };
  }
  if (key == "drive.amplitude" && scene.force) {
    return [force = *scene.drive.force()](double amplitude) {
      friction::Force changed = force;
      changed.harmonics.front().amplitude = amplitude;
      return Drive(changed);
    };
  }
  return nullptr;
}

}  // namespace

OrbitRange parse_range(const std::string& text) {
  const auto complain = [&text](const std::string& what) {
    return InvalidInput(fmt::format("--over {}: {}; expected KEY=FROM:TO, e.g. drive.omega=1.8:0.3", text, what));
  };
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || equals == 0) throw complain("no KEY=");
  if (colon == std::string::npos) throw complain("no range FROM:TO");
  const auto number = [&](std::size_t begin, std::size_t end) {
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc() || stopped != text.data() + end || !std::isfinite(value)) {
      throw complain(fmt::format("'{}' is not a number", text.substr(begin, end - begin)));
    }
    return value;
  };
  const OrbitRange range{text.substr(0, equals), number(equals + 1, colon), number(colon + 1, text.size())};
  if (range.from == range.to) throw complain("the range has no length");
  return range;
}

orbits::SystemFamily orbit_family(const scene::Scene& scene, const OrbitRange& range, const Session& session,
                                  const std::optional<pod::Basis>& basis) {
  const auto build = [basis](const scene::Scene& own) {
    dynamics::HybridSystem full = scene::build_system(own);
    return basis ? rom::reduce(full, *basis) : full;
  };
  (void)scene::get_continuous_key(scene, range.key);
  for (const double end : {range.from, range.to}) (void)build(scene::set_key(scene, range.key, end));
  const auto polled = [&session](const auto& make) {
    return [&session, make](double value) {
      session.check_interrupt();
      return make(value);
    };
  };
  if (const auto drive = drive_over(scene, range.key)) {
    return polled([system = build(scene), drive](double value) { return system.with_drive(drive(value)); });
  }
  if (range.key.starts_with("drive.") && !range.key.starts_with("drive.mean")) {
    return polled([scene, key = range.key, system = build(scene)](double value) {
      return system.with_drive(scene::set_key(scene, key, value).drive);
    });
  }
  return polled([scene, key = range.key, build](double value) { return build(scene::set_key(scene, key, value)); });
}

}  // namespace slipmode::cli
