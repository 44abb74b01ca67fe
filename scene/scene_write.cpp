#include "core/errors.hpp"
#include "scene/scene.hpp"
#include "scene/scene_words.hpp"
#include "scene/toml_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

namespace slipmode::scene {

namespace {

/// Shortest text that reads back to the same double, always seen by TOML as a float.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string numbers(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string one_or_many(const std::vector<double>& values) {
  return values.size() == 1 ? number(values.front()) : numbers(values);
}

std::string quoted(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string structure_toml(const Scene& scene) {
  const fem::ChainOptions& chain = scene.structure;
  const auto ends = std::ranges::find_if(kEnds, [&](const Ends& entry) {
    return entry.left_fixed == chain.left_fixed && entry.right_fixed == chain.right_fixed;
  });
  std::string out =
      fmt::format("\n[structure]\nkind = \"chain\"\nmasses = {}\nends = \"{}\"\nmass = {}\nstiffness = {}\n",
                  chain.masses, ends->word, one_or_many(chain.mass), one_or_many(chain.stiffness));
  if (!chain.ground_stiffness.empty()) {
    out += fmt::format("ground_stiffness = {}\n", one_or_many(chain.ground_stiffness));
  }
  return out + fmt::format("damping = {}\nmass_damping = {}\n", number(chain.damping), number(chain.mass_damping));
}

std::string contact_toml(const ContactSpec& contact) {
  std::string out =
      fmt::format("\n[[contact]]\nname = {}\nat = {}\nlaw = \"{}\"\nnormal_load = {}\n", quoted(contact.name),
                  contact.at, kLaws[contact.law.index()].word, number(contact.normal_load));
  out += fmt::format("mu_s = {}\nmu_k = {}\n", number(friction::static_coefficient(contact.law)),
                     number(friction::limit_coefficient(contact.law)));
  if (const auto* law = std::get_if<friction::Stribeck>(&contact.law)) {
    out += fmt::format("alpha = {}\n", number(law->alpha));
  }
  if (const auto* law = std::get_if<friction::TanhRegularised>(&contact.law)) {
    out += fmt::format("alpha = {}\nepsilon = {}\n", number(law->alpha), number(law->epsilon));
  }
  return out;
}

std::string drive_toml(const friction::Drive& drive) {
  const friction::Belt& belt = *drive.belt();
  const bool ramp = belt.ramp_end > belt.ramp_begin;
  const std::string speed = ramp ? fmt::format("{{ from = {}, to = {}, begin = {}, end = {} }}", number(belt.speed),
                                               number(belt.end_speed), number(belt.ramp_begin), number(belt.ramp_end))
                                 : number(belt.speed);
  return fmt::format("\n[drive]\nkind = \"belt\"\nspeed = {}\n", speed);
}

std::string initial_toml(const InitialSpec& initial) {
  if (initial.at == InitialSpec::At::kGiven) {
    return fmt::format("\n[initial]\ndisplacement = {}\nvelocity = {}\n", numbers(initial.displacement),
                       numbers(initial.velocity));
  }
  return fmt::format("\n[initial]\nat = \"{}\"\n", std::ranges::find(kStarts, initial.at, &StartWord::at)->word);
}

std::string reduction_toml(const ReductionSpec& reduction) {
  const std::string choice = reduction.choice.modes > 0 ? fmt::format("modes = {}", reduction.choice.modes)
                                                        : fmt::format("energy = {}", number(reduction.choice.energy));
  return fmt::format("\n[reduction]\nbasis = \"{}\"\n{}\n",
                     std::ranges::find(kBases, reduction.basis, &BasisWord::kind)->word, choice);
}

std::string validation_toml(const ValidationSpec& spec) {
  std::string out = "\n[validation]\n";
  out += fmt::format("speeds = {{ from = {}, to = {}, step = {} }}\nsegments = {}\n", number(spec.speeds.from),
                     number(spec.speeds.to), number(spec.speeds.step), spec.segments);
  out += fmt::format("transient = {}\nblock = {}\nlimit = {}\nsweep_limit = {}\n", number(spec.transient),
                     number(spec.block), number(spec.limit), number(spec.sweep_limit));
  out += fmt::format("period_tolerance = {}\nmax_period = {}\n", number(spec.period_tolerance), spec.max_period);
  out += fmt::format("horizon = {}\nhorizon_starts = {}\n", number(spec.horizon), spec.horizon_starts);
  out += fmt::format("orbits = {}\norbit_tolerance = {}\n", numbers(spec.orbits), number(spec.orbit_tolerance));
  out += fmt::format("modes = [{}]\nlyapunov_duration = {}\n", fmt::join(spec.modes, ", "),
                     number(spec.lyapunov_duration));
  return out + fmt::format("cost_duration = {}\ncost_repeats = {}\n", number(spec.cost_duration), spec.cost_repeats);
}

std::string flow_toml(const dynamics::FlowOptions& flow) {
  return fmt::format("\n[flow]\nmethod = \"{}\"\ntolerance = {}\nmax_events_per_window = {}\nzeno_window = {}\n",
                     std::ranges::find(kMethods, flow.method, &MethodWord::method)->word, number(flow.tolerance),
                     flow.max_events_per_window, number(flow.zeno_window));
}

}  // namespace

std::string scene_to_toml(const Scene& scene) {
  std::string out = fmt::format("title = {}\nunits = \"{}\"\n", quoted(scene.title), scene.units);
  out += structure_toml(scene);
  for (const ContactSpec& contact : scene.contacts) out += contact_toml(contact);
  out += drive_toml(scene.drive);
  out += fmt::format("\n[time]\nduration = {}\ntransient = {}\nsample = {}\n", number(scene.time.duration),
                     number(scene.time.transient), number(scene.time.sample));
  out += initial_toml(scene.initial);
  out += fmt::format("\n[ensemble]\nmembers = {}\nseed = {}\nspread = {}\nspeeds = {}\n", scene.ensemble.members,
                     scene.ensemble.seed, number(scene.ensemble.spread), numbers(scene.ensemble.speeds));
  return out + reduction_toml(scene.reduction) + validation_toml(scene.validation) + flow_toml(scene.flow);
}

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
