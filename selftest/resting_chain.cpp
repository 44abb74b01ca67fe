#include "selftest/scene_draft.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace slipmode::selftest {
namespace {

/// Of a chain between walls, mass `held` of which is held off: springs in series on either side.
std::vector<double> resting_places(const std::vector<double>& springs, int held, double off) {
  const auto n = static_cast<int>(springs.size()) - 1;
  std::vector<double> places(static_cast<std::size_t>(n));
  const auto give = [&](int from, int to) {
    double sum = 0.0;
    for (int i = from; i < to; ++i) sum += 1.0 / springs[static_cast<std::size_t>(i)];
    return sum;
  };
  for (int i = 0; i < n; ++i)
    places[static_cast<std::size_t>(i)] =
        off * (i <= held ? give(0, i + 1) / give(0, held + 1) : give(i + 1, n + 1) / give(held + 1, n + 1));
  return places;
}

void stops_at(SceneDraft& d, int mass, double place) {
  d.line("\n[[contact]]\nat = {}\nlaw = \"clearance\"\nloss = \"{}\"", mass, d.chance(0.5) ? "gap" : "zero-force");
  const auto stop = [&](const char* side, double gap) {
    const double stiffness = d.contact_spring(100.0, 1e4), damping = d.chance(0.5) ? 0.0 : d.uniform(0.05, 1.0);
    d.stop(side, stiffness, damping, gap);
  };
  stop(place > 0.0 ? "right" : "left", std::abs(place));
  if (d.chance(0.3)) stop(place > 0.0 ? "left" : "right", d.uniform(0.0, 1.0));
}

/// A belt that begins to move, or a force that vibrates.
void sets_in_motion(SceneDraft& d, int masses) {
  if (d.chance(0.5)) {
    const double begin = d.chance(0.5) ? 0.0 : d.uniform(0.0, 1.0);
    d.line("\n[drive]\nkind = \"belt\"");
    return d.fill("speed = { from = 0.0, to = #, begin = #, end = # }",
                  {d.uniform(-1.0, 1.0), begin, begin + d.uniform(0.5, 10.0)});
  }
  d.line("\n[drive]\nkind = \"force\"\nat = {}", d.integer(1, masses));
  d.fill("omega = #\namplitude = #\nphase = #", {d.uniform(0.3, 2.5), d.scatter(0.01, 1.0), d.uniform(0.0, 6.0)});
}

}  // namespace

std::vector<double> write_resting_chain(SceneDraft& d) {
  const int masses = static_cast<int>(d.scatter(2.0, d.chance(0.05) ? 60.0 : 15.0));
  d.dofs = masses;
  d.linear = true;
  d.light = d.chance(0.5);
  std::vector<double> springs;
  const bool uniform = d.chance(0.3);
  for (int i = 0; i <= masses; ++i) springs.push_back(uniform ? 1.0 : d.uniform(0.3, 3.0));
  const int held = d.integer(0, masses - 1);
  const double off = d.uniform(-1.0, 1.0);
  std::vector<double> places = resting_places(springs, held, off);
  d.line("units = \"dimensionless\"\n\n[structure]\nkind = \"chain\"\nmasses = {}\nends = \"fixed-fixed\"", masses);
  d.line("mass = {}\nstiffness = {}", SceneDraft::numbers(d.masses_of(masses)), SceneDraft::numbers(springs));
  d.key("damping", d.chance(0.3) ? 0.0 : d.uniform(0.0, 0.05));
  // It takes no more than 6 to hold the mass, of springs of at most 3 on either side.
  d.line("\n[[contact]]\nat = {}\nlaw = \"coulomb\"", held + 1);
  const double mu_k = d.uniform(0.05, 0.5);
  d.fill("mu_s = #\nmu_k = #\nnormal_load = #", {0.6, mu_k, d.uniform(10.0, 30.0)});
  for (int count = std::min(masses - 1, d.integer(1, 3)), k = 0; k < count; ++k)
    if (const int mass = d.integer(1, masses);
        mass != held + 1 && std::ranges::find(d.places, mass) == d.places.end()) {
      d.places.push_back(mass);
      stops_at(d, mass, places[static_cast<std::size_t>(mass - 1)]);
    }
  sets_in_motion(d, masses);
  return places;
}

}  // namespace slipmode::selftest
