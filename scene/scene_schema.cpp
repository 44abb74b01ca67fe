#include <slipmode/scene/schema.hpp>

#include <slipmode/friction/amplitude_curve.hpp>
#include "scene/internal/field_schema.hpp"
#include "scene/internal/periods.hpp"
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <variant>
#include <vector>

namespace slipmode::scene {

namespace {

const Json kText = {{"type", "string"}};

Json one_or_more(const Limits& limits) {
  return any_of({number_schema(limits), array_schema(number_schema(limits), 1)});
}

/// A pair of masses.
Json pair_schema() { return array_schema(number_schema(kCount, "integer"), 2, 2); }

Json matrix_schema() { return array_schema(array_schema(number_schema(kFinite), 1), 1); }

Json chain_schema() {
  return TableSchema()
      .word("kind", "chain", "masses in a row, joined by springs")
      .fields<fem::ChainOptions>()
      .key("ends", {{"enum", kEnds}, {"default", kEnds.front()}}, "which ends are held to ground, the left one first")
      .json();
}

Json masses_schema() {
  const Json link = TableSchema()
                        .key("at", number_schema(kCount, "integer"), "mass that is joined to ground")
                        .key("between", pair_schema(), "the two masses that are joined")
                        .fields<fem::Link>()
                        .one_of({"at", "between"})
                        .json();
  return TableSchema()
      .word("kind", "masses", "masses along one line, joined as links say")
      .fields<fem::MassesOptions>()
      .key("link", array_schema(link, 1), "a spring and a damper between two masses, or a mass and ground")
      .json();
}

Json matrices_schema() {
  return TableSchema()
      .word("kind", "matrices", "a structure of your own, by its matrices")
      .key("mass", matrix_schema(), "rows of M, symmetric, positive definite [kg]")
      .require("mass")
      .key("damping", matrix_schema(), "rows of C, may have a skew part; default: 0 [N s/m]")
      .key("stiffness", matrix_schema(), "rows of K, symmetric; default: 0 [N/m]")
      .json();
}

Json damping_schema() {
  const Json ratio = TableSchema()
                         .key("ratio", one_or_more(kNonNegative), "damping ratio: one, or two at two frequencies")
                         .key("frequency", one_or_more(kPositive), "where the ratios are met [Hz]")
                         .require("ratio")
                         .require("frequency")
                         .json();
  return any_of({TableSchema().fields<fem::Rayleigh>().json(), ratio, TableSchema().fields<fem::ModalRatios>().json()});
}

/// A beam of one span, whose keys stand in [structure], or of several.
Json beam_schema(bool several) {
  TableSchema table;
  table.word("kind", "beam", "a cantilever of finite elements, clamped at x = 0").fields<fem::BeamOptions>();
  if (several) {
    table.key("span", array_schema(value_schema<fem::BeamSpan>(kFinite, false), 2), "spans from the clamp to the tip")
        .require("span");
  } else {
    table.fields<fem::BeamSpan>();
  }
  return table.key("tip", value_schema<fem::TipBody>(kFinite, false), "a rigid body on the free end")
      .key("damping", damping_schema(), "coefficient, or ratio, or modal_ratio; default: undamped")
      .json();
}

Json structure_schema() {
  return any_of({chain_schema(), beam_schema(false), beam_schema(true), masses_schema(), matrices_schema()});
}

TableSchema& add_place(TableSchema& table, bool with_direction = false) {
  const Json at = any_of({number_schema(kPositive), {{"const", "tip"}}});
  table.key("at", at, "where: a mass by its number from 1; on a beam x [m] or \"tip\"")
      .key("between", pair_schema(), "where: two masses, displacement x_j - x_i");
  if (!with_direction) return table;
  return table.key("direction", array_schema(number_schema(kFinite), 1), "where: one number per degree of freedom");
}

Json load_schema() { return any_of({number_schema(kPositive), TableSchema().fields<friction::NormalLoad>().json()}); }

Json contact_schema() {
  std::vector<Json> laws;
  const std::vector<std::string> words = law_spec_words();
  const auto contact_of = [&words](const std::string& word) {
    TableSchema table;
    add_place(table).one_of({"at", "between"});
    table.key("name", kText, "in tables and figures; default: \"contact 1\", ...");
    table.word("law", word, fmt::format("of the contact force: {}", fmt::join(words, ", ")));
    return table;
  };
  for (std::size_t i = 0; i < friction::law_words().size(); ++i) {
    TableSchema table = contact_of(words[i]);
    std::visit(
        [&table]<class Own>(const Own&) {
          table.fields<Own>({.without = {"left", "right"}});
        },
        alternative<friction::Law>(i));
    if (words[i] == friction::Clearance::word) {
      const Json side = TableSchema().fields<friction::Stop>({.all_optional = true}).json();
      table.key("stop", value_schema<friction::Stop>(kFinite, false), "both stops; or left and right")
          .key("left", side, "left stop, or what differs there")
          .key("right", side, "right stop, or what differs there");
    } else {
      table.key("normal_load", load_schema(), "a number, or a load that varies [N]")
          .require("normal_load")
          .key("tilt_deg", number_schema({.low = -90.0, .high = 90.0}), "of the slider's face, |tilt| < 90 [degrees]");
    }
    laws.push_back(table.json());
  }
  laws.push_back(contact_of(friction::Iwan::word).fields<friction::Iwan>().json());
  return array_schema(any_of(laws), 1);
}

Json amplitude_schema() {
  using Curve = friction::AmplitudeCurve;
  const Json points = array_schema(array_schema(number_schema(kNonNegative), 2, 2), 1);
  const Json curve =
      TableSchema()
          .key("polynomial", array_schema(number_schema(kFinite), 1), "a0 + a1 f + ..., f in Hz [m]")
          .key("table", points, "pairs of frequency and amplitude, straight lines between [Hz, m]")
          .key("exponential", value_schema<Curve::Exponential>(kFinite, false), "falls by 1/e over decay")
          .one_of({"polynomial", "table", "exponential"})
          .json();
  return any_of({number_schema(kNonNegative), curve});
}

Json belt_schema() {
  return TableSchema()
      .word("kind", "belt", "contacts rub on a belt")
      .key("speed", any_of({number_schema(kFinite), value_schema<friction::Belt>(kFinite, false)}),
           "a number, or a ramp [m/s]")
      .require("speed")
      .json();
}

Json shaker_schema() {
  return TableSchema()
      .word("kind", "shaker", "contacts rub on a slider that shakes")
      .fields<friction::Shaker>({.without = {"amplitude"}})
      .key("amplitude", amplitude_schema(), "a number, or a curve over frequency [m]")
      .require("amplitude")
      .json();
}

Json force_schema() {
  TableSchema harmonic;
  harmonic.fields<ForceSpec::Harmonic>();
  TableSchema table;
  table.word("kind", "force", "amplitude sin(omega t + phase) on the structure")
      .fields<friction::Force>({.all_optional = true})
      .key("frequency", number_schema(kPositive), "omega / 2 pi, instead of omega [Hz]")
      .one_of({"omega", "frequency"})
      .fields<ForceSpec::Harmonic>({.without = {"order"}})
      .key("mean", any_of({number_schema(kFinite), array_schema(number_schema(kFinite), 1)}),
           "constant part: a number where the force acts, or one per degree of freedom [N]")
      .key("harmonic", array_schema(add_place(harmonic, true).json(), 1), "more of a multiple of omega");
  return add_place(table, true).one_of({"at", "between", "direction"}).json();
}

/// `validation` of the drives that have one.
Json validation_schema() {
  TableSchema belt;
  belt.fields<ValidationSpec>().otherwise("speeds", "from 2.5 times the belt's own in steps of its twentieth");
  for (const auto& own : kValidationTimes) {
    belt.otherwise(own.key, fmt::format("{:g} slowest natural periods", own.periods));
  }
  return any_of({belt.json(), TableSchema().fields<DrivenValidationSpec>().json()});
}

Json time_schema() {
  TableSchema seconds, cycles;
  seconds.fields<TimeSpec>()
      .otherwise("duration", fmt::format("transient and {:g} slowest natural periods", kKeptPeriods))
      .otherwise("transient", fmt::format("0, or without a duration {:g} slowest natural periods", kTransientPeriods))
      .otherwise("sample", fmt::format("a slowest natural period or a cycle over {:g} or {}", 1.0 / kSamplePeriods,
                                       kUsualCycles.samples));
  cycles.fields<TimeSpec::Cycles>()
      .otherwise("cycles", fmt::format("{:g}", kUsualCycles.cycles))
      .otherwise("transient_cycles", fmt::format("0, or without cycles {:g}", kUsualCycles.transient_cycles));
  return any_of({seconds.json(), cycles.json()});
}

template <class S>
Json plain_schema() {
  return TableSchema().fields<S>().json();
}

Json reduction_schema() {
  return TableSchema()
      .fields<ReductionSpec>()
      .otherwise("functions", "one per sensor")
      .fields<pod::ModeChoice>()
      .otherwise("modes", "by energy")
      .json();
}

}  // namespace

Json schema_json() {
  TableSchema scene;
  scene.key("title", kText, "in reports and figures")
      .key("units", {{"enum", kUnits}}, "what numbers are in")
      .require("units")
      .key("structure", structure_schema(), "what vibrates")
      .require("structure")
      .key("contact", contact_schema(), "where it is touched, and by what law")
      .require("contact")
      .key("drive", any_of({belt_schema(), shaker_schema(), force_schema()}), "what moves it")
      .require("drive")
      .key("time", time_schema(), "how long a run is, and what is kept of it")
      .key("initial", plain_schema<InitialSpec>(), "where a run starts: at, or displacement and velocity")
      .key("ensemble", plain_schema<EnsembleSpec>(), "runs that feed the basis")
      .key("sensors", plain_schema<SensorSpec>(), "on a beam")
      .key("reduction", reduction_schema(), "what the reduced model is made of")
      .key("validation", validation_schema(), "how full and reduced models are compared; may be empty")
      .key("flow", plain_schema<dynamics::FlowOptions>(), "how motion is computed");
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "A scene of slipmode"}};
  schema.update(scene.json());
  return schema;
}

std::string scene_schema() { return schema_json().dump(2) + "\n"; }

}  // namespace slipmode::scene
