#include <slipmode/core/errors.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/internal/field_schema.hpp"
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/toml_reader.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <span>
#include <sstream>

namespace slipmode::scene {

namespace {

/// True when the scene says its [time] neither in cycles nor in full, so that its own periods have a say in it.
bool leaves_time_open(const Scene& scene) {
  if (scene.source.text.empty() || scene.time.cycles) return false;
  return !scene.source.given.contains("time.duration") || !scene.source.given.contains("time.sample");
}

/// Whether a key has a say in times left open: by the structure's slowest period on a belt, elsewhere by the drive's.
bool bears_on_time(const Scene& scene, const std::string& path) {
  return path.starts_with("time.") || path.starts_with(scene.drive.belt() != nullptr ? "structure." : "drive.");
}

}  // namespace

void note_given(std::set<std::string>& out_given, const std::string& key) {
  const std::size_t dot = key.find('.');
  if (key != "ensemble.seed") out_given.insert(key.substr(0, dot));
  if (dot != std::string::npos) out_given.insert(key.substr(0, key.find('.', dot + 1)));
}

Scene set_key(const Scene& scene, const std::string& path, double value) {
  const std::string change = fmt::format("{}={}", path, value);
  Scene changed = parse_scene(scene_to_toml(scene), {change}, scene.source.path);
  changed.source = scene.source;
  changed.source.overrides.push_back(change);
  note_given(changed.source.given, path);
  if (leaves_time_open(scene) && bears_on_time(scene, path)) {  // as whoever reads the source again will find
    const Scene again = parse_scene(changed.source.text, changed.source.overrides, changed.source.path);
    changed.time = again.time;
    changed.source.period = again.source.period;
  }
  return changed;
}

namespace {

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream in(path);
  for (std::string part; std::getline(in, part, '.');) parts.push_back(part);
  return parts;
}

/// What stands in a table or an array under this name or number; none where there is no such thing.
const toml::node* below(const toml::node* node, const std::string& part) {
  if (node == nullptr) return nullptr;
  if (const toml::table* table = node->as_table()) return table->get(part);
  const toml::array* array = node->as_array();
  const bool digits = !part.empty() && part.size() < 9 && part.find_first_not_of("0123456789") == std::string::npos;
  return array != nullptr && digits ? array->get(std::stoul(part)) : nullptr;
}

const toml::node* node_at(const TomlDocument& document, const std::string& path) {
  const toml::node* node = &document.root();
  for (const std::string& part : parts_of(path)) node = below(node, part);
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

/// Whether a node may be what a schema describes, by its type and the words that tell tables in one place apart.
bool is_of(const Json& schema, const toml::node& node) {
  if (schema.contains("items")) return node.is_array();
  if (!schema.contains("properties")) return node.is_value();
  const toml::table* table = node.as_table();
  if (table == nullptr) return false;
  for (const auto& [key, own] : schema["properties"].items())
    if (own.contains("const") && (*table)[key].value<std::string>() != own["const"].get<std::string>()) return false;
  const Json required = schema.value("required", Json::array());
  return std::ranges::all_of(required, [&](const Json& key) { return table->contains(key.get<std::string>()); });
}

/// What a schema says of the value that stands `parts` below a node. @param node  none: any of its kind
std::optional<std::string> meaning_in(const Json& schema, const toml::node* node, std::span<const std::string> parts,
                                      std::string meaning) {
  meaning = schema.value("description", meaning);
  if (schema.contains("anyOf")) {
    for (const Json& one : schema["anyOf"]) {
      if (node != nullptr && !is_of(one, *node)) continue;
      if (auto found = meaning_in(one, node, parts, meaning)) return found;
    }
    return {};
  }
  if (parts.empty()) return meaning;
  const bool is_array = schema.contains("items");
  if (!is_array && !(schema.contains("properties") && schema["properties"].contains(parts.front()))) return {};
  return meaning_in(is_array ? schema["items"] : schema["properties"][parts.front()], below(node, parts.front()),
                    parts.subspan(1), std::move(meaning));
}

}  // namespace

std::string unit_of_key(const Scene& scene, const std::string& path) {
  if (scene.units != "SI") return "1";
  const TomlDocument document = written_out(scene);
  const std::string meaning = meaning_in(schema_json(), &document.root(), parts_of(path), "").value_or("");
  return meaning.ends_with(']') ? meaning.substr(meaning.rfind('[') + 1, meaning.size() - meaning.rfind('[') - 2) : "1";
}

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

bool has_section(const Scene& scene, const std::string& name) { return scene.source.given.contains(name); }

}  // namespace slipmode::scene
