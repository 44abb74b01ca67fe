#pragma once

#include <slipmode/orbits/continuation.hpp>
#include <slipmode/pod/basis.hpp>
#include "cli/session.hpp"

#include <optional>
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

/// Systems over one key of a scene, projected when a basis is given. Under a key of the drive alone all share modal
/// data and regimes.
/// @throws InvalidInput  for a key that cannot be varied continuously (scene::get_continuous_key), or a scene that
///                       refuses an end of the range
[[nodiscard]] orbits::SystemFamily orbit_family(const scene::Scene& scene, const OrbitRange& range,
                                                const Session& session, const std::optional<pod::Basis>& basis = {});

}  // namespace slipmode::cli
