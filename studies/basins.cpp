#include <slipmode/studies/basins.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/numbers.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

namespace slipmode::studies {
namespace {

/// Which number of the start a key is.
struct StartCoordinate {
  bool is_velocity = false;
  Eigen::Index dof = 0;

  void set(dynamics::State& state, double value) const { (is_velocity ? state.v : state.q)(dof) = value; }
};

StartCoordinate coordinate_of(const Family& family, const std::string& key) {
  for (const bool is_velocity : {false, true}) {
    const std::string prefix = is_velocity ? "initial.velocity." : "initial.displacement.";
    if (!key.starts_with(prefix)) continue;
    const auto dof = number_in<Eigen::Index>(key.substr(prefix.size()));
    if (dof && *dof >= 0 && *dof < family.own().size()) return {.is_velocity = is_velocity, .dof = *dof};
  }
  const Eigen::Index last = family.own().size() - 1;
  throw InvalidInput(
      fmt::format("{}: no coordinate of the start; valid: initial.displacement.K, initial.velocity.K, K = 0{}", key,
                  last > 0 ? fmt::format(" to {}", last) : ""));
}

orbits::BasinOptions options_of(const Family& family, const BasinsOptions& options) {
  orbits::BasinOptions all{.sample = options.sample};
  all.settle.max_order = options.max_order;
  all.settle.max_periods = options.periods;
  all.settle.shooting.flow.method = family.scene().flow.method;
  const int periods = std::max(options.periods, 200);  // a stretch of 25 in each of the eight that give the error
  all.exponent = [periods, flow = scene::uncertified(family.scene().flow)](const dynamics::HybridSystem& system,
                                                                           const dynamics::State& state) {
    const double period = system.drive().period().value();
    const diagnostics::LyapunovExponent found = diagnostics::largest_exponent(
        system, state, {.transient = 0.0, .duration = periods * period, .interval = period, .flow = flow});
    return orbits::MeasuredExponent{found.nats, found.error};
  };
  return all;
}

}  // namespace

void check(const Family& family, const BasinsRequest& request) {
  for (const Over& axis : request.over) {
    (void)coordinate_of(family, axis.key);
    if (!axis.values.empty() && std::ranges::all_of(axis.values, [](double value) { return std::isfinite(value); })) {
      continue;
    }
    throw InvalidInput(fmt::format("{}: expected at least one value, all finite", axis.key));
  }
  if (request.over[0].key == request.over[1].key) {
    throw InvalidInput(fmt::format("{}: given twice; a plane needs two coordinates of the start", request.over[0].key));
  }
  if (!family.keys().empty() && family.keys().front().starts_with("initial.")) {
    throw InvalidInput(
        fmt::format("--along {}: a coordinate of the start; valid: a key of the structure, a contact or "
                    "the drive, as drive.amplitude",
                    family.keys().front()));
  }
  if (!family.own().drive().period()) {
    throw InvalidInput(
        "orbit basins: the scene's drive has no period, so motions have no common phase; valid: drive.kind = \"force\" "
        "or \"shaker\". For a belt see 'sweep' and 'orbit find --start'");
  }
}

std::string command_of(const Family& family, const BasinsRequest& request, const BasinsOptions& options) {
  std::string along;
  if (!family.keys().empty()) along = " --along " + over_text({family.keys().front(), request.along});
  return command_text("orbit basins", {request.over.begin(), request.over.end()}, along + options_text(options));
}

Pieces pieces(const BasinsRequest& request) {
  return {.count = request.over[1].values.size() * (1 + request.along.size()), .what = "rows"};
}

BasinsStudy basins(const Family& family, const BasinsRequest& request, const BasinsOptions& options,
                   const RunOptions& run) {
  check(family, request);
  BasinsStudy study{.grid = {.x = request.over[0].values, .y = request.over[1].values}};
  const StartCoordinate across = coordinate_of(family, request.over[0].key),
                        up = coordinate_of(family, request.over[1].key);
  const auto basins_of = [&](const dynamics::HybridSystem& system, const std::string& part, std::size_t planes_before) {
    const auto start = [&, begin = scene::initial_state(family.scene(), system)](double x, double y) {
      dynamics::State state = begin;
      across.set(state, x);
      up.set(state, y);
      return state;
    };
    orbits::BasinSink sink;
    if (options.journal != nullptr) sink = results::basin_sink(*options.journal, part);
    sink.first_piece = planes_before * study.grid.y.size();
    return orbits::basins(orbits::BasinFinder(system, options_of(family, options)), start, study.grid,
                          run.parallel(part), sink);
  };
  study.basins = basins_of(family.own(), "basins", 0);
  if (!study.basins.rows.empty()) study.measures = diagnostics::basin_measures(study.basins);
  study.interrupted = study.basins.interrupted;
  for (std::size_t k = 0; k < request.along.size() && !study.interrupted; ++k) {
    orbits::Basins here = basins_of(family.at({request.along[k]}), fmt::format("basins_along_{}", k), k + 1);
    study.interrupted = here.interrupted;
    if (study.interrupted) break;
    if (here.rows.empty()) continue;  // left to others
    study.along.push_back({.value = request.along[k], .attractors = {}, .shares = diagnostics::basin_shares(here)});
    study.along.back().attractors = std::move(here.attractors);
  }
  return study;
}

void store(results::StoreWriter& writer, const Family& family, const BasinsRequest& request, const BasinsStudy& study) {
  const auto axis = [&](const std::string& key) { return results::sweep_axis(family.scene(), key); };
  results::store_basins(writer, axis(request.over[0].key), axis(request.over[1].key), study.grid, study.basins,
                        study.measures, family.keys().empty() ? results::SweepAxis() : family.axis(), study.along,
                        results::Units::of(family.scene().units));
}

}  // namespace slipmode::studies
