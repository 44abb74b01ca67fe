#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>
#include <numeric>

namespace slipmode::scene {

namespace {

fem::ChainOptions read_chain(TomlReader& in, const std::string& units) {
  fem::ChainOptions chain;
  chain.units = units;
  const std::string& ends = kEnds[in.choice_or("ends", 0, kEnds)];
  chain.left_fixed = ends.starts_with("fixed");
  chain.right_fixed = ends.ends_with("fixed");
  const auto count = [&chain](std::string_view key) {
    const int springs = chain.masses - 1 + static_cast<int>(chain.left_fixed) + static_cast<int>(chain.right_fixed);
    return key == "stiffness" ? springs : chain.masses;
  };
  read_fields(in, chain, {.count = count});
  in.finish();
  return chain;
}

fem::BeamSpan read_span(TomlReader& in, fem::BeamTheory theory) {
  fem::BeamSpan span;
  const Without shear = without_shear(theory);
  for (const std::string_view key : shear) {
    in.refuse(std::string(key), "theory \"euler-bernoulli\" has no shear",
              "this key only with theory = \"timoshenko\"");
  }
  read_fields(in, span, {.without = shear});
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

fem::ProportionalRatios read_ratios(TomlReader& in) {
  const std::vector<double> ratios = in.per_item("ratio", kNonNegative, 2);
  std::vector<double> frequencies;
  if (ratios.size() == 1) {
    frequencies = {in.number("frequency", kPositive)};
  } else {
    frequencies = in.numbers("frequency", kPositive, 2);
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
    fem::ModalRatios modal;
    read_fields(in, modal);
    if (modal.ratios.empty()) in.fail("modal_ratio", "no values", "a number >= 0, or an array of one or more");
    damping = modal;
  } else {
    fem::Rayleigh rayleigh;
    read_fields(in, rayleigh);
    damping = rayleigh;
  }
  in.finish();
  return damping;
}

fem::BeamOptions read_beam(TomlReader& in) {
  fem::BeamOptions beam;
  read_fields(in, beam);
  beam.spans = read_spans(in, beam.theory);
  if (in.has("tip")) beam.tip = read_table<fem::TipBody>(in.table("tip"));
  if (in.has("damping")) beam.damping = read_damping(in.table("damping"));
  in.finish();
  return beam;
}

}  // namespace

Without without_shear(fem::BeamTheory theory) {
  if (theory == fem::BeamTheory::kTimoshenko) return {};
  return {"poisson_ratio", "shear_coefficient"};
}

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
