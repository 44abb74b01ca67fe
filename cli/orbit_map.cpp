#include <slipmode/studies/orbit_map.hpp>

#include <slipmode/studies/result_file.hpp>
#include "cli/field_options.hpp"
#include "cli/sweep_request.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace slipmode::cli {
namespace {

struct OrbitMapArguments {
  std::string scene, output;
  std::vector<std::string> over;
  std::string start = "scene";
  studies::OrbitMapOptions options;
};

constexpr const char* kNoneFound = "none found";

/// How often each order was met from one start; 0: no orbit found.
struct OrderCount {
  std::map<int, std::size_t> orders;
  std::size_t failed = 0;

  void add(int order, const std::string& failure) { failure.empty() ? ++orders[order] : ++failed; }
};

void say(const std::string& start, const OrderCount& count, Report& out_report) {
  TextTable table({"from " + start, "points"});
  Json json = Json::object();
  for (const auto& [order, points] : count.orders) {
    const std::string name = order == 0 ? kNoneFound : fmt::format("period {}", order);
    table.add({name, std::to_string(points)});
    json[name] = points;
  }
  if (count.failed > 0) table.add({"failed", std::to_string(count.failed)});
  out_report.data["starts"][start] = {{"motions", json}, {"failed", count.failed}};
  out_report.text += table.str();
}

Report summary(const studies::Family& family, const studies::OrbitMapStudy& study,
               const std::vector<studies::Over>& over, const studies::OrbitMapOptions& options) {
  Report report;
  const std::string title = family.scene().name();
  report.data = {{"verb", "orbit map"}, {"keys", family.keys()}};
  if (over.size() == 1) {
    report.text = fmt::format("{}: {} values of {}\n", title, over[0].values.size(), over[0].key);
    report.data["points"] = over[0].values.size();
  } else {
    report.text = fmt::format("{}: {} x {} points of {} and {}\n", title, over[0].values.size(), over[1].values.size(),
                              over[0].key, over[1].key);
    report.data["points"] = {over[0].values.size(), over[1].values.size()};
  }
  bool any_without_orbit = false;
  for (const auto& [start, map] : study.maps) {
    OrderCount count;
    for (const auto& row : map.rows)
      for (const orbits::MapPoint& point : row) count.add(point.order, point.failure);
    say(start, count, report);
    any_without_orbit |= count.orders.contains(0);
  }
  for (const auto& [start, points] : study.strobes) {
    OrderCount count;
    for (const orbits::StrobePoint& point : points) count.add(point.settled.order, point.failure);
    say(start, count, report);
    any_without_orbit |= count.orders.contains(0);
  }
  if (any_without_orbit)
    report.text += fmt::format(
        "  {}: no orbit up to period {} within {} periods: chaos, a torus, or still settling; "
        "--max-order, --periods\n",
        kNoneFound, options.max_order, options.periods);
  return report;
}

Report run(const Session& session, const OrbitMapArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  std::vector<studies::Over> over;
  std::vector<std::string> keys;
  std::vector<std::vector<double>> values;
  for (const std::string& text : arguments.over) {
    over.push_back(parse_over(text));
    keys.push_back(over.back().key);
    values.push_back(over.back().values);
  }
  const studies::Family family(scene, keys);
  studies::OrbitMapOptions options = arguments.options;
  options.starts = {arguments.start};
  if (arguments.start == "both") options.starts = {"scene", "centre"};
  studies::check(family, options);
  for (const studies::Over& one : over) studies::check_values(scene, one.key, one.values);
  studies::ResultFile file(
      arguments.output, scene, keys.size() > 1 ? results::FileKind::kMap : results::FileKind::kStrobe,
      studies::command_of(over, options), "", session.division(), studies::pieces(values, options));
  options.journal = file.journal();
  const studies::OrbitMapStudy study = studies::orbit_map(family, values, options, session.run_options());
  if (study.interrupted) {
    Report report = interrupted_at(arguments.output);
    report.data["verb"] = "orbit map";
    return report;
  }
  file.finish([&](results::StoreWriter& writer) { studies::store(writer, family, study); });
  if (session.has_a_share()) return part_made(session, file.progress(), arguments.output, "rows");
  Report report = summary(family, study, over, arguments.options);
  tell_resumed(session, file.resumed(), "rows", report);
  tell_file("Map", arguments.output, report);
  return report;
}

}  // namespace

Verb add_orbit_map(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("map", "settled motion of a driven scene over one key or two");
  const auto arguments = std::make_shared<OrbitMapArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command
      ->add_option("--over", arguments->over,
                   "key and range, KEY=FROM:TO:STEP; given twice: a map over a plane, the first key across")
      ->required()
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--start", arguments->start,
                      "scene (its [initial]), centre (the steady linear motion in the gap), or both");
  add_fields(*command, arguments->options);
  command->footer(
      "Two keys: crossings, largest |multiplier|, amplitude of the orbit found by shooting from the settled motion.\n"
      "One key: stroboscopic bifurcation diagram, alternating and effective amplitudes.\n"
      "Example:\n  slipmode orbit map datasets/backlash_sdof/scene.toml --over drive.omega=0.1:2:0.01 "
      "--over drive.amplitude=0.1:3:0.02 --start both -o map.h5\n"
      "  slipmode orbit map datasets/clearance_3mass/scene.toml --over drive.omega=0.5:1.2:0.002 -o "
      "strobe.h5");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
