#include "selftest/scene_draft.hpp"

#include <algorithm>
#include <numbers>

namespace slipmode::selftest {
namespace {

/// A degree of freedom of its own for every contact, so that none depends on the others.
void choose_places(SceneDraft& d, int count) {
  while (static_cast<int>(d.places.size()) < count) {
    const int place = d.integer(1, d.masses());
    if (std::ranges::find(d.places, place) == d.places.end()) d.places.push_back(place);
  }
}

/// @return whether the contact's displacement is that of its mass
bool place(SceneDraft& d, int own) {
  if (d.beam) {
    if (own == d.masses())
      d.line("at = \"tip\"");
    else
      d.key("at", d.nodes[static_cast<std::size_t>(own - 1)]);
    return false;
  }
  const int other = d.integer(1, d.masses());
  if (d.chance(0.2) && std::ranges::find(d.places, other) == d.places.end()) {
    d.line("between = [{}, {}]", other, own);
    return false;
  }
  d.line("at = {}", own);
  return true;
}

/// @param varying  it may; with an oscillator of its own beside piecewise-linear laws only
void load(SceneDraft& d, bool varying) {
  const double constant = d.stiffness * d.size * d.uniform(0.2, 3.0);
  const double kind = varying ? d.uniform(0.0, d.linear ? 1.0 : 0.85) : 0.0;
  if (kind < 0.6) return d.key("normal_load", constant);
  d.varying = true;
  if (kind < 0.85)
    return d.fill("normal_load = { constant = #, slope = # }", {constant, d.stiffness * d.uniform(-1.5, 1.5)});
  d.oscillates = true;
  d.fill(
      "normal_load = { constant = #, oscillator = { mass = #, support_stiffness = #, support_damping = #, "
      "spring_stiffness = #, spring_damping = #, slope = # } }",
      {constant, d.stiffness / (d.rate * d.rate) * d.uniform(0.2, 2.0), d.stiffness * d.uniform(0.0, 3.0),
       d.stiffness / d.rate * d.uniform(0.0, 0.2), d.stiffness * d.uniform(0.5, 3.0),
       d.chance(0.5) ? 0.0 : d.stiffness / d.rate * d.uniform(0.0, 0.2), d.uniform(-0.5, 0.5)});
}

void clearance(SceneDraft& d, int own, bool of_mass) {
  d.clearances = true;
  const double damping = d.chance(0.3) ? 0.0 : d.uniform(0.05, 1.0) * d.stiffness / d.rate;
  d.line("law = \"clearance\"\nloss = \"{}\"", d.chance(0.5) ? "gap" : "zero-force");
  const auto stop = [&](const char* name) {
    const bool closed = d.chance(0.1);
    d.closed = d.closed || closed;
    const double stiffness = d.contact_spring(100.0, 1e6), gap = closed ? 0.0 : d.size * d.uniform(0.05, 0.8);
    d.line("{} = {{ stiffness = {}, damping = {}, gap = {} }}", name, SceneDraft::number(stiffness),
           SceneDraft::number(damping), SceneDraft::number(gap));
    return gap;
  };
  const auto meets = [&](double y) {
    if (of_mass) d.stops.emplace_back(own, y);
  };
  const int sides = d.integer(0, 4);
  if (sides == 4) {
    const double gap = stop("stop");
    meets(gap);
    return meets(-gap);
  }
  if (sides != 1) meets(-stop("left"));
  if (sides != 2) meets(stop("right"));
}

void contact(SceneDraft& d, int own) {
  d.line("\n[[contact]]");
  const bool of_mass = place(d, own);
  if (d.chance(0.1)) d.line("name = \"contact at {}\"", own);
  // Of a piecewise-linear scene all are, of another one some.
  const bool linear = d.linear || (!d.coulomb_alone && d.chance(0.3));
  if (linear && d.chance(0.35)) return clearance(d, own, of_mass);
  const double mu_k = d.chance(0.08) ? 0.0 : d.uniform(0.05, 0.5);
  const double mu_s = d.chance(0.2) ? mu_k : mu_k + (d.chance(0.1) ? d.uniform(1.0, 5.0) : d.uniform(0.0, 0.5));
  const int kind = linear ? d.integer(0, 1) : d.coulomb_alone ? 0 : d.integer(0, 4);
  if (kind == 0 || (linear && kind == 1)) {
    if (kind == 1)
      d.line("law = \"compliant\"\nstiffness = {}", SceneDraft::number(d.contact_spring(200.0, 1e6)));
    else
      d.line("law = \"coulomb\"");
    d.key("mu_s", mu_s);
    d.key("mu_k", mu_k);
    if (linear && mu_k > 0.1 && d.chance(0.2)) d.key("tilt_deg", d.uniform(-5.0, 5.0));
    return load(d, linear);
  }
  if (kind == 1) {
    d.line("law = \"stribeck\"\nalpha = {}", SceneDraft::number(d.uniform(0.2, 15.0) / d.speed()));
  } else if (kind == 2) {
    d.fill("law = \"tanh\"\nalpha = #\nepsilon = #",
           {d.uniform(0.2, 15.0) / d.speed(), d.uniform(0.02, 0.2) * d.speed()});
  } else if (kind == 3) {
    d.fill("law = \"dahl\"\nmu = #\nstiffness = #", {d.uniform(0.1, 0.6), d.contact_spring(200.0, 1e4)});
    return load(d, false);
  } else {
    const double bristle = d.contact_spring(200.0, 1e4);
    d.fill("law = \"lugre\"\nstribeck_speed = #\nstiffness = #", {d.uniform(0.02, 0.5) * d.speed(), bristle});
    d.key("damping", d.chance(0.3) ? 0.0 : d.uniform(0.0, 0.5) * std::sqrt(bristle * d.stiffness) / d.rate);
    d.key("viscous", d.chance(0.5) ? 0.0 : d.uniform(0.0, 0.3) * d.stiffness / d.rate);
    d.key("mu_s", std::max(mu_s, 0.1));
    d.key("mu_k", std::clamp(mu_k, 0.1, std::max(mu_s, 0.1)));
    return load(d, false);
  }
  d.key("mu_s", mu_s);
  d.key("mu_k", mu_k);
  load(d, false);
}

void shaker(SceneDraft& d) {
  const double omega = d.rate * d.uniform(0.3, 2.5), amplitude = d.size * d.uniform(0.2, 3.0),
               phase = d.uniform(0.0, 6.0);
  const double f = omega / (2.0 * std::numbers::pi);
  d.counterpart = amplitude * omega * std::cos(phase);
  d.line("kind = \"shaker\"");
  d.key("frequency", f);
  const int curve = d.integer(0, 11);  // each with this amplitude at f, to rounding
  if (curve == 0)
    d.fill("amplitude = { polynomial = [#, #] }", {amplitude / 2.0, amplitude / 2.0 / f});
  else if (curve == 1)
    d.fill("amplitude = { table = [[#, #], [#, #]] }", {0.5 * f, 0.5 * amplitude, 1.5 * f, 1.5 * amplitude});
  else if (curve == 2)
    d.fill("amplitude = { exponential = { at = #, amplitude = #, decay = # } }", {f, amplitude, f});
  else
    d.key("amplitude", amplitude);
  d.key("phase", phase);
}

/// Where a force acts.
void acts(SceneDraft& d) {
  if (d.beam) return d.line("at = \"tip\"");
  const int at = d.integer(1, d.dofs), other = d.integer(1, d.dofs), kind = d.integer(0, 9);
  if (kind == 0)
    d.line("direction = {}", SceneDraft::numbers(d.values(d.dofs, -1.0, 1.0)));
  else if (kind == 1 && at != other)
    d.line("between = [{}, {}]", at, other);
  else
    d.line("at = {}", at);
}

void force(SceneDraft& d) {
  d.line("kind = \"force\"");
  const double omega = d.rate * d.uniform(0.3, 2.5), size = d.stiffness * d.size;
  if (d.chance(0.2))
    d.key("frequency", omega / (2.0 * std::numbers::pi));
  else
    d.key("omega", omega);
  const auto harmonic = [&] {
    d.key("amplitude", size * d.uniform(0.1, 2.0));
    d.key("phase", d.uniform(0.0, 6.0));
  };
  harmonic();
  acts(d);
  const double mean = d.uniform(0.0, 1.0);
  if (mean < 0.3)
    d.key("mean", size * d.uniform(-0.3, 0.3));
  else if (mean < 0.4 && !d.beam)
    d.line("mean = {}", SceneDraft::numbers(d.values(d.dofs, -0.3, 0.3)));
  const int orders = d.chance(0.1) ? 6 : 3;
  for (int order = 2; order <= orders; ++order) {
    if (!d.chance(0.3)) continue;
    d.line("\n[[drive.harmonic]]\norder = {}", order);
    harmonic();
    if (d.chance(0.3)) acts(d);
  }
}

}  // namespace

void write_contacts(SceneDraft& d) {
  d.linear = d.chance(0.55);
  if (!d.linear) d.coulomb_alone = d.chance(0.1);
  const int count = std::min(d.masses(), d.chance(0.1) ? d.integer(4, 5) : d.integer(1, 3));
  choose_places(d, count);
  for (const int own : d.places) contact(d, own);
  if (d.beam || !d.chance(0.12)) return;
  // A stop beside a contact, at its mass.
  d.line("\n[[contact]]\nat = {}", d.places.front());
  clearance(d, d.places.front(), true);
}

void write_drive(SceneDraft& d) {
  d.line("\n[drive]");
  const double kind = d.uniform(0.0, 1.0);
  if (kind < (d.linear ? 0.4 : 0.55)) {
    d.belt = true;
    d.line("kind = \"belt\"");
    d.counterpart = d.chance(0.15) ? 0.0 : d.uniform(-1.0, 1.0) * d.speed();
    const double begin = d.uniform(0.0, 5.0) / d.rate;
    if (d.chance(0.75))
      d.key("speed", d.counterpart);
    else
      d.fill("speed = { from = #, to = #, begin = #, end = # }",
             {d.counterpart, d.uniform(-1.0, 1.0) * d.speed(), begin, begin + d.uniform(0.5, 10.0) / d.rate});
  } else if (kind < (d.linear ? 0.7 : 0.8)) {
    shaker(d);
  } else {
    force(d);
  }
}

}  // namespace slipmode::selftest
