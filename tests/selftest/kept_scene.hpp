#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace slipmode::selftest {

/// A scene kept as a text, as its generator may change.
inline std::string kept_scene(const std::string& name) {
  std::ifstream file(SLIPMODE_SOURCE_DIR "/tests/selftest/scenes/" + name + ".toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace slipmode::selftest
