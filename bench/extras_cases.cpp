#include "bench/extras_cases.hpp"

#include <slipmode/scene/scene.hpp>
#include "bench/chain_system.hpp"
#include "bench/clock.hpp"

#include <fmt/format.h>

namespace slipmode::bench {
namespace {

constexpr const char* kPlainScene = R"(
units = "dimensionless"
[structure]
kind = "chain"
masses = 10
damping = 0.006
[[contact]]
at = 10
law = "coulomb"
mu_s = 0.4
mu_k = 0.2
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.2
[time]
duration = 1.0
)";

/// A scene with one thing more, timed.
struct Extra {
  std::string name;
  dynamics::HybridSystem system;
  std::vector<double> seconds = {};
  dynamics::FlowStatistics statistics = {};

  [[nodiscard]] double per_event() const { return median(seconds) / static_cast<double>(statistics.events); }
};

Extra from_scene(const std::string& name, const std::vector<std::string>& overrides) {
  return {.name = name, .system = scene::build_system(scene::parse_scene(kPlainScene, overrides))};
}

}  // namespace

Row measure_extras(bool quick) {
  ChainProblem problem;
  problem.coulomb = true;
  std::vector<Extra> all;
  all.push_back({.name = "by hand", .system = system_of(problem)});
  all.push_back(from_scene("scene without extras", {}));
  all.push_back(from_scene("contact spring", {"contact.0.law=compliant", "contact.0.stiffness=1e3"}));
  all.push_back(from_scene("load that varies", {"contact.0.normal_load={ constant = 3.0, slope = -0.01 }"}));
  all.push_back(from_scene("tilt", {"contact.0.tilt_deg=0.3"}));
  all.push_back(
      from_scene("normal vibration",
                 {"contact.0.normal_load={ constant = 3.0, oscillator = { mass = 0.1, support_stiffness = 10.0, "
                  "support_damping = 0.1, spring_stiffness = 1.0, spring_damping = 0.01, slope = 0.01 } }"}));
  const dynamics::SimulateOptions options{
      .duration = quick ? 2e4 : 1e5, .keep_events = false, .output = dynamics::SimulateOptions::Output::kContacts};
  const int repeats = quick ? 3 : 5;
  for (int k = -1; k < repeats; ++k) {  // the first round sets up
    for (Extra& extra : all) {
      const double seconds = thread_seconds_of(
          [&] { extra.statistics = dynamics::simulate(extra.system, extra.system.rest(), options).statistics; });
      if (k >= 0) extra.seconds.push_back(seconds);
    }
  }
  Row row;
  const double plain = all.front().per_event();
  for (const Extra& extra : all) {
    row.lines.push_back(fmt::format("extras: {:22} {:7.3f} us per event, {:.2f} of by hand, {} events, {} regimes",
                                    extra.name, 1e6 * extra.per_event(), extra.per_event() / plain,
                                    extra.statistics.events, extra.statistics.regimes_built));
    row.figures.emplace_back(extra.name + ", us per event", 1e6 * extra.per_event());
    row.timed.push_back({.name = "extras: " + extra.name + " 1e4 events", .ms = 1e7 * extra.per_event()});
  }
  return row;
}

}  // namespace slipmode::bench
