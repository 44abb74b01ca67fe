#include <slipmode/scene/new_scene.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/terminal.hpp>
#include "scene/internal/field_schema.hpp"

#include <toml++/toml.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace slipmode::scene {

namespace {

struct Sample {
  const char* kind;
  const char* what;
  const char* scene;
};

constexpr const char* kChainScene = R"(
title = "Chain on a belt"
units = "SI"

[structure]
kind = "chain"
masses = 5
mass = 0.1
stiffness = 1000.0
damping = 1.0e-3
ends = "fixed-free"

[[contact]]
at = 5
law = "stribeck"
mu_s = 0.4
mu_k = 0.2
alpha = 8.0
normal_load = 10.0

[drive]
kind = "belt"
speed = 0.2

[time]

[initial]
at = "static"

[ensemble]
members = 4
spread = 1.0e-3

[reduction]
energy = 0.99

[validation]
)";

constexpr const char* kBeamScene = R"(
title = "Beam on a shaker"
units = "SI"

[structure]
kind = "beam"
length = 0.3
width = 0.02
thickness = 0.002
youngs_modulus = 210.0e9
density = 7850.0
elements = 10

[structure.damping]
modal_ratio = 0.01

[[contact]]
at = "tip"
law = "compliant"
mu_s = 0.4
mu_k = 0.3
stiffness = 1.0e4
normal_load = 1.0

[drive]
kind = "shaker"
frequency = 15.0
amplitude = 3.0e-3

[time]
cycles = 300
transient_cycles = 200
samples_per_cycle = 64

[ensemble]
members = 2
spread = 1.0e-4

[reduction]
basis = "mass-pom"
energy = 0.99

[validation]
cycles = 300
modes = [1, 2, 3, 4, 6]
)";

constexpr const char* kMatricesScene = R"(
title = "A structure of its own"
units = "SI"

[structure]
kind = "matrices"
mass = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
damping = [[4.0, -2.0, 0.0], [-2.0, 4.0, -2.0], [0.0, -2.0, 2.0]]
stiffness = [[8e4, -4e4, 0.0], [-4e4, 8e4, -4e4], [0.0, -4e4, 4e4]]

[[contact]]
at = 1
law = "coulomb"
mu_s = 0.4
mu_k = 0.3
normal_load = 50.0

[[contact]]
at = 3
law = "coulomb"
mu_s = 0.4
mu_k = 0.3
normal_load = 50.0

[drive]
kind = "belt"
speed = 0.01

[time]

[ensemble]
members = 2
spread = 1.0e-3

[reduction]
energy = 0.99

[validation]
)";

constexpr const char* kClearanceScene = R"(
title = "Masses with a gap"
units = "SI"

[structure]
kind = "masses"
mass = [1.0, 0.5]

[[structure.link]]
at = 1
stiffness = 1000.0
damping = 2.0

[[structure.link]]
between = [1, 2]
stiffness = 500.0
damping = 1.0

[[contact]]
between = [1, 2]
law = "clearance"
loss = "zero-force"
stop = { stiffness = 2.0e4, damping = 5.0, gap = 1.0e-3 }

[drive]
kind = "force"
frequency = 4.0
amplitude = 2.0
at = 1

[time]
cycles = 300
transient_cycles = 200
samples_per_cycle = 64

[initial]
displacement = [0.0, 0.0]
)";

constexpr std::array<Sample, 4> kSamples = {
    {{"chain", "Five masses, the last one on a moving belt.", kChainScene},
     {"beam", "A steel cantilever rubbed at its tip by a shaken slider.", kBeamScene},
     {"matrices", "Three degrees of freedom by their matrices, on a belt.", kMatricesScene},
     {"clearance", "Two masses with a gap between them, under a force.", kClearanceScene}}};

constexpr std::size_t kColumns = 80, kComment = 28;

/// Of several that a table may be the one whose words and keys it has.
const Json& alternative_of(const Json& schema, const toml::table& given) {
  if (!schema.contains("anyOf")) return schema;
  const auto fits = [&given](const Json& one) {
    if (!one.contains("properties")) return false;
    const Json& properties = one.at("properties");
    return std::all_of(given.begin(), given.end(), [&properties](const auto& entry) {
      const auto property = properties.find(std::string(entry.first.str()));
      if (property == properties.end()) return false;
      const auto word = property->find("const");
      return word == property->end() || entry.second.template value<std::string>() == word->get<std::string>();
    });
  };
  return *std::ranges::find_if(schema.at("anyOf"), fits);
}

/// A table as it stands in a scene, and what it may be.
struct Place {
  const Json* schema;
  const toml::table* given;
  std::string meaning = {};
};

/// A table by its dotted path; of an array of tables the last one before line `line`.
Place place_of(const Json& root, const toml::table& scene, const std::string& path, std::size_t line) {
  Place at{.schema = &root, .given = &scene};
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    const Json& own = at.schema->at("properties").at(part);
    const toml::node* node = at.given->get(part);
    const Json* schema = &own;
    if (const toml::array* array = node->as_array()) {
      schema = &own.at("items");
      for (const toml::node& item : *array) {
        if (item.source().begin.line <= line) node = &item;
      }
    }
    at = {&alternative_of(*schema, *node->as_table()), node->as_table(), own.at("description").get<std::string>()};
  }
  return at;
}

/// What a key means, with the words it takes.
std::string meaning_of(const Json& key) {
  const auto text = key.at("description").get<std::string>();
  if (!key.contains("enum")) return text;
  return fmt::format("{}: {}", text, fmt::join(key.at("enum").get<std::vector<std::string>>(), ", "));
}

/// Lines of a comment.
std::string as_comment(const std::string& text) {
  std::istringstream lines(wrapped(text, kColumns - 2));
  std::string out;
  for (std::string line; std::getline(lines, line);) out += "# " + line + "\n";
  return out;
}

/// A line and what it means beside it, or above where both are too long.
std::string commented(const std::string& line, const std::string& meaning) {
  const std::string beside = fmt::format("{:<{}}# {}", line + " ", kComment, meaning);
  if (beside.size() <= kColumns) return beside + "\n";
  return as_comment(meaning) + line + "\n";
}

/// True where a key that excludes this one is there.
bool is_excluded(const Place& table, const std::string& name) {
  const auto& groups = table.schema->value("allOf", Json::array());
  return std::any_of(groups.begin(), groups.end(), [&](const Json& group) {
    bool has_it = false, has_other = false;
    for (const Json& one : group.at("oneOf")) {
      const auto own = one.at("required").front().get<std::string>();
      has_it = has_it || own == name;
      has_other = has_other || (own != name && table.given->contains(own));
    }
    return has_it && has_other;
  });
}

/// What else a table takes.
std::string others(const Place& table) {
  std::vector<std::string> names;
  for (const auto& [name, schema] : table.schema->at("properties").items()) {
    if (!table.given->contains(name) && !is_excluded(table, name)) names.push_back(name);
  }
  return names.empty() ? "" : as_comment(fmt::format("also: {}", fmt::join(names, ", ")));
}

}  // namespace

std::vector<std::string> new_scene_kinds() {
  std::vector<std::string> kinds;
  for (const Sample& sample : kSamples) kinds.emplace_back(sample.kind);
  return kinds;
}

std::string new_scene(const std::string& kind, const std::string& name) {
  const auto* const sample = std::ranges::find(kSamples, std::string_view(kind), &Sample::kind);
  if (sample == kSamples.end()) {
    throw InvalidInput(fmt::format("{}: no such kind of scene; valid: {}", kind, fmt::join(new_scene_kinds(), ", ")));
  }
  const std::string text = std::string(sample->scene).substr(1);
  const Json schema = schema_json();
  const toml::table scene = toml::parse(text);
  std::string out =
      fmt::format("# {}\n# Units in brackets are those of SI. To see what it does:\n#     slipmode run {} -o out\n",
                  sample->what, name);
  Place table{.schema = &schema, .given = &scene};
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty()) {
      out += (table.given == &scene ? "" : others(table)) + "\n";
    } else if (line.front() == '[') {
      const std::string path = line.substr(line.find_first_not_of('['), line.find(']') - line.find_first_not_of('['));
      table = place_of(schema, scene, path, number);
      out += commented(line, table.meaning);
    } else {
      out += commented(line, meaning_of(table.schema->at("properties").at(line.substr(0, line.find(' ')))));
    }
  }
  return out + others(table);
}

}  // namespace slipmode::scene
