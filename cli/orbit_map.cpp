#include <slipmode/orbits/orbit_map.hpp>

#include <slipmode/results/map_store.hpp>
#include <slipmode/results/provenance.hpp>
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
  scene::Scene scene;
  std::vector<Over> over;
  std::vector<std::string> starts;
  results::Journal& journal;
  std::string command;
};

std::vector<std::string> starts_of(const OrbitMapArguments& arguments) {
  if (arguments.start == "both") return {"scene", "centre"};
  if (arguments.start == "scene" || arguments.start == "centre") return {arguments.start};
  throw InvalidInput(
      fmt::format("--start {}: valid: scene (its [initial]), centre (the steady linear motion in the "
                  "gap), both",
                  arguments.start));
}

/// Systems at values of keys. A force's frequency and amplitude leave the structure alone: its modes are then shared.
class Systems {
 public:
  Systems(const scene::Scene& scene, const std::vector<Over>& over) : scene_(scene), base_(scene::build_system(scene)) {
    for (const Over& one : over) keys_.push_back(one.key);
    shares_structure_ = scene.drive.force() != nullptr && std::ranges::all_of(keys_, [](const std::string& key) {
                          return key == "drive.omega" || key == "drive.amplitude";
                        });
  }

  [[nodiscard]] dynamics::HybridSystem at(const std::vector<double>& values) const {
    if (!shares_structure_) {
      scene::Scene changed = scene_;
      for (std::size_t k = 0; k < keys_.size(); ++k) changed = scene::set_key(changed, keys_[k], values[k]);
      return scene::build_system(changed);
    }
    friction::Force force = *scene_.drive.force();
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      (keys_[k] == "drive.omega" ? force.omega : force.harmonics.front().amplitude) = values[k];
    }
    return base_.with_drive(force);
  }
  [[nodiscard]] const dynamics::HybridSystem& base() const { return base_; }

 private:
  const scene::Scene& scene_;
  dynamics::HybridSystem base_;
  std::vector<std::string> keys_;
  bool shares_structure_ = false;
};

std::function<dynamics::State(const dynamics::HybridSystem&)> start_of(const scene::Scene& scene,
                                                                       const std::string& kind) {
  if (kind == "centre") return [](const dynamics::HybridSystem& system) { return orbits::linear_response(system); };
  return [&scene](const dynamics::HybridSystem& system) { return scene::initial_state(scene, system); };
}

Report interrupted(const Task& task) {
  Report report;
  report.exit_code = kInterrupted;
  report.text = fmt::format("interrupted; what is done is kept in {}\nThe same command goes on from there.",
                            results::Journal::path_for(task.arguments.output).string());
  report.data = {{"verb", "orbit map"}, {"message", report.text}};
  return report;
}

results::StoreWriter writer_of(const Task& task) {
  results::StoreWriter writer(task.arguments.output, task.scene.units);
  results::save(writer, results::provenance_of(task.scene, task.command));
  return writer;
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
  const Systems systems(task.scene, task.over);
  orbits::MapOptions options;
  options.max_order = task.arguments.max_order;
  options.max_periods = task.arguments.periods;
  options.block = std::min(options.block, options.max_periods);
  options.shooting.flow.method = task.scene.flow.method;
  if (!systems.base().contacts().empty()) options.row = systems.base().contacts().front().direction;

  Report report;
  std::vector<results::StartedMap> maps;
  for (const std::string& start : task.starts) {
    ProgressLine line("map from " + start, task.session.progress_mode());
    orbits::OrbitMap map = orbits::orbit_map(
        [&](double x, double y) {
          return systems.at({x, y});
        },
        start_of(task.scene, start), grid, options, task.session.parallel(line),
        results::map_sink(task.journal, start));
    if (map.interrupted) return interrupted(task);
    maps.push_back({start, std::move(map)});
  }
  const results::Units units = results::Units::of(task.scene.units);
  results::StoreWriter writer = writer_of(task);
  results::store_map(writer, results::sweep_axis(task.scene, task.over[0].key),
                     results::sweep_axis(task.scene, task.over[1].key), grid, maps, units.length);
  writer.commit();

  report.text = fmt::format("{}: {} x {} points of {} and {}\n", task.scene.title, grid.x.size(), grid.y.size(),
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
  const Systems systems(task.scene, task.over);
  orbits::StrobeOptions options{.periods = task.arguments.periods,
                                .kept = task.arguments.kept,
                                .tolerance = task.arguments.tolerance,
                                .max_order = task.arguments.max_order,
                                .follow = task.arguments.follow};
  options.flow.method = task.scene.flow.method;
  const auto& contacts = systems.base().contacts();
  options.rows.resize(static_cast<Eigen::Index>(contacts.size()), systems.base().size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    options.rows.row(static_cast<Eigen::Index>(c)) = contacts[c].direction.transpose();
  }
  Report report;
  std::vector<results::StartedStrobe> runs;
  for (const std::string& start : task.starts) {
    ProgressLine line("map from " + start, task.session.progress_mode());
    orbits::StrobeMap map =
        orbits::strobe_map([&](double value) { return systems.at({value}); }, start_of(task.scene, start), over.values,
                           options, task.session.parallel(line), results::strobe_sink(task.journal, start));
    if (map.interrupted) return interrupted(task);
    results::StartedStrobe run{start, {}};
    for (auto& point : map.points) run.points.push_back(std::move(*point));
    runs.push_back(std::move(run));
  }
  const results::Units units = results::Units::of(task.scene.units);
  results::StoreWriter writer = writer_of(task);
  results::store_strobe(writer, results::sweep_axis(task.scene, over.key), runs, units.length);
  writer.commit();

  report.text = fmt::format("{}: {} values of {}\n", task.scene.title, over.values.size(), over.key);
  report.data = {
      {"verb", "orbit map"}, {"file", task.arguments.output}, {"keys", {over.key}}, {"points", over.values.size()}};
  for (const auto& [start, points] : runs) {
    std::map<int, std::size_t> orders;
    std::size_t failed = 0;
    for (const StrobePoint& point : points) point.failure.empty() ? ++orders[point.order] : ++failed;
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
  results::Journal journal(
      results::Journal::path_for(arguments.output),
      results::fingerprint(fmt::format("{}\n{}\n{}", results::version(), command, scene::scene_to_toml(scene))));
  const std::size_t resumed = journal.records().size();
  const Task task{session, arguments, scene, over, starts, journal, command};
  Report report = over.size() == 2 ? run_map(task) : run_strobe(task);
  if (report.exit_code != kDone) return report;
  journal.remove();
  report.data["resumed"] = resumed;
  if (resumed > 0) report.text += fmt::format("{} rows were taken over from an interrupted run\n", resumed);
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
