#include <slipmode/orbits/orbit_map.hpp>

#include <slipmode/results/map_store.hpp>
#include <slipmode/studies/family.hpp>
#include <slipmode/studies/result_file.hpp>
#include "cli/sweep_request.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <map>

namespace slipmode::cli {
namespace {

using orbits::MapPoint;
using orbits::StrobePoint;

struct OrbitMapArguments {
  std::string scene, output;
  std::vector<std::string> over;
  std::string start = "scene";
  int max_order = 8, periods = 1000, kept = 100;
  double tolerance = 1e-5;
  bool follow = false;
};

/// What both kinds of map have to do with.
struct Task {
  const Session& session;
  const OrbitMapArguments& arguments;
  const studies::Family& family;
  const std::vector<Over>& over;
  std::vector<std::string> starts;
  studies::ResultFile& file;

  [[nodiscard]] const scene::Scene& scene() const { return family.scene(); }
  [[nodiscard]] std::string length_unit() const { return results::Units::of(scene().units).length; }
};

std::vector<std::string> starts_of(const OrbitMapArguments& arguments) {
  if (arguments.start == "both") return {"scene", "centre"};
  if (arguments.start == "scene" || arguments.start == "centre") return {arguments.start};
  throw InvalidInput(
      fmt::format("--start {}: valid: scene (its [initial]), centre (the steady linear motion in the "
                  "gap), both",
                  arguments.start));
}

std::function<dynamics::State(const dynamics::HybridSystem&)> start_of(const scene::Scene& scene,
                                                                       const std::string& kind) {
  if (kind == "centre") return [](const dynamics::HybridSystem& system) { return orbits::linear_response(system); };
  return [&scene](const dynamics::HybridSystem& system) { return scene::initial_state(scene, system); };
}

/// How often each order was met; the first entry of `json` is that of motion which is not periodic.
void add_orders(const std::map<int, std::size_t>& orders, std::size_t failed, const std::string& start, Report& out) {
  TextTable table({"from " + start, "points"});
  Json json = Json::object();
  for (const auto& [order, count] : orders) {
    const std::string name = order == 0 ? "not periodic" : fmt::format("period {}", order);
    table.add({name, std::to_string(count)});
    json[name] = count;
  }
  if (failed > 0) table.add({"failed", std::to_string(failed)});
  out.data["starts"][start] = {{"motions", json}, {"failed", failed}};
  out.text += table.str();
}

Report run_map(const Task& task) {
  const orbits::MapGrid grid{.x = task.over[0].values, .y = task.over[1].values};
  orbits::MapOptions options;
  options.max_order = task.arguments.max_order;
  options.max_periods = task.arguments.periods;
  options.block = std::min(options.block, options.max_periods);
  options.shooting.flow.method = task.scene().flow.method;
  if (!task.family.own().contacts().empty()) options.row = task.family.own().contacts().front().direction;

  Report report;
  std::vector<results::StartedMap> maps;
  for (const std::string& start : task.starts) {
    orbits::OrbitMap map = orbits::orbit_map(
        [&](double x, double y) {
          return task.family.at({x, y});
        },
        start_of(task.scene(), start), grid, options, task.session.run_options().parallel("map from " + start),
        results::map_sink(task.file.journal(), start));
    if (map.interrupted) return interrupted_at(task.arguments.output);
    maps.push_back({start, std::move(map)});
  }
  task.file.finish([&](results::StoreWriter& writer) {
    results::store_map(writer, task.family.axis(0), task.family.axis(1), grid, maps, task.length_unit());
  });

  report.text = fmt::format("{}: {} x {} points of {} and {}\n", task.scene().title, grid.x.size(), grid.y.size(),
                            task.over[0].key, task.over[1].key);
  report.data = {{"verb", "orbit map"},
                 {"file", task.arguments.output},
                 {"keys", {task.over[0].key, task.over[1].key}},
                 {"points", {grid.x.size(), grid.y.size()}}};
  for (const auto& [start, map] : maps) {
    std::map<int, std::size_t> orders;
    std::size_t failed = 0;
    for (const auto& row : map.rows) {
      for (const MapPoint& point : row) point.failure.empty() ? ++orders[point.order] : ++failed;
    }
    add_orders(orders, failed, start, report);
  }
  return report;
}

Report run_strobe(const Task& task) {
  const Over& over = task.over.front();
  orbits::StrobeOptions options{.periods = task.arguments.periods,
                                .kept = task.arguments.kept,
                                .tolerance = task.arguments.tolerance,
                                .max_order = task.arguments.max_order,
                                .follow = task.arguments.follow};
  options.flow.method = task.scene().flow.method;
  const auto& contacts = task.family.own().contacts();
  options.rows.resize(static_cast<Eigen::Index>(contacts.size()), task.family.own().size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    options.rows.row(static_cast<Eigen::Index>(c)) = contacts[c].direction.transpose();
  }
  Report report;
  std::vector<results::StartedStrobe> runs;
  for (const std::string& start : task.starts) {
    orbits::StrobeMap map = orbits::strobe_map(task.family.systems(), start_of(task.scene(), start), over.values,
                                               options, task.session.run_options().parallel("map from " + start),
                                               results::strobe_sink(task.file.journal(), start));
    if (map.interrupted) return interrupted_at(task.arguments.output);
    runs.push_back({start, std::move(map.points)});
  }
  task.file.finish([&](results::StoreWriter& writer) {
    results::store_strobe(writer, task.family.axis(), runs, task.length_unit());
  });

  report.text = fmt::format("{}: {} values of {}\n", task.scene().title, over.values.size(), over.key);
  report.data = {
      {"verb", "orbit map"}, {"file", task.arguments.output}, {"keys", {over.key}}, {"points", over.values.size()}};
  for (const auto& [start, points] : runs) {
    std::map<int, std::size_t> orders;
    std::size_t failed = 0;
    for (const StrobePoint& point : points) point.failure.empty() ? ++orders[point.settled.order] : ++failed;
    add_orders(orders, failed, start, report);
  }
  return report;
}

void check_arguments(const OrbitMapArguments& arguments, const scene::Scene& scene) {
  if (arguments.over.size() > 2) {
    throw InvalidInput(fmt::format("--over: given {} times; once for a stroboscopic map, twice for a map over a plane",
                                   arguments.over.size()));
  }
  if (!scene.drive.period()) {
    throw InvalidInput(
        "orbit map: the scene's drive has no period; valid: kind = \"force\" or \"shaker\". For a belt "
        "see 'sweep' and 'orbit skeleton'");
  }
  if (arguments.over.size() == 2 && arguments.follow) {
    throw InvalidInput("--follow: points of a map over two keys each have their own start; valid with one --over");
  }
}

Report run(const Session& session, const OrbitMapArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  check_arguments(arguments, scene);
  std::vector<Over> over;
  for (const std::string& text : arguments.over) {
    over.push_back(parse_over(text));
    check_values(scene, over.back());
  }
  const std::string command =
      fmt::format("slipmode orbit map --over {} --start {} --max-order {} --periods {} --kept {} --tolerance {}{}",
                  fmt::join(arguments.over, " --over "), arguments.start, arguments.max_order, arguments.periods,
                  arguments.kept, arguments.tolerance, arguments.follow ? " --follow" : "");
  const std::vector<std::string> starts = starts_of(arguments);
  std::vector<std::string> keys;
  for (const Over& one : over) keys.push_back(one.key);
  const studies::Family family(scene, keys);
  studies::ResultFile file(arguments.output, scene, command);
  const Task task{session, arguments, family, over, starts, file};
  Report report = over.size() == 2 ? run_map(task) : run_strobe(task);
  report.data["verb"] = "orbit map";
  if (report.exit_code != kDone) return report;
  report.data["resumed"] = file.resumed();
  if (file.resumed() > 0)
    report.text += fmt::format("{} rows were taken over from an interrupted run\n", file.resumed());
  report.text += fmt::format("Map: {}\n", arguments.output);
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
  command->add_option("--max-order", arguments->max_order, "longest period looked for, in periods of the drive")
      ->check(CLI::PositiveNumber);
  command->add_option("--periods", arguments->periods, "periods of the drive simulated at most")
      ->check(CLI::PositiveNumber);
  command->add_option("--kept", arguments->kept, "one key: periods of them kept, the last ones")
      ->check(CLI::PositiveNumber);
  command->add_option("--tolerance", arguments->tolerance, "one key: sections nearer than this, relative, are the same")
      ->check(CLI::PositiveNumber);
  command->add_flag("--follow", arguments->follow, "one key: start each value where the one before it ended");
  command->footer(
      "Two keys: crossings, largest |multiplier|, amplitude of the orbit found by shooting from the settled motion.\n"
      "One key: stroboscopic bifurcation diagram, alternating and effective amplitudes.\n"
      "Example:\n  slipmode orbit map datasets/backlash_sdof/scene.toml --over drive.omega=0.1:2:0.01 "
      "--over drive.amplitude=0.1:3:0.02 --start both -o map.h5\n"
      "  slipmode orbit map datasets/clearance_3mass/scene.toml --over drive.omega=0.5:1.2:0.002 -o "
      "strobe.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
