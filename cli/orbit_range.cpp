#include "cli/orbit_range.hpp"

#include <fmt/format.h>
#include <charconv>
#include <cmath>

namespace slipmode::cli {

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

orbits::SystemFamily systems_over(const studies::Family& family, const OrbitRange& range, const Session& session) {
  (void)scene::get_continuous_key(family.scene(), range.key);
  for (const double end : {range.from, range.to}) (void)scene::set_key(family.scene(), range.key, end);
  return [family, &session](double value) {
    session.check_interrupt();
    return family.at({value});
  };
}

}  // namespace slipmode::cli
