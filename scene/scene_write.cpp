#include <slipmode/scene/scene_words.hpp>
#include "scene/internal/toml_text.hpp"

#include <toml++/toml.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

namespace slipmode::scene {

namespace {

std::string time_toml(const TimeSpec& time) {
  if (time.cycles) {
    return fmt::format("\n[time]\ncycles = {}\ntransient_cycles = {}\nsamples_per_cycle = {}\n",
                       number_text(time.cycles->cycles), number_text(time.cycles->transient_cycles),
                       time.cycles->samples);
  }
  return fmt::format("\n[time]\nduration = {}\ntransient = {}\nsample = {}\n", number_text(time.duration),
                     number_text(time.transient), number_text(time.sample));
}

std::string initial_toml(const InitialSpec& initial) {
  if (initial.at == InitialSpec::At::kGiven) {
    return fmt::format("\n[initial]\ndisplacement = {}\nvelocity = {}\n", numbers_text(initial.displacement),
                       numbers_text(initial.velocity));
  }
  return fmt::format("\n[initial]\nat = \"{}\"\n", std::ranges::find(kStarts, initial.at, &StartWord::at)->word);
}

std::string ensemble_toml(const EnsembleSpec& ensemble, const friction::Drive& drive) {
  std::string out = fmt::format("\n[ensemble]\nmembers = {}\nseed = {}\nspread = {}\n", ensemble.members, ensemble.seed,
                                number_text(ensemble.spread));
  if (drive.belt() != nullptr) out += fmt::format("speeds = {}\n", numbers_text(ensemble.speeds));
  if (drive.shaker() != nullptr) out += fmt::format("frequencies = {}\n", numbers_text(ensemble.frequencies));
  return out;
}

std::string sensors_toml(const SensorSpec& sensors) {
  return fmt::format("\n[sensors]\nkind = \"{}\"\nx = {}\nnoise = {}\nseed = {}\n",
                     std::ranges::find(kSensors, sensors.kind, &SensorWord::kind)->word, numbers_text(sensors.x),
                     number_text(sensors.noise), sensors.seed);
}

std::string reduction_toml(const ReductionSpec& reduction, bool sensors) {
  const std::string choice = reduction.choice.modes > 0
                                 ? fmt::format("modes = {}", reduction.choice.modes)
                                 : fmt::format("energy = {}", number_text(reduction.choice.energy));
  std::string out = fmt::format("\n[reduction]\nbasis = \"{}\"\n{}\n", to_string(reduction.basis), choice);
  if (!sensors) return out;
  out += fmt::format("fit = \"{}\"\n", std::ranges::find(kFits, reduction.fit, &FitWord::family)->word);
  if (reduction.functions > 0) out += fmt::format("functions = {}\n", reduction.functions);
  return out;
}

std::string range_text(const Range& range) {
  return fmt::format("{{ from = {}, to = {}, step = {} }}", number_text(range.from), number_text(range.to),
                     number_text(range.step));
}

std::string validation_toml(const ValidationSpec& spec) {
  std::string out = "\n[validation]\n";
  out += fmt::format("speeds = {}\nsegments = {}\n", range_text(spec.speeds), spec.segments);
  out += fmt::format("transient = {}\nblock = {}\nlimit = {}\nsweep_limit = {}\n", number_text(spec.transient),
                     number_text(spec.block), number_text(spec.limit), number_text(spec.sweep_limit));
  out += fmt::format("period_tolerance = {}\nmax_period = {}\n", number_text(spec.period_tolerance), spec.max_period);
  out += fmt::format("horizon = {}\nhorizon_starts = {}\n", number_text(spec.horizon), spec.horizon_starts);
  out +=
      fmt::format("orbits = {}\norbit_tolerance = {}\n", numbers_text(spec.orbits), number_text(spec.orbit_tolerance));
  out += fmt::format("modes = [{}]\nlyapunov_duration = {}\n", fmt::join(spec.modes, ", "),
                     number_text(spec.lyapunov_duration));
  return out +
         fmt::format("cost_duration = {}\ncost_repeats = {}\n", number_text(spec.cost_duration), spec.cost_repeats);
}

std::string shaken_toml(const ShakenValidationSpec& spec) {
  std::vector<std::string> bases;
  for (const BasisChoice basis : spec.bases) bases.push_back(fmt::format("\"{}\"", to_string(basis)));
  std::string out = "\n[validation]\n";
  if (spec.frequencies) out += fmt::format("frequencies = {}\n", range_text(*spec.frequencies));
  out += fmt::format("cycles = {}\nkept = {}\n", number_text(spec.cycles), number_text(spec.kept));
  if (spec.gauge) out += fmt::format("gauge = {}\n", number_text(*spec.gauge));
  out += fmt::format("modes = [{}]\nbases = [{}]\nfollow = \"{}\"\n", fmt::join(spec.modes, ", "),
                     fmt::join(bases, ", "), std::ranges::find(kFollows, spec.follow, &FollowWord::follow)->word);
  out += fmt::format("period_tolerance = {}\nmax_period = {}\n", number_text(spec.period_tolerance), spec.max_period);
  return out + fmt::format("cost_cycles = {}\ncost_repeats = {}\n", number_text(spec.cost_cycles), spec.cost_repeats);
}

std::string flow_toml(const dynamics::FlowOptions& flow) {
  return fmt::format("\n[flow]\nmethod = \"{}\"\ntolerance = {}\nmax_events_per_window = {}\nzeno_window = {}\n",
                     std::ranges::find(kMethods, flow.method, &MethodWord::method)->word, number_text(flow.tolerance),
                     flow.max_events_per_window, number_text(flow.zeno_window));
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
  std::string out = fmt::format("title = {}\nunits = \"{}\"\n", quoted_text(scene.title), scene.units);
  out += structure_toml(scene);
  for (const ContactSpec& contact : scene.contacts) out += contact_toml(contact, scene);
  out += drive_toml(scene) + time_toml(scene.time) + initial_toml(scene.initial);
  out += ensemble_toml(scene.ensemble, scene.drive);
  if (scene.sensors) out += sensors_toml(*scene.sensors);
  out += reduction_toml(scene.reduction, scene.sensors.has_value());
  if (scene.drive.belt() != nullptr) out += validation_toml(scene.validation);
  if (scene.drive.shaker() != nullptr) out += shaken_toml(scene.shaken);
  return out + flow_toml(scene.flow);
}

}  // namespace slipmode::scene
