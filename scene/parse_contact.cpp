#include <slipmode/core/errors.hpp>
#include <slipmode/core/overloaded.hpp>
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::scene {

namespace {

friction::NormalLoad read_load(TomlReader& contact) {
  const char* key = "normal_load";
  if (!contact.is_table(key)) return {contact.number(key, kPositive)};
  TomlReader in = contact.table(key);
  const bool oscillates = in.has("oscillator");
  if (oscillates) in.refuse("slope", "an oscillator is given too", "oscillator.slope, or a slope and no oscillator");
  friction::NormalLoad load;
  read_fields(in, load, {.without = {oscillates ? "slope" : "oscillator"}});
  if (!oscillates) in.require("slope");
  in.finish();
  return load;
}

double read_tilt(TomlReader& in) {
  constexpr double kRight = 90.0;
  const double tilt = in.number_or("tilt_deg", 0.0, kFinite);
  if (std::abs(tilt) >= kRight) in.fail("tilt_deg", "impossible value", "an angle between -90 and 90 degrees");
  return tilt;
}

/// The contacts of one [[contact]] whose place and name are read.
std::vector<ContactSpec> elements_of(const friction::Iwan& joint, const ContactSpec& whole) {
  std::vector<ContactSpec> contacts;
  for (const friction::JenkinsElement& own : friction::elements_of(joint)) {
    ContactSpec& contact = contacts.emplace_back(whole);
    contact.law = friction::CompliantCoulomb{.mu_s = 1.0, .mu_k = 1.0, .stiffness = own.stiffness};
    contact.normal_load = {own.slip_force};
    contact.name = fmt::format("{}, element {}", whole.name, contacts.size());
    contact.joint = JointShare{.law = joint, .name = whole.name, .element = contacts.size() - 1};
  }
  return contacts;
}

/// What a law does not go with: a tilt, a varying load.
void check_combination(TomlReader& in, const ContactSpec& spec) {
  if (!friction::is_piecewise_linear(spec.law)) {
    constexpr const char* kValid = "law = \"coulomb\" or \"compliant\"";
    const std::string what = fmt::format("does not go with law \"{}\"", friction::law_word(spec.law));
    if (spec.tilt_deg != 0.0) in.fail("tilt_deg", what, fmt::format("0, or {}", kValid));
    if (!spec.normal_load.is_constant()) in.fail("normal_load", what, fmt::format("a number, or {}", kValid));
    return;
  }
  friction::Contact contact{.direction = Eigen::VectorXd::Ones(1), .law = spec.law};
  contact.tilt = spec.tilt_deg * std::numbers::pi / 180.0;
  contact.name = spec.name;
  try {
    friction::validate(contact);
  } catch (const InvalidInput& error) {
    in.fail("tilt_deg", error.what(), "mu tan|tilt| < 1 and tan|tilt| <= mu, for mu_s and mu_k");
  }
}

/// The contact of one [[contact]] whose place and name are read.
ContactSpec with_law(TomlReader& in, ContactSpec contact, const friction::Law& law) {
  contact.law = law;
  if (friction::clearance(law) != nullptr) return contact;
  contact.normal_load = read_load(in);
  contact.tilt_deg = read_tilt(in);
  check_combination(in, contact);
  return contact;
}

/// Whether two contacts have the same displacement but for its sign.
bool same_place(const ContactPlace& a, const ContactPlace& b, const Scene& scene) {
  constexpr double kClosest = 1e-9;  // of the position
  if (scene.beam() == nullptr) {
    const auto* pair = std::get_if<Between>(&a);
    const auto* other = std::get_if<Between>(&b);
    if (pair == nullptr || other == nullptr) return a.index() == b.index() && std::get<int>(a) == std::get<int>(b);
    return std::minmax(pair->first, pair->second) == std::minmax(other->first, other->second);
  }
  const auto position = [&scene](const ContactPlace& place) {
    const double* x = std::get_if<double>(&place);
    return x != nullptr ? *x : beam_reach(*scene.beam());
  };
  return std::abs(position(a) - position(b)) <= kClosest * position(b);
}

void check_alone(TomlReader& in, const ContactSpec& own, const std::vector<ContactSpec>& others, const Scene& scene) {
  for (std::size_t other = 0; other < others.size(); ++other) {
    if (!same_place(others[other].at, own.at, scene) ||
        friction::can_share_place(friction::kind(own.law), friction::kind(others[other].law)))
      continue;
    const bool pair = std::holds_alternative<Between>(own.at);
    const char* where = pair ? "pair of masses" : scene.beam() == nullptr ? "mass" : "place";
    in.fail(
        pair ? "between" : "at", fmt::format("contact.{} is on this {} already", other, where),
        fmt::format("one per {} of those that stick rigidly (\"coulomb\", \"stribeck\", \"table\"); beside one only "
                    "\"clearance\" and \"tanh\"",
                    where));
  }
}

Between read_between(TomlReader& in, int masses) {
  const std::string valid = fmt::format("[mass, mass], two different masses from 1 to {}", masses);
  in.refuse("at", "between is given too", "either at or between");
  const std::vector<int> pair = in.integers("between", {.low = 1.0, .high = static_cast<double>(masses)});
  if (pair.size() != 2 || pair[0] == pair[1]) in.fail("between", "not two different masses", valid);
  return {pair[0], pair[1]};
}

}  // namespace

ContactPlace read_place(TomlReader& in, const Scene& scene) {
  if (scene.beam() == nullptr) {
    const int masses = static_cast<int>(scene.size());
    if (in.has("between")) return read_between(in, masses);
    return in.integer<int>("at", {.low = 1.0, .high = static_cast<double>(masses)});
  }
  if (in.is_text("at")) {
    (void)in.choice("at", {"tip"});
    return AtTip{};
  }
  const double reach = beam_reach(*scene.beam());
  const std::string valid = fmt::format("\"tip\", or x > 0 and <= {} (the end of the extension)", reach);
  return in.number("at", {.low = 0.0, .high = reach * (1.0 + kEndSlack), .above = true, .text = valid.c_str()});
}

std::vector<ContactSpec> read_contacts(TomlReader& in, const Scene& scene) {
  std::vector<ContactSpec> contacts, firsts;  // firsts: of each table
  for (TomlReader& table : in.tables("contact")) {
    ContactSpec whole;
    whole.at = read_place(table, scene);
    whole.name = table.text_or("name", fmt::format("contact {}", firsts.size() + 1));
    const std::vector<ContactSpec> own =
        std::visit(Overloaded{[&](const friction::Iwan& joint) { return elements_of(joint, whole); },
                              [&](const friction::Law& law) { return std::vector{with_law(table, whole, law)}; }},
                   read_law(table));
    check_alone(table, own.front(), firsts, scene);
    table.finish();
    firsts.push_back(own.front());
    contacts.insert(contacts.end(), own.begin(), own.end());
  }
  return contacts;
}

}  // namespace slipmode::scene
