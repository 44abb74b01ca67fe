#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/internal/periods.hpp"
#include "scene/internal/toml_reader.hpp"

#include <fmt/format.h>
#include <sstream>

namespace slipmode::scene {

Scene set_key(const Scene& scene, const std::string& path, double value) {
  const std::string change = fmt::format("{}={}", path, value);
  Scene changed = parse_scene(scene_to_toml(scene), {change}, scene.source.path);
  changed.source = scene.source;
  changed.source.overrides.push_back(change);
  if (leaves_time_open(scene)) {  // what the changed structure chooses, as whoever reads the source again will find
    changed.time = parse_scene(changed.source.text, changed.source.overrides, changed.source.path).time;
  }
  return changed;
}

namespace {

const toml::node* node_at(const TomlDocument& document, const std::string& path) {
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
  return node;
}

/// Where a side's key stands when both stops of a clearance are alike: contact.0.left.gap is contact.0.stop.gap.
std::string shared_stop(const std::string& path) {
  for (const std::string side : {".left.", ".right."}) {
    const std::size_t at = path.find(side);
    if (at != std::string::npos && path.starts_with("contact."))
      return path.substr(0, at) + ".stop." + path.substr(at + side.size());
  }
  return path;
}

/// The number at a path of the scene written out in full.
const toml::node& number_at(const TomlDocument& document, const std::string& scene_path, const std::string& path) {
  const toml::node* node = node_at(document, path);
  if (node == nullptr) node = node_at(document, shared_stop(path));
  if (node == nullptr) {
    throw InvalidInput(fmt::format("{}: {}: no such key; valid are those of the scene file, for example drive.speed",
                                   scene_path, path));
  }
  if (!node->is_number()) {
    throw InvalidInput(
        fmt::format("{}: {} = {}: not a number; choose a numeric key", scene_path, path, value_text(*node)));
  }
  return *node;
}

TomlDocument written_out(const Scene& scene) { return {scene_to_toml(scene), scene.source.path, {}}; }

}  // namespace

double get_key(const Scene& scene, const std::string& path) {
  return number_at(written_out(scene), scene.source.path, path).value<double>().value();
}

double get_continuous_key(const Scene& scene, const std::string& path) {
  const TomlDocument document = written_out(scene);
  const toml::node& node = number_at(document, scene.source.path, path);
  const auto refuse = [&](const std::string& what) {
    throw InvalidInput(fmt::format(
        "{}: {} = {}: {}; valid: a real number of [structure], [[contact]] or [drive], for example drive.omega",
        scene.source.path, path, value_text(node), what));
  };
  if (node.is_integer()) refuse("counts something and cannot be varied continuously");
  const bool model = path.starts_with("structure.") || path.starts_with("contact.") || path.starts_with("drive.");
  if (!model) refuse("is not part of the model");
  return node.value<double>().value();
}

bool has_section(const Scene& scene, const std::string& name) {
  const toml::table written = toml::parse(scene.source.text);
  if (written.contains(name)) return true;
  for (const std::string& override : scene.source.overrides) {
    if (override.starts_with("ensemble.seed=")) continue;
    if (override.starts_with(name + ".") || override.starts_with(name + "=")) return true;
  }
  return false;
}

}  // namespace slipmode::scene
