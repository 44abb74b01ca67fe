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
                          const OrbitMapOptions& options, const RunOptions& run) {
  orbits::MapOptions map;
  map.max_order = options.max_order;
  map.max_periods = options.periods;
  map.shooting.flow.method = family.scene().flow.method;
  if (!family.own().contacts().empty()) map.row = family.own().contacts().front().direction;
  orbits::MapSink sink;
  if (options.journal != nullptr) sink = results::map_sink(*options.journal, start);
  return orbits::orbit_map(
      [&family](double x, double y) {
        return family.at({x, y});
      },
      start_of(family, start), grid, map, run.parallel("map from " + start), sink);
}

orbits::StrobeMap strobe_from(const Family& family, const std::vector<double>& values, const std::string& start,
                              const OrbitMapOptions& options, const RunOptions& run) {
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
  return orbits::strobe_map(family.systems(), start_of(family, start), values, strobe,
                            run.parallel("map from " + start), sink);
}

}  // namespace

void check(const Family& family, const OrbitMapOptions& options) {
  const std::size_t keys = family.keys().size();
  if (keys < 1 || keys > 2) {
    throw InvalidInput(
        fmt::format("--over: given {} times; once for a stroboscopic map, twice for a map over a plane", keys));
  }
  if (!family.own().drive().period()) {
    throw InvalidInput(
        "orbit map: the scene's drive has no period; valid: kind = \"force\" or \"shaker\". For a belt see 'sweep' "
        "and 'orbit skeleton'");
  }
  if (keys == 2 && options.follow) {
    throw InvalidInput("--follow: points of a map over two keys each have their own start; valid with one --over");
  }
  for (const std::string& start : options.starts) {
    if (start == "scene" || start == "centre") continue;
    throw InvalidInput(fmt::format(
        "--start {}: valid: scene (its [initial]), centre (the steady linear motion in the gap), both", start));
  }
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
  for (const std::string& start : options.starts) {
    if (values.size() == 2) {
      study.maps.push_back({start, map_from(family, study.grid, start, options, run)});
      study.interrupted = study.maps.back().map.interrupted;
    } else {
      orbits::StrobeMap map = strobe_from(family, values.front(), start, options, run);
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
