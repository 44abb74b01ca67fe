#include "core/errors.hpp"
#include "scene/scene.hpp"
#include "scene/toml_reader.hpp"

#include <fmt/format.h>
#include <sstream>

namespace slipmode::scene {

Scene set_key(const Scene& scene, const std::string& path, double value) {
  const std::string change = fmt::format("{}={}", path, value);
  Scene changed = parse_scene(scene_to_toml(scene), {change}, scene.source.path);
  changed.source = scene.source;
  changed.source.overrides.push_back(change);
  return changed;
}

double get_key(const Scene& scene, const std::string& path) {
  const TomlDocument document(scene_to_toml(scene), scene.source.path, {});
  const toml::node* node = &document.root();
  std::istringstream parts(path);
  for (std::string part; node != nullptr && std::getline(parts, part, '.');) {
    if (const toml::table* table = node->as_table()) {
      node = table->get(part);
    } else if (const toml::array* array = node->as_array()) {
      const bool digits = !part.empty() && part.size() < 9 && part.find_first_not_of("0123456789") == std::string::npos;
      node = digits ? array->get(std::stoul(part)) : nullptr;
    } else {
      node = nullptr;
    }
  }
  if (node == nullptr) {
    throw InvalidInput(fmt::format("{}: {}: no such key; valid are those of the scene file, for example drive.speed",
                                   scene.source.path, path));
  }
  if (!node->is_number()) {
    throw InvalidInput(
        fmt::format("{}: {} = {}: not a number; choose a numeric key", scene.source.path, path, value_text(*node)));
  }
  return node->value<double>().value();
}

}  // namespace slipmode::scene
