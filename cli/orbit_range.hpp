#pragma once

#include <slipmode/studies/family.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// KEY=FROM:TO, a range followed without steps.
struct OrbitRange {
  std::string key;
  double from = 0.0, to = 0.0;

  [[nodiscard]] double low() const { return from < to ? from : to; }
  [[nodiscard]] double high() const { return from < to ? to : from; }
  [[nodiscard]] bool holds(double value) const { return low() <= value && value <= high(); }
};

/// @throws InvalidInput  saying what is wrong with the text, or that the range has no length
[[nodiscard]] OrbitRange parse_range(const std::string& text);

/// The scene's family over a range, both ends tried; a stop flag that is set interrupts whatever asks it for a system.
/// @throws InvalidInput  for a key that cannot be varied continuously (scene::get_continuous_key), or a scene that
///                       refuses an end of the range
[[nodiscard]] orbits::SystemFamily systems_over(const studies::Family& family, const OrbitRange& range,
                                                const Session& session);

}  // namespace slipmode::cli
