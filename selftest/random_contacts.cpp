#include "selftest/scene_draft.hpp"

#include <algorithm>
#include <numbers>
#include <string_view>
#include <vector>

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
/// @param share  of the usual
void load(SceneDraft& d, bool varying, double share) {
  const double constant = share * d.stiffness * d.size * d.uniform(0.2, 3.0);
  const double kind = varying ? d.uniform(0.0, d.linear ? 1.0 : 0.85) : 0.0;
  if (kind < 0.6) return d.key("normal_load", constant);
  d.varying = true;
  if (kind < 0.85)
    return d.fill("normal_load = { constant = #, slope = # }", {constant, share * d.stiffness * d.uniform(-1.5, 1.5)});
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
    d.stop(name, stiffness, damping, gap);
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

/// What stands at a contact's place already, and so which laws may join it there.
enum class Beside { kNothing, kSoft, kRigid };

using Words = std::vector<std::string_view>;

/// The laws to draw from, likely ones more than once.
Words laws(const SceneDraft& d, bool linear, Beside beside) {
  if (beside == Beside::kRigid) return linear ? Words{"clearance"} : Words{"clearance", "tanh"};
  if (beside == Beside::kSoft)
    return linear ? Words{"clearance", "compliant", "iwan"} : Words{"clearance", "compliant", "tanh", "dahl", "lugre"};
  if (d.coulomb_alone) return {"coulomb"};
  if (linear)
    return {"clearance", "clearance", "clearance", "coulomb", "coulomb", "coulomb", "compliant", "compliant", "iwan"};
  return {"coulomb", "stribeck", "tanh", "dahl", "lugre", "table"};
}

void friction(SceneDraft& d, std::string_view word, bool linear) {
  const double mu_k = d.chance(0.08) ? 0.0 : d.uniform(0.05, 0.5);
  const double mu_s = d.chance(0.2) ? mu_k : mu_k + (d.chance(0.1) ? d.uniform(1.0, 5.0) : d.uniform(0.0, 0.5));
  d.line("law = \"{}\"", word);
  if (word == "compliant") {
    d.key("stiffness", d.contact_spring(200.0, 1e6));
  } else if (word == "stribeck") {
    d.key("alpha", d.uniform(0.2, 15.0) / d.speed());
  } else if (word == "tanh") {
    d.fill("alpha = #\nepsilon = #", {d.uniform(0.2, 15.0) / d.speed(), d.uniform(0.02, 0.2) * d.speed()});
  } else if (word == "dahl") {
    d.fill("mu = #\nstiffness = #", {d.uniform(0.1, 0.6), d.contact_spring(200.0, 1e4)});
  } else if (word == "lugre") {
    const double bristle = d.contact_spring(200.0, 1e4);
    d.fill("stribeck_speed = #\nstiffness = #", {d.uniform(0.02, 0.5) * d.speed(), bristle});
    d.key("damping", d.chance(0.3) ? 0.0 : d.uniform(0.0, 0.5) * std::sqrt(bristle * d.stiffness) / d.rate);
    d.key("viscous", d.chance(0.5) ? 0.0 : d.uniform(0.0, 0.3) * d.stiffness / d.rate);
  } else if (word == "table") {
    std::vector<double> speeds{0.0};
    for (int further = d.integer(1, 7); further > 0; --further)
      speeds.push_back(speeds.back() + d.speed() * d.uniform(0.05, 1.0));
    std::vector<double> points = d.values(static_cast<int>(speeds.size()), 0.0, 0.5);
    points.front() = mu_k;
    d.line("speeds = {}\ncoefficients = {}", SceneDraft::numbers(speeds), SceneDraft::numbers(points));
  }
  const double least = word == "lugre" ? 0.1 : 0.0;
  if (word != "dahl") d.key("mu_s", std::max(mu_s, least));
  if (word != "dahl" && word != "table") d.key("mu_k", std::max(mu_k, least));
  if (linear && mu_k > 0.1 && d.chance(0.2)) d.key("tilt_deg", d.uniform(-5.0, 5.0));
  // Bristles and laws of the speed have times of their own, which would shrink with their load.
  load(d, linear, linear || d.coulomb_alone ? d.pressed : 1.0);
}

void joint(SceneDraft& d) {
  d.line("law = \"iwan\"\nelements = {}", d.integer(2, 6));
  d.fill("slip_force = #\nstiffness = #",
         {d.pressed * d.stiffness * d.size * d.uniform(0.05, 1.0), d.contact_spring(200.0, 1e6)});
  d.fill("chi = #\nbeta = #", {d.uniform(-0.9, 2.0), d.chance(0.5) ? 0.0 : d.uniform(0.0, 2.0)});
}

/// @return what now stands at the place
Beside contact(SceneDraft& d, int own, Beside beside) {
  d.line("\n[[contact]]");
  bool of_mass = true;
  if (beside == Beside::kNothing)
    of_mass = place(d, own);
  else
    d.line("at = {}", own);
  if (d.chance(0.1)) d.line("name = \"contact {} at {}\"", beside == Beside::kNothing ? 1 : 2, own);
  // Of a piecewise-linear scene all are, of another one some.
  const bool linear = d.linear || (!d.coulomb_alone && d.chance(0.3));
  const Words words = laws(d, linear, beside);
  const std::string_view word = words[static_cast<std::size_t>(d.integer(0, static_cast<int>(words.size()) - 1))];
  if (word == "clearance")
    clearance(d, own, of_mass);
  else if (word == "iwan")
    joint(d);
  else
    friction(d, word, linear);
  return word == "coulomb" || word == "stribeck" || word == "table" ? Beside::kRigid : Beside::kSoft;
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
  d.coulomb_alone = !d.linear && d.chance(0.1);
  const int count = std::min(d.masses(), d.chance(0.1) ? d.integer(4, 5) : d.integer(1, 3));
  choose_places(d, count);
  std::vector<Beside> standing;
  for (const int own : d.places) standing.push_back(contact(d, own, Beside::kNothing));
  if (!d.beam && d.chance(0.15)) contact(d, d.places.front(), standing.front());
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
