#include "core/errors.hpp"
#include "scene/scene.hpp"
#include "scene/scene_words.hpp"
#include "scene/toml_reader.hpp"

#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <sstream>

namespace slipmode::scene {

namespace {

constexpr int kMostMasses = 10'000'000;
constexpr int kMostCount = std::numeric_limits<int>::max();

fem::ChainOptions read_structure(TomlReader in, const std::string& units) {
  fem::ChainOptions chain;
  chain.units = units;
  (void)in.choice("kind", {"chain"});
  chain.masses = static_cast<int>(in.integer("masses", 1, kMostMasses));
  const Ends& ends = kEnds[in.choice_or("ends", 0, words_of(kEnds))];
  chain.left_fixed = ends.left_fixed;
  chain.right_fixed = ends.right_fixed;
  const int springs = chain.masses - 1 + static_cast<int>(chain.left_fixed) + static_cast<int>(chain.right_fixed);
  chain.mass = in.per_item_or("mass", chain.mass, chain.masses, kPositive);
  chain.stiffness = in.per_item_or("stiffness", chain.stiffness, springs, kPositive);
  chain.ground_stiffness = in.per_item_or("ground_stiffness", {}, chain.masses, kNonNegative);
  chain.damping = in.number_or("damping", chain.damping, kNonNegative);
  chain.mass_damping = in.number_or("mass_damping", chain.mass_damping, kNonNegative);
  in.finish();
  return chain;
}

friction::Law read_law(TomlReader& in) {
  const std::size_t law = in.choice("law", words_of(kLaws));
  const double mu_k = in.number("mu_k", kNonNegative);
  const double mu_s = in.number("mu_s", kNonNegative);
  if (mu_s < mu_k) in.fail("mu_s", fmt::format("less than mu_k = {}", mu_k), fmt::format("mu_s >= {}", mu_k));
  switch (kLaws[law].law) {
    case LawWord::kCoulomb:
      if (in.has("alpha")) in.fail("alpha", "law \"coulomb\" does not depend on the sliding speed", "no alpha");
      return friction::Coulomb{mu_s, mu_k};
    case LawWord::kStribeck:
      return friction::Stribeck{mu_s, mu_k, in.number("alpha", kNonNegative)};
    case LawWord::kTanh:
      break;
  }
  friction::TanhRegularised tanh{mu_s, mu_k};
  tanh.alpha = in.number_or("alpha", tanh.alpha, kNonNegative);
  tanh.epsilon = in.number_or("epsilon", tanh.epsilon, kPositive);
  return tanh;
}

std::vector<ContactSpec> read_contacts(TomlReader& scene, int masses) {
  std::vector<ContactSpec> contacts;
  for (TomlReader& in : scene.tables("contact")) {
    ContactSpec contact;
    contact.at = static_cast<int>(in.integer("at", 1, masses));
    for (std::size_t other = 0; other < contacts.size(); ++other) {
      if (contacts[other].at == contact.at) {
        in.fail("at", fmt::format("contact.{} is on this mass already", other), "one contact per mass");
      }
    }
    contact.normal_load = in.number("normal_load", kPositive);
    contact.name = in.text_or("name", fmt::format("contact {}", contacts.size() + 1));
    contact.law = read_law(in);
    in.finish();
    contacts.push_back(std::move(contact));
  }
  return contacts;
}

friction::Drive read_drive(TomlReader in) {
  (void)in.choice("kind", {"belt"});
  friction::Belt belt;
  if (in.is_table("speed")) {
    TomlReader ramp = in.table("speed");
    belt = friction::Belt::ramp(ramp.number("from", kFinite), ramp.number("to", kFinite),
                                ramp.number("begin", kNonNegative), ramp.number("end", kNonNegative));
    if (belt.ramp_end <= belt.ramp_begin) ramp.fail("end", "not after begin", fmt::format("> {}", belt.ramp_begin));
    ramp.finish();
  } else {
    belt = friction::Belt::constant(in.number("speed", kFinite));
  }
  in.finish();
  return belt;
}

TimeSpec read_time(TomlReader in) {
  TimeSpec time;
  time.duration = in.number("duration", kPositive);
  time.transient = in.number_or("transient", time.transient, kNonNegative);
  time.sample = in.number_or("sample", time.sample, kPositive);
  if (time.transient >= time.duration) {
    in.fail("transient", "nothing is left to keep", fmt::format("less than duration = {}", time.duration));
  }
  if (time.sample > time.duration - time.transient) {
    in.fail("sample", "no sample fits",
            fmt::format("at most duration - transient = {}", time.duration - time.transient));
  }
  in.finish();
  return time;
}

InitialSpec read_initial(TomlReader in, int masses) {
  InitialSpec initial;
  const bool given = in.has("displacement") || in.has("velocity");
  if (given && in.has("at")) in.fail("at", "displacement or velocity is given too", "either at, or arrays");
  initial.at = kStarts[in.choice_or("at", 0, words_of(kStarts))].at;
  if (given) {
    const std::vector<double> zero(static_cast<std::size_t>(masses), 0.0);
    initial.at = InitialSpec::At::kGiven;
    initial.displacement = in.numbers_or("displacement", zero, kFinite, masses);
    initial.velocity = in.numbers_or("velocity", zero, kFinite, masses);
  }
  in.finish();
  return initial;
}

EnsembleSpec read_ensemble(TomlReader in) {
  EnsembleSpec ensemble;
  ensemble.members = static_cast<int>(in.integer_or("members", ensemble.members, 1, kMostCount));
  ensemble.seed = static_cast<std::uint64_t>(in.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  ensemble.spread = in.number_or("spread", ensemble.spread, kNonNegative);
  ensemble.speeds = in.numbers_or("speeds", {}, kFinite);
  in.finish();
  return ensemble;
}

ReductionSpec read_reduction(TomlReader in, int masses) {
  ReductionSpec reduction;
  reduction.basis = kBases[in.choice_or("basis", 0, words_of(kBases))].kind;
  if (in.has("modes") && in.has("energy")) in.fail("modes", "energy is given too", "either modes or energy");
  reduction.choice.modes = in.integer_or("modes", 0, 1, masses);
  reduction.choice.energy = in.number_or("energy", reduction.choice.energy,
                                         {.low = 0.0, .high = 1.0, .above = true, .text = "a share > 0 and <= 1"});
  in.finish();
  return reduction;
}

Range read_range(TomlReader in) {
  const Range range{in.number("from", kFinite), in.number("to", kFinite), in.number("step", kPositive)};
  in.finish();
  return range;
}

ValidationSpec read_validation(TomlReader in, int masses) {
  ValidationSpec spec;
  if (in.has("speeds")) spec.speeds = read_range(in.table("speeds"));
  spec.segments = static_cast<int>(in.integer_or("segments", spec.segments, 1, kMostCount));
  spec.transient = in.number_or("transient", spec.transient, kNonNegative);
  spec.block = in.number_or("block", spec.block, kPositive);
  spec.limit = in.number_or("limit", std::max(spec.limit, spec.block), kPositive);
  if (spec.limit < spec.block) in.fail("limit", "shorter than one block", fmt::format(">= block = {}", spec.block));
  spec.sweep_limit = in.number_or("sweep_limit", spec.sweep_limit, kPositive);
  spec.period_tolerance = in.number_or("period_tolerance", spec.period_tolerance, kPositive);
  spec.max_period = static_cast<int>(in.integer_or("max_period", spec.max_period, 1, kMostCount));
  spec.horizon = in.number_or("horizon", spec.horizon, kPositive);
  spec.horizon_starts = static_cast<int>(in.integer_or("horizon_starts", spec.horizon_starts, 1, kMostCount));
  spec.orbits = in.numbers_or("orbits", {}, kFinite);
  spec.orbit_tolerance = in.number_or("orbit_tolerance", spec.orbit_tolerance, kPositive);
  spec.modes = in.integers_or("modes", {}, 1, masses);
  spec.lyapunov_duration = in.number_or("lyapunov_duration", spec.lyapunov_duration, kPositive);
  spec.cost_duration = in.number_or("cost_duration", spec.cost_duration, kNonNegative);
  spec.cost_repeats = static_cast<int>(in.integer_or("cost_repeats", spec.cost_repeats, 1, kMostCount));
  in.finish();
  return spec;
}

dynamics::FlowOptions read_flow(TomlReader in) {
  dynamics::FlowOptions flow;
  flow.method = kMethods[in.choice_or("method", 0, words_of(kMethods))].method;
  flow.tolerance = in.number_or("tolerance", flow.tolerance,
                                {.low = 0.0, .high = 1.0, .above = true, .text = "a number > 0 and <= 1"});
  flow.max_events_per_window =
      static_cast<int>(in.integer_or("max_events_per_window", flow.max_events_per_window, 1, kMostCount));
  flow.zeno_window = in.number_or("zeno_window", flow.zeno_window, kNonNegative);
  in.finish();
  return flow;
}

std::string read_file(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw InvalidInput(fmt::format("{}: no such scene file; check the path", path.string()));
  }
  if (std::filesystem::is_directory(path)) {
    throw InvalidInput(
        fmt::format("{}: is a folder; expected a scene file such as {}/scene.toml", path.string(), path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw InvalidInput(fmt::format("{}: cannot be read; check its permissions", path.string()));
  return text.str();
}

}  // namespace

Scene parse_scene(const std::string& text, const std::vector<std::string>& overrides, const std::string& path) {
  const TomlDocument document(text, path, overrides);
  TomlReader in(document);
  Scene scene;
  scene.source = {path, text, overrides};
  scene.title = in.text_or("title", "");
  scene.units = kUnits[in.choice("units", kUnits)];
  scene.structure = read_structure(in.table("structure"), scene.units);
  const int masses = scene.structure.masses;
  scene.contacts = read_contacts(in, masses);
  scene.drive = read_drive(in.table("drive"));
  scene.time = read_time(in.table("time"));
  scene.initial = read_initial(in.table_or_empty("initial"), masses);
  scene.ensemble = read_ensemble(in.table_or_empty("ensemble"));
  scene.reduction = read_reduction(in.table_or_empty("reduction"), masses);
  scene.validation = read_validation(in.table_or_empty("validation"), masses);
  scene.flow = read_flow(in.table_or_empty("flow"));
  in.finish();
  return scene;
}

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return parse_scene(read_file(path), overrides, path.string());
}

}  // namespace slipmode::scene
