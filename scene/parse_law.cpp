#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>
#include <array>
#include <utility>

namespace slipmode::scene {

namespace {

constexpr const char* kNoFriction = "a clearance has no friction";
constexpr const char* kJoint = "a joint says at which force it slides";
constexpr const char* kSlipForce = "slip_force";
constexpr const char* kStops = "stop, or left and right, each { stiffness, damping, gap }";

/// Keys of other laws that somebody may expect here too.
struct Stranger {
  std::string_view law;
  const char* key;
  const char* why;
  const char* valid;
};
constexpr std::array<Stranger, 14> kStrangers = {
    {{"coulomb", "alpha", "law \"coulomb\" does not depend on the sliding speed", "no alpha"},
     {"table", "mu_k", "law \"table\" slides by its points", "coefficients"},
     {"coulomb", "stiffness", "law \"coulomb\" is rigid", "no stiffness, or law = \"compliant\""},
     {"dahl", "mu_s", "law \"dahl\" does not tell static from sliding friction", "mu"},
     {"dahl", "mu_k", "law \"dahl\" does not tell static from sliding friction", "mu"},
     {"clearance", "normal_load", kNoFriction, kStops},
     {"clearance", "mu_s", kNoFriction, kStops},
     {"clearance", "mu_k", kNoFriction, kStops},
     {"clearance", "mu", kNoFriction, kStops},
     {"clearance", "alpha", kNoFriction, kStops},
     {"clearance", "tilt_deg", kNoFriction, kStops},
     {"iwan", "normal_load", kJoint, kSlipForce},
     {"iwan", "mu_s", kJoint, kSlipForce},
     {"iwan", "mu_k", kJoint, kSlipForce}}};

void check_coefficients(TomlReader& in, const auto& law) {
  if constexpr (requires { law.mu_s < law.mu_k; }) {
    if (law.mu_s < law.mu_k)
      in.fail("mu_s", fmt::format("less than mu_k = {}", law.mu_k), fmt::format("mu_s >= {}", law.mu_k));
  }
}

void read(TomlReader& in, auto& law) {
  read_fields(in, law);
  check_coefficients(in, law);
}

void read(TomlReader& in, friction::LuGre& law) {
  if (in.has("mu_k") && in.number("mu_k", kNonNegative) == 0.0) {
    in.fail("mu_k", "impossible value with law \"lugre\"", kPositive.text);
  }
  read_fields(in, law);
  check_coefficients(in, law);
}

void read(TomlReader& in, friction::Measured& law) {
  read_fields(in, law);
  if (const auto fault = friction::fault_of(law)) in.fail(fault->field, fault->found, fault->expected);
}

/// A side takes what it does not say from `stop`, when there is one.
friction::Stop read_side(TomlReader in, const std::optional<friction::Stop>& stop) {
  return read_table(std::move(in), stop.value_or(friction::Stop{}), {.all_optional = stop.has_value()});
}

void read(TomlReader& in, friction::Clearance& law) {
  if (!in.has("left") && !in.has("right")) (void)in.table("stop");  // missing unless there
  if (in.has("stop")) law.left = law.right = read_table<friction::Stop>(in.table("stop"));
  if (in.has("left")) law.left = read_side(in.table("left"), law.left);
  if (in.has("right")) law.right = read_side(in.table("right"), law.right);
  read_fields(in, law, {.without = {"left", "right"}});
  if (law.left && law.right && law.left->gap + law.right->gap < 0.0) {
    in.fail("law", fmt::format("the stops overlap: gaps {} and {}", law.left->gap, law.right->gap),
            "gaps whose sum is >= 0");
  }
}

}  // namespace

std::vector<std::string> law_spec_words() {
  std::vector<std::string> words = friction::law_words();
  words.emplace_back(friction::Iwan::word);
  return words;
}

LawSpec read_law(TomlReader& in) {
  const std::vector<std::string> words = law_spec_words();
  const std::size_t index = in.choice("law", words);
  for (const Stranger& own : kStrangers) {
    if (own.law == words[index]) in.refuse(own.key, own.why, own.valid);
  }
  if (words[index] == friction::Iwan::word) {
    friction::Iwan joint;
    read(in, joint);
    return joint;
  }
  auto law = alternative<friction::Law>(index);
  std::visit([&in](auto& own) { read(in, own); }, law);
  return law;
}

}  // namespace slipmode::scene
