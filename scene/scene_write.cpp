#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <toml++/toml.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

namespace slipmode::scene {

namespace {

template <class S>
std::string table_toml(const char* name, const S& own, const Without& without = {}) {
  return fmt::format("\n[{}]\n{}", name, lines_toml(own, without));
}

/// A table without the keys that the scene leaves to its periods; nothing where it has none of its own.
template <class S>
std::string given_toml(const Scene& scene, const char* name, const S& own) {
  Without left_out;
  for_each_field<S>([&](const auto& field) {
    if (!scene.source.given.contains(fmt::format("{}.{}", name, field.name))) left_out.push_back(field.name);
  });
  return has_section(scene, name) ? table_toml(name, own, left_out) : "";
}

std::string initial_toml(const InitialSpec& initial) {
  const bool given = initial.at == InitialSpec::At::kGiven;
  return table_toml("initial", initial, given ? Without{"at"} : Without{"displacement", "velocity"});
}

std::string reduction_toml(const ReductionSpec& reduction, bool sensors) {
  const std::string out = table_toml("reduction", reduction, {"fit", "functions"}) +
                          lines_toml(reduction.choice, {reduction.choice.modes > 0 ? "energy" : "modes"});
  if (!sensors) return out;
  return out + lines_toml(reduction, reduction.functions > 0 ? Without{"basis"} : Without{"basis", "functions"});
}

std::string model_toml(const Scene& scene) {
  return fmt::format("title = {}\nunits = \"{}\"\n", quoted_text(scene.title), scene.units) + structure_toml(scene) +
         contacts_toml(scene) + drive_toml(scene);
}

}  // namespace

std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string number_line(const char* key, double value) { return fmt::format("{} = {}\n", key, number_text(value)); }

std::string numbers_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string one_or_many_text(const std::vector<double>& values) {
  return values.size() == 1 ? number_text(values.front()) : numbers_text(values);
}

std::string quoted_text(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string scene_to_toml(const Scene& scene) {
  std::string out = model_toml(scene);
  out += scene.time.cycles ? table_toml("time", *scene.time.cycles) : table_toml("time", scene.time);
  out += initial_toml(scene.initial) + table_toml("ensemble", scene.ensemble, without_other_drives(scene.drive));
  if (scene.sensors) out += table_toml("sensors", *scene.sensors);
  out += reduction_toml(scene.reduction, scene.sensors.has_value());
  if (scene.drive.belt() != nullptr) out += table_toml("validation", scene.validation);
  if (scene.drive.shaker() != nullptr) out += table_toml("validation", scene.shaken);
  return out + table_toml("flow", scene.flow);
}

std::string scene_file(const Scene& scene) {
  const auto is_said = [&](const char* table, const std::string& text) {
    const bool seeded = scene.source.given.contains(fmt::format("{}.seed", table));
    return has_section(scene, table) || seeded ? text : "";
  };
  std::string out = model_toml(scene);
  out += scene.time.cycles ? given_toml(scene, "time", *scene.time.cycles) : given_toml(scene, "time", scene.time);
  out += is_said("initial", initial_toml(scene.initial));
  out += is_said("ensemble", table_toml("ensemble", scene.ensemble, without_other_drives(scene.drive)));
  if (scene.sensors) out += table_toml("sensors", *scene.sensors);
  out += is_said("reduction", reduction_toml(scene.reduction, scene.sensors.has_value()));
  if (scene.drive.belt() != nullptr) out += given_toml(scene, "validation", scene.validation);
  if (scene.drive.shaker() != nullptr) out += given_toml(scene, "validation", scene.shaken);
  const std::string flow = table_toml("flow", scene.flow);
  return out + (flow == table_toml("flow", Scene().flow) ? "" : flow);
}

}  // namespace slipmode::scene
