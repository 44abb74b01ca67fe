#include <slipmode/studies/orbit_map.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/gap_motion.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <utility>

namespace slipmode::studies {
namespace {

using StartOf = std::function<dynamics::State(const dynamics::HybridSystem&)>;

StartOf start_of(const Family& family, const std::string& kind) {
  if (kind == "centre") return [](const dynamics::HybridSystem& system) { return orbits::linear_response(system); };
  return [&family](const dynamics::HybridSystem& system) { return scene::initial_state(family.scene(), system); };
}

orbits::OrbitMap map_from(const Family& family, const orbits::MapGrid& grid, const std::string& start,
                          const OrbitMapOptions& options, std::size_t first_piece, const RunOptions& run) {
  orbits::MapOptions map;
  map.max_order = options.max_order;
  map.max_periods = options.periods;
  map.shooting.flow.method = family.scene().flow.method;
  if (!family.own().contacts().empty()) map.row = family.own().contacts().front().direction;
  orbits::MapSink sink;
  if (options.journal != nullptr) sink = results::map_sink(*options.journal, start);
  sink.first_piece = first_piece;
  return orbits::orbit_map(
      [&family](double x, double y) {
        return family.at({x, y});
      },
      start_of(family, start), grid, map, run.parallel("map from " + start), sink);
}

orbits::StrobeMap strobe_from(const Family& family, const std::vector<double>& values, const std::string& start,
                              const OrbitMapOptions& options, std::size_t first_piece, const RunOptions& run) {
  orbits::StrobeOptions strobe{.periods = options.periods,
                               .kept = options.kept,
                               .tolerance = options.tolerance,
                               .max_order = options.max_order,
                               .follow = options.follow};
  strobe.flow.method = family.scene().flow.method;
  const auto& contacts = family.own().contacts();
  strobe.rows.resize(static_cast<Eigen::Index>(contacts.size()), family.own().size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    strobe.rows.row(static_cast<Eigen::Index>(c)) = contacts[c].direction.transpose();
  }
  orbits::StrobeSink sink;
  if (options.journal != nullptr) sink = results::strobe_sink(*options.journal, start);
  sink.first_piece = first_piece;
  return orbits::strobe_map(family.systems(), start_of(family, start), values, strobe,
                            run.parallel("map from " + start), sink);
}

}  // namespace

void check(const Family& family, const OrbitMapOptions& options) {
  const std::size_t keys = family.keys().size();
  if (keys < 1 || keys > 2) {
    throw InvalidInput(
        fmt::format("over: found {} keys; expected one for a stroboscopic map, two for a map over a plane", keys));
  }
  if (!family.own().drive().period()) {
    throw InvalidInput(
        "orbit map: the scene's drive has no period; valid: kind = \"force\" or \"shaker\". For a belt see 'sweep' "
        "and 'orbit skeleton'");
  }
  if (keys == 2 && options.follow) {
    throw InvalidInput("--follow: points of a map over two keys each have their own start; valid with one --over");
  }
  if (options.starts.empty()) throw InvalidInput("starts: found none; expected scene, centre or both");
  for (const std::string& start : options.starts) {
    if (start == "scene" || start == "centre") continue;
    throw InvalidInput(fmt::format(
        "start {}: valid: scene (its [initial]), centre (the steady linear motion in the gap), both", start));
  }
}

Pieces pieces(const std::vector<std::vector<double>>& values, const OrbitMapOptions& options) {
  const SweepMode mode = options.follow ? SweepMode::kFollow : SweepMode::kIndependent;
  const std::size_t count = options.starts.size() * sweep_pieces(values.back().size(), mode, 1);
  return options.follow ? chains(count, "without --follow") : Pieces{count, values.size() == 2 ? "rows" : "values"};
}

std::string command_of(const std::vector<Over>& over, const OrbitMapOptions& options) {
  const std::string start = options.starts.size() == 1 ? options.starts.front() : "both";
  return command_text("orbit map", over, (start == "scene" ? "" : " --start " + start) + options_text(options));
}

OrbitMapStudy orbit_map(const Family& family, const std::vector<std::vector<double>>& values,
                        const OrbitMapOptions& options, const RunOptions& run) {
  check(family, options);
  if (values.size() != family.keys().size()) {
    throw InvalidInput(
        fmt::format("orbit map over {} keys: expected values of each, found {}", family.keys().size(), values.size()));
  }
  OrbitMapStudy study;
  if (values.size() == 2) study.grid = {.x = values[0], .y = values[1]};
  const std::size_t of_start = pieces(values, options).count / options.starts.size();
  for (std::size_t k = 0; k < options.starts.size(); ++k) {
    const std::string& start = options.starts[k];
    if (values.size() == 2) {
      study.maps.push_back({start, map_from(family, study.grid, start, options, k * of_start, run)});
      study.interrupted = study.maps.back().map.interrupted;
    } else {
      orbits::StrobeMap map = strobe_from(family, values.front(), start, options, k * of_start, run);
      study.interrupted = map.interrupted;
      study.strobes.push_back({start, std::move(map.points)});
    }
    if (study.interrupted) break;
  }
  return study;
}

void store(results::StoreWriter& writer, const Family& family, const OrbitMapStudy& study) {
  const std::string length = results::Units::of(family.scene().units).length;
  if (study.maps.empty()) {
    results::store_strobe(writer, family.axis(), study.strobes, length);
  } else {
    results::store_map(writer, family.axis(0), family.axis(1), study.grid, study.maps, length);
  }
}

}  // namespace slipmode::studies
