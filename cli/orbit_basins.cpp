#include <slipmode/studies/basins.hpp>

#include <slipmode/studies/result_file.hpp>
#include "cli/field_options.hpp"
#include "cli/orbit_report.hpp"
#include "cli/sweep_request.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

namespace slipmode::cli {
namespace {

using orbits::BasinAttractor;

struct OrbitBasinsArguments {
  std::string scene, output, along;
  std::vector<std::string> over;
  studies::BasinsOptions options;
};

Json attractor_json(const std::vector<BasinAttractor>& attractors, const diagnostics::BasinShare& own) {
  Json json{{"attractor", own.attractor}, {"motion", results::attractor_text(attractors, own.attractor)},
            {"starts", own.cells},        {"share", own.share},
            {"share_error", own.error},   {"met_event", own.met_event}};
  if (own.least_coordinate <= own.largest_coordinate) {
    json["coordinate"] = {own.least_coordinate, own.largest_coordinate};
  }
  if (own.attractor < 0) return json;
  const BasinAttractor& one = attractors[static_cast<std::size_t>(own.attractor)];
  json["kind"] = to_string(one.kind);
  if (one.kind == BasinAttractor::Kind::kChaotic) {
    json["exponent"] = one.exponent;
    json["exponent_error"] = one.exponent_error;
    return json;
  }
  json["order"] = one.orbit.order;
  json["crossings"] = one.orbit.crossings;
  json["symmetric"] = one.orbit.symmetric;
  json["multipliers"] = complex_json(one.orbit.multipliers);
  return json;
}

/// "multipliers 0.72", "coordinate -0.33 to 0.33", "exponent 0.05 ± 0.01".
std::string note_of(const std::vector<BasinAttractor>& attractors, const diagnostics::BasinShare& own) {
  if (own.attractor < 0) return "";
  const BasinAttractor& one = attractors[static_cast<std::size_t>(own.attractor)];
  if (one.kind == BasinAttractor::Kind::kChaotic) {
    return fmt::format("exponent {:.3g} ± {:.1g}", one.exponent, one.exponent_error);
  }
  if (own.least_coordinate <= own.largest_coordinate) {
    return fmt::format("coordinate {:.4g} to {:.4g}", own.least_coordinate, own.largest_coordinate);
  }
  return "multipliers " + multipliers_text(one.orbit.multipliers);
}

Report summary(const studies::Family& family, const studies::BasinsRequest& request,
               const studies::BasinsStudy& study) {
  Report report;
  const auto& [across, up] = request.over;
  report.text = fmt::format("{}: {} x {} starts over {} and {}\n", family.scene().name(), across.values.size(),
                            up.values.size(), across.key, up.key);
  report.data = {{"verb", "orbit basins"},
                 {"keys", {across.key, up.key}},
                 {"starts", {across.values.size(), up.values.size()}},
                 {"attractors", Json::array()}};
  TextTable table({"attractor", "share %", "±", "met events %", ""});
  std::size_t undecided = 0;
  for (const diagnostics::BasinShare& own : study.measures.shares) {
    report.data["attractors"].push_back(attractor_json(study.basins.attractors, own));
    if (own.attractor < 0) undecided = own.cells;
    if (own.cells == 0) continue;
    const std::string text = results::attractor_text(study.basins.attractors, own.attractor);
    table.add({own.attractor < 0 ? text : fmt::format("{} {}", own.attractor, text), fixed(100.0 * own.share, 2),
               fixed(100.0 * own.error, 2), fixed(100.0 * own.met_event, 1), note_of(study.basins.attractors, own)});
  }
  report.text += table.str();
  const diagnostics::BoundaryUncertainty& boundary = study.measures.boundary;
  report.data["uncertainty"] = {{"exponent", boundary.exponent}, {"error", boundary.error}};
  if (std::isfinite(boundary.exponent)) {
    report.text +=
        fmt::format("Boundary: uncertainty exponent {:.3f} ± {:.3f} (1: smooth)\n", boundary.exponent, boundary.error);
  }
  if (const auto& strip = study.measures.strip) {
    report.data["strip"] = {{"share", strip->share}, {"met_event", strip->met_event}};
    if (strip->share > 0.0) {
      report.text += fmt::format("Linear strip: {:.2f} % of the starts, {:.1f} % of which meet an event first\n",
                                 100.0 * strip->share, 100.0 * strip->met_event);
    }
  }
  if (undecided > 0) {
    report.text +=
        "Undecided: no orbit up to --max-order within --periods, and not chaotic by its exponent. Chaos that only "
        "passes settles with more --periods\n";
  }
  for (const results::BasinsAlong& along : study.along) {
    Json json = Json::array();
    for (const diagnostics::BasinShare& own : along.shares) json.push_back(attractor_json(along.attractors, own));
    report.data["along"].push_back({{"value", along.value}, {"attractors", json}});
  }
  return report;
}

Report run(const Session& session, const OrbitBasinsArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  if (arguments.over.size() != 2) {
    throw InvalidInput(
        fmt::format("--over: given {} times; twice, each a coordinate of the start: "
                    "--over initial.displacement.0=-2:2:0.01 --over initial.velocity.0=-2:2:0.01",
                    arguments.over.size()));
  }
  studies::BasinsRequest request;
  for (std::size_t k = 0; k < 2; ++k) {
    request.over[k] = parse_over(arguments.over[k]);
  }
  std::vector<std::string> keys;
  if (!arguments.along.empty()) {
    const studies::Over along = parse_over(arguments.along);
    keys.push_back(along.key);
    request.along = along.values;
  }
  const studies::Family family(scene, keys);
  studies::check(family, request);
  if (!keys.empty()) studies::check_values(scene, keys.front(), request.along);
  studies::BasinsOptions options = arguments.options;
  studies::ResultFile file(arguments.output, scene, results::FileKind::kBasins,
                           studies::command_of(family, request, options), "", session.division(),
                           studies::pieces(request));
  options.journal = file.journal();
  const studies::BasinsStudy study = studies::basins(family, request, options, session.run_options());
  if (study.interrupted) {
    Report report = interrupted_at(arguments.output);
    report.data["verb"] = "orbit basins";
    return report;
  }
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, family, request, study); });
  if (session.has_a_share()) return part_made(session, file.progress(), arguments.output, "rows");
  Report report = summary(family, request, study);
  tell_resumed(session, file.resumed(), "rows", report);
  tell_file("Basins", arguments.output, report);
  return report;
}

}  // namespace

Verb add_orbit_basins(CLI::App& orbit) {
  CLI::App* command =
      orbit.add_subcommand("basins", "which attractor each start of a plane ends on, with shares and boundary");
  const auto arguments = std::make_shared<OrbitBasinsArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML) with a force or a shaker")->required();
  command
      ->add_option("--over", arguments->over,
                   "coordinate of the start and range, twice: initial.displacement.K=FROM:TO:STEP, "
                   "initial.velocity.K=FROM:TO:STEP, K from 0; the first across")
      ->required()
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--along", arguments->along, "a third key, KEY=FROM:TO:STEP: shares at each of its values too");
  add_fields(*command, arguments->options);
  command->footer(
      "Attractors: orbits found by shooting, all motions in the gap as one with a coordinate, chaotic motions by their "
      "exponent.\nThe other coordinates of the start are those of the scene's [initial].\n"
      "Example:\n  slipmode orbit basins datasets/play_oscillator/scene.toml --set drive.amplitude=0.3 "
      "--set drive.omega=0.5005 --set structure.link.0.damping=0.4 --over initial.displacement.0=-2:2:0.04 "
      "--over initial.velocity.0=-2:2:0.04 -o basins.h5");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
