#include <slipmode/scene/scene_words.hpp>
#include "scene/internal/scene_parts.hpp"

#include <fmt/format.h>
#include <numeric>

namespace slipmode::scene {

namespace {

constexpr int kMostMasses = 10'000'000;
constexpr int kMostElements = 1'000'000;

fem::ChainOptions read_chain(TomlReader& in, const std::string& units) {
  fem::ChainOptions chain;
  chain.units = units;
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

fem::BeamSpan read_span(TomlReader& in, fem::BeamTheory theory) {
  fem::BeamSpan span;
  span.length = in.number("length", kPositive);
  span.width = in.number("width", kPositive);
  span.thickness = in.number("thickness", kPositive);
  span.youngs_modulus = in.number("youngs_modulus", kPositive);
  span.density = in.number("density", kPositive);
  span.elements = static_cast<int>(in.integer("elements", 1, kMostElements));
  if (theory == fem::BeamTheory::kEulerBernoulli) {
    for (const char* key : {"poisson_ratio", "shear_coefficient"}) {
      in.refuse(key, "theory \"euler-bernoulli\" has no shear", "this key only with theory = \"timoshenko\"");
    }
    return span;
  }
  span.poisson_ratio = in.number_or("poisson_ratio", span.poisson_ratio,
                                    {.low = -1.0, .high = 0.5, .above = true, .text = "a number > -1 and <= 0.5"});
  span.shear_coefficient = in.number_or("shear_coefficient", span.shear_coefficient, kPositive);
  return span;
}

std::vector<fem::BeamSpan> read_spans(TomlReader& in, fem::BeamTheory theory) {
  if (!in.has("span")) return {read_span(in, theory)};
  std::vector<fem::BeamSpan> spans;
  for (TomlReader& table : in.tables("span")) {
    spans.push_back(read_span(table, theory));
    table.finish();
  }
  if (spans.size() == 1) {
    in.fail("span", "one span only", "two or more [[structure.span]], or the keys of the one span in [structure]");
  }
  return spans;
}

fem::TipBody read_tip(TomlReader in) {
  fem::TipBody tip;
  tip.mass = in.number_or("mass", tip.mass, kNonNegative);
  tip.inertia = in.number_or("inertia", tip.inertia, kNonNegative);
  tip.offset = in.number_or("offset", tip.offset, kFinite);
  tip.extension = in.number_or("extension", tip.extension, kNonNegative);
  in.finish();
  return tip;
}

fem::ProportionalRatios read_ratios(TomlReader& in) {
  const std::vector<double> ratios = in.per_item_or("ratio", {}, 2, kNonNegative);
  std::vector<double> frequencies;
  if (ratios.size() == 1) {
    frequencies = {in.number("frequency", kPositive)};
  } else {
    if (!in.has("frequency")) (void)in.number("frequency", kPositive);
    frequencies = in.numbers_or("frequency", {}, kPositive, 2);
    if (frequencies[0] == frequencies[1]) in.fail("frequency", "the same twice", "two different frequencies");
  }
  fem::ProportionalRatios damping;
  for (std::size_t i = 0; i < ratios.size(); ++i) damping.at.push_back({ratios[i], frequencies[i]});
  return damping;
}

fem::BeamDamping read_damping(TomlReader in) {
  const std::vector<std::string> ways = {"coefficient", "ratio", "modal_ratio"};
  std::vector<std::string> given;
  for (const std::string& way : ways) {
    if (in.has(way)) given.push_back(way);
  }
  if (given.size() > 1) {
    in.fail(given[1], fmt::format("{} is given too", given[0]), "exactly one of coefficient, ratio, modal_ratio");
  }
  fem::BeamDamping damping;
  if (in.has("ratio")) {
    damping = read_ratios(in);
  } else if (in.has("modal_ratio")) {
    // A number holds for all modes, an array for modes 1, 2, … and its last value for all further ones.
    const bool is_list = in.is_array("modal_ratio");
    const std::vector<double> ratios = is_list ? in.numbers_or("modal_ratio", {}, kNonNegative)
                                               : std::vector<double>{in.number("modal_ratio", kNonNegative)};
    if (ratios.empty()) in.fail("modal_ratio", "no values", "a number >= 0, or an array of one or more");
    damping = fem::ModalRatios{ratios};
  } else {
    damping = fem::Rayleigh{.mass = in.number_or("mass_coefficient", 0.0, kNonNegative),
                            .stiffness = in.number("coefficient", kNonNegative)};
  }
  in.finish();
  return damping;
}

fem::BeamOptions read_beam(TomlReader& in) {
  fem::BeamOptions beam;
  beam.theory = kTheories[in.choice_or("theory", 0, words_of(kTheories))].theory;
  beam.spans = read_spans(in, beam.theory);
  if (in.has("tip")) beam.tip = read_tip(in.table("tip"));
  if (in.has("damping")) beam.damping = read_damping(in.table("damping"));
  in.finish();
  return beam;
}

}  // namespace

double beam_length(const fem::BeamOptions& beam) {
  return std::accumulate(beam.spans.begin(), beam.spans.end(), 0.0,
                         [](double sum, const fem::BeamSpan& span) { return sum + span.length; });
}

double beam_reach(const fem::BeamOptions& beam) { return beam_length(beam) + beam.tip.extension; }

StructureSpec read_structure(TomlReader in, const std::string& units) {
  const std::string kind = kStructures[in.choice("kind", kStructures)];
  if (kind == "chain") return read_chain(in, units);
  if (kind == "masses") return read_masses(in, units);
  if (kind == "matrices") return read_matrices(in, units);
  if (units != "SI")
    in.fail("kind", "units are \"" + units + "\", a beam has dimensions", "units = \"SI\" with a beam");
  return read_beam(in);
}

}  // namespace slipmode::scene
