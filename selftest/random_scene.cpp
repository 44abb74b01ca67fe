#include "selftest/random_scene.hpp"

#include "selftest/scene_draft.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace slipmode::selftest {
namespace {

void time(SceneDraft& d) {
  d.line("\n[time]");
  const double duration = d.uniform(8.0, 30.0) / d.rate;
  d.key("duration", duration);
  d.key("sample", duration / 200.0);
}

/// q and v of a swing of the whole: at random, but a beam's y = bend (x/L)² and its slope.
std::pair<std::vector<double>, std::vector<double>> swing(SceneDraft& d, bool with_counterpart) {
  const double size = d.size * d.uniform(0.0, 2.0);
  std::vector<double> q, v;
  if (!d.beam) {
    for (int i = 0; i < d.dofs; ++i) {
      q.push_back(d.uniform(-size, size));
      v.push_back(d.uniform(-size, size));
    }
    if (with_counterpart) v.assign(v.size(), d.counterpart);
    return {q, v};
  }
  const double bend = d.uniform(-size, size), random_rate = d.uniform(-size, size) * d.rate;
  const double rate = with_counterpart ? d.counterpart : random_rate, length = d.nodes.back();
  for (const double node : d.nodes) {
    const double x = node / length;
    for (const double share : {x * x, 2.0 * x / length}) {
      q.push_back(bend * share);
      v.push_back(rate * share);
    }
  }
  return {q, v};
}

/// What people write: from rest, or from the undeflected place, or with only some masses moved.
void make_zeros(SceneDraft& d, std::vector<double>& q, std::vector<double>& v) {
  const double kind = d.uniform(0.0, 1.0);
  if (kind < 0.08) q.assign(q.size(), 0.0);
  if (kind > 0.92) v.assign(v.size(), 0.0);
  if (kind < 0.35 || kind > 0.5) return;
  for (auto* values : {&q, &v})
    for (double& value : *values)
      if (d.chance(0.6)) value = 0.0;
}

void start(SceneDraft& d) {
  const double kind = d.uniform(0.0, 1.0);
  if (kind < 0.12 && !d.closed) return;  // at rest just on a stop rounding decides
  if (kind < 0.16 && d.belt && !d.clearances && !d.varying && !d.floats) return d.line("\n[initial]\nat = \"static\"");
  auto [q, v] = swing(d, kind > 0.85);
  make_zeros(d, q, v);
  if (d.chance(0.3)) {  // some contacts exactly on a guard: at a stop, at rest on the counterpart
    for (const auto& [mass, y] : d.stops)
      if (d.chance(0.7)) q[static_cast<std::size_t>(mass - 1)] = y;
    for (const int mass : d.places)
      if (!d.beam && d.chance(0.4)) v[static_cast<std::size_t>(mass - 1)] = d.counterpart;
  }
  d.line("\n[initial]\ndisplacement = {}\nvelocity = {}", SceneDraft::numbers(q), SceneDraft::numbers(v));
}

/// All masses at rest, or some that move by next to nothing.
void resting_start(SceneDraft& d, const std::vector<double>& places) {
  std::vector<double> v(places.size(), 0.0);
  if (d.chance(0.4))
    for (double& value : v)
      if (d.chance(0.3)) {
        value = d.uniform(-1.0, 1.0);
        value *= d.scatter(1e-16, 1e-9);
      }
  d.line("\n[initial]\ndisplacement = {}\nvelocity = {}", SceneDraft::numbers(places), SceneDraft::numbers(v));
}

}  // namespace

std::string random_scene_text(std::uint64_t seed, std::uint64_t index) {
  SceneDraft draft{.random = Random::stream(seed, index)};
  // Rare kinds, by a stream of their own: all other scenes stay as they were.
  Random own = Random::stream(~seed, index);
  const double rare = own.uniform();
  if (rare < 0.02) draft.pressed = std::pow(10.0, own.uniform(-6.0, 0.0));  // friction that is next to none
  draft.light = rare >= 0.02 && rare < 0.04;
  draft.line("title = \"Random scene {} of seed {}\"", index, seed);
  if (rare >= 0.04 && rare < 0.045) {
    const std::vector<double> places = write_resting_chain(draft);
    time(draft);
    resting_start(draft, places);
  } else {
    write_structure(draft);
    write_contacts(draft);
    write_drive(draft);
    time(draft);
    start(draft);
  }
  // The other flow that can do it.
  const bool both = draft.linear ? !draft.oscillates && draft.chance(0.15) : draft.coulomb_alone;
  if (both) draft.line("\n[flow]\nmethod = \"collocation\"");
  return draft.text;
}

}  // namespace slipmode::selftest
