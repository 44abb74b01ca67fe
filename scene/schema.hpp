#pragma once

#include <string>
#include <string_view>

namespace slipmode::scene {

/// Scene files as JSON Schema (draft 7), for TOML editors and validators: every key with its meaning, unit, default,
/// limits and words, from the same field lists that read it. What one key says about another is left to parse_scene:
/// whatever that takes is valid here.
[[nodiscard]] std::string scene_schema();

}  // namespace slipmode::scene
