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

std::string initial_toml(const InitialSpec& initial) {
  const bool given = initial.at == InitialSpec::At::kGiven;
  return table_toml("initial", initial, given ? Without{"at"} : Without{"displacement", "velocity"});
}

std::string reduction_toml(const ReductionSpec& reduction, bool sensors) {
  std::string out = table_toml("reduction", reduction, {"fit", "functions"}) +
                    lines_toml(reduction.choice, {reduction.choice.modes > 0 ? "energy" : "modes"});
  if (!sensors) return out;
  return out + lines_toml(reduction, reduction.functions > 0 ? Without{"basis"} : Without{"basis", "functions"});
}

/// A scene as a file: all of it, or what its source and overrides give.
class SceneText {
 public:
  SceneText(const Scene& scene, bool all) : scene_(scene), all_(all) {}

  [[nodiscard]] std::string str() const {
    std::string out = fmt::format("title = {}\nunits = \"{}\"\n", quoted_text(scene_.title), scene_.units);
    out += structure_toml(scene_) + contacts_toml(scene_) + drive_toml(scene_);
    out += scene_.time.cycles ? given("time", *scene_.time.cycles) : given("time", scene_.time);
    out += said("initial", initial_toml(scene_.initial));
    out += said("ensemble", table_toml("ensemble", scene_.ensemble, values_of_other_drives(scene_)));
    if (scene_.sensors) out += table_toml("sensors", *scene_.sensors);
    out += said("reduction", reduction_toml(scene_.reduction, scene_.sensors.has_value()));
    out += scene_.drive.period() ? given("validation", scene_.driven, without_in_validation(scene_))
                                 : given("validation", scene_.validation);
    const std::string flow = table_toml("flow", scene_.flow);
    return out + (all_ || flow != table_toml("flow", Scene().flow) ? flow : "");
  }

 private:
  /// A table that has a say as a whole; a seed alone is one.
  [[nodiscard]] std::string said(const char* table, const std::string& text) const {
    const bool seeded = scene_.source.given.contains(fmt::format("{}.seed", table));
    return all_ || seeded || has_section(scene_, table) ? text : "";
  }
  /// A table without the keys that the scene leaves to its periods.
  template <class S>
  [[nodiscard]] std::string given(const char* name, const S& own, Without left_out = {}) const {
    if (all_) return table_toml(name, own, left_out);
    for_each_field<S>([&](const auto& field) {
      if (!scene_.source.given.contains(fmt::format("{}.{}", name, field.name))) left_out.push_back(field.name);
    });
    return said(name, table_toml(name, own, left_out));
  }

  const Scene& scene_;
  bool all_;
};

}  // namespace

std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string number_line(const char* key, double value) { return fmt::format("{} = {}\n", key, number_text(value)); }

std::string one_or_many_text(const std::vector<double>& values) {
  return values.size() == 1 ? number_text(values.front()) : value_toml(values);
}

std::string quoted_text(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string scene_to_toml(const Scene& scene) { return SceneText(scene, true).str(); }

std::string scene_file(const Scene& scene) { return SceneText(scene, false).str(); }

}  // namespace slipmode::scene
