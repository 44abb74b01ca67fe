#pragma once

#include <string>
#include <vector>

namespace slipmode::scene {

/// The kinds of new_scene: "chain", "beam", "matrices", "clearance".
[[nodiscard]] std::vector<std::string> new_scene_kinds();

/// A small scene to start from, each key with what it means and its unit, each table with what else it takes; runs at
/// once. @param name  how its comments call the file
/// @throws InvalidInput  for a kind that is none of new_scene_kinds
[[nodiscard]] std::string new_scene(const std::string& kind, const std::string& name);

}  // namespace slipmode::scene
