#pragma once

#include "scene/internal/toml_reader.hpp"

#include <string>
#include <vector>

namespace slipmode::tests {

/// The numbers of a key of an expected.toml; none where it is not there.
[[nodiscard]] inline std::vector<double> numbers_if_any(scene::TomlReader& in, const std::string& key,
                                                        const Limits& limits = kFinite, std::int64_t count = -1) {
  return in.has(key) ? in.numbers(key, limits, count) : std::vector<double>();
}

}  // namespace slipmode::tests
