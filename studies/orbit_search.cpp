#include <slipmode/studies/orbit_search.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/orbits/branches/continuation.hpp>
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

namespace slipmode::studies {
namespace {

using orbits::SpecialKind;

/// The order that a period stands for under a periodic drive.
int order_of(double period, double drive) {
  constexpr double kClose = 1e-9;  // relative: what a period given with ten digits may miss
  const double ratio = period / drive;
  const double nearest = std::max(1.0, std::round(ratio));
  if (std::abs(ratio - nearest) <= kClose * nearest) return static_cast<int>(nearest);
  throw InvalidInput(fmt::format(
      "--period {:.12g}: no multiple of the drive's {:.12g} (it is {:.6g} of them); valid: {:.12g}, or --order {}",
      period, drive, ratio, nearest * drive, static_cast<int>(nearest)));
}

/// Under a periodic drive the guess settles for whole periods.
dynamics::State settled(const OrbitSearch& search, const Family& model, double drive) {
  const double periods = search.settle > 0.0 ? search.settle : model.scene().time.transient / drive;
  return orbits::settle_guess(model.own(), model.start(), std::round(periods));
}

SearchStart self_excited(const OrbitSearch& search, const Family& model, orbits::ShootingOptions options) {
  if (search.order != 1) {
    throw InvalidInput(
        fmt::format("--order {}: counts periods of the drive, and this drive has none; valid: --period", search.order));
  }
  options.period = search.period;
  if (search.guess || !search.settles) {
    if (search.period <= 0.0) {
      throw InvalidInput(fmt::format("--start {}: the drive has no period, so --period is needed with it",
                                     search.guess ? "q1,...,vn" : "initial"));
    }
    return {search.guess ? model.own_state(*search.guess) : model.start(), options};
  }
  const scene::TimeSpec& time = model.scene().time;
  const double transient = search.settle > 0.0 ? search.settle : time.transient;
  const orbits::RecurrenceGuess guess =
      orbits::recurrence_guess(model.own(), model.start(), transient, time.duration - time.transient);
  if (options.period <= 0.0) options.period = guess.period;
  return {guess.state, options};
}

/// The branch that leaves at a special point, of two mirror images one.
results::NamedBranch switched(const dynamics::SystemFamily& family, const orbits::SpecialPoint& special,
                              orbits::ContinuationOptions options) {
  results::NamedBranch side{
      .title = fmt::format("from {} at {:.8g}", orbits::to_string(special.kind), special.parameter), .branch = {}};
  try {
    const orbits::BranchPoint first = orbits::switch_branch(family, special, options).front();
    options.direction = first.parameter >= special.parameter ? 1 : -1;
    options.both_ways = false;
    options.shooting.half_period = false;
    if (special.kind == SpecialKind::kPeriodDoubling) {
      options.shooting.order *= 2;
      options.shooting.period *= 2.0;
    }
    side.branch = orbits::continue_orbit(family, first.orbit, first.parameter, options);
  } catch (const NumericalFailure& failure) {
    side.branch.end = orbits::BranchEnd::kLost;
    side.branch.reason = failure.what();
  } catch (const Interrupted&) {
    side.branch.end = orbits::BranchEnd::kInterrupted;
    side.branch.reason = "interrupted before it was begun";
  }
  return side;
}

/// A branch between two special points is followed from the first of them.
bool was_reached(const orbits::SpecialPoint& point, const std::vector<results::NamedBranch>& branches, double range) {
  constexpr double kSame = 1e-6;
  return std::any_of(branches.begin() + 1, branches.end(), [&](const results::NamedBranch& side) {
    if (side.branch.end != orbits::BranchEnd::kMerged || side.branch.special.empty()) return false;
    const orbits::SpecialPoint& last = side.branch.special.back();
    return last.kind == point.kind && std::abs(last.parameter - point.parameter) <= kSame * range;
  });
}

std::vector<results::NamedBranch> follow(const dynamics::SystemFamily& family, const orbits::PeriodicOrbit& orbit,
                                         double start, const orbits::ContinuationOptions& options, bool switches) {
  std::vector<results::NamedBranch> branches = {
      {.title = "main branch", .branch = orbits::continue_orbit(family, orbit, start, options)}};
  if (!switches) return branches;
  const std::vector<orbits::SpecialPoint> special = branches.front().branch.special;
  for (const orbits::SpecialPoint& point : special) {
    if (point.kind != SpecialKind::kSymmetryBreaking && point.kind != SpecialKind::kPeriodDoubling) continue;
    if (point.orbit.crossings == 0) continue;  // in one regime: a floating structure's shift, which breaks nothing
    if (is_interrupted(branches)) break;
    if (was_reached(point, branches, std::abs(options.to - options.from))) continue;
    branches.push_back(switched(family, point, options));
  }
  return branches;
}

}  // namespace

orbits::ShootingOptions shooting_options(const Family& model, const OrbitSearch& search) {
  orbits::ShootingOptions options{.order = search.order,
                                  .segments = search.segments,
                                  .tolerance = search.tolerance,
                                  .max_iterations = search.iterations,
                                  .half_period = search.half};
  options.flow.method = model.scene().flow.method;
  return options;
}

SearchStart search_start(const Family& model, const OrbitSearch& search) {
  orbits::ShootingOptions options = shooting_options(model, search);
  const std::optional<double> drive = model.own().drive().period();
  if (!drive) return self_excited(search, model, options);
  if (search.period > 0.0) {
    const int order = order_of(search.period, *drive);
    if (search.order != 1 && search.order != order) {
      throw InvalidInput(
          fmt::format("--order {}: --period {} is order {}; give one of them", search.order, search.period, order));
    }
    options.order = order;
  }
  if (search.guess) return {model.own_state(*search.guess), options};
  if (!search.settles) return {model.start(), options};
  return {settled(search, model, *drive), options};
}

orbits::ShootingResult find_orbit(const Family& model, const OrbitSearch& search) {
  const SearchStart start = search_start(model, search);
  return orbits::shoot(model.own(), start.guess, start.options);
}

KeyFamily family_over(const scene::Scene& scene, const std::string& key, const std::optional<pod::NamedBasis>& basis,
                      const ContinuationRequest& request, const RunOptions& run) {
  const double own = scene::get_continuous_key(scene, key);
  const auto [low, high] = std::minmax(request.from, request.to);
  const double start = low <= own && own <= high ? own : request.from;
  const Family family(start == own ? scene : scene::set_key(scene, key, start), {key}, basis);
  for (const double end : {request.from, request.to}) {
    (void)scene::set_key(scene, key, end);
    (void)family.at({end});
  }
  return {.start = start,
          .family = family,
          .systems =
              [family, run](double value) {
                run.check_interrupt();
                return family.at({value});
              },
          .options = {.from = request.from,
                      .to = request.to,
                      .direction = (request.to > request.from) == (start != request.to) ? 1 : -1,
                      .both_ways = start != request.from && start != request.to,
                      .step = request.step,
                      .max_step = request.max_step,
                      .max_points = request.max_points,
                      .arclength = !request.sequential}};
}

std::string command_of(const std::string& key, const std::string& model, const OrbitSearch& search,
                       const ContinuationRequest& request) {
  std::string start = search.settles ? "" : " --start initial";
  if (search.guess)
    start = fmt::format(" --start {},{}", fmt::join(search.guess->q, ","), fmt::join(search.guess->v, ","));
  return fmt::format("slipmode orbit continue --over {}={}:{}{}{}{}{}", key, request.from, request.to,
                     model_option(model), options_text(search), start, options_text(request));
}

Continuation continue_orbit(const scene::Scene& scene, const std::string& key,
                            const std::optional<pod::NamedBasis>& basis, const OrbitSearch& search,
                            const ContinuationRequest& request, const RunOptions& run) {
  KeyFamily over = family_over(scene, key, basis, request, run);
  const SearchStart start = search_start(over.family, search);
  Continuation out{.found = orbits::shoot(over.systems(over.start), start.guess, start.options),
                   .start = over.start,
                   .branches = {}};
  if (!out.found.converged()) return out;
  over.options.shooting = start.options;
  out.branches = follow(over.systems, out.found.orbit, out.start, over.options, request.switches);
  return out;
}

bool is_interrupted(const std::vector<results::NamedBranch>& branches) {
  return std::ranges::any_of(
      branches, [](const results::NamedBranch& one) { return one.branch.end == orbits::BranchEnd::kInterrupted; });
}

void store(results::StoreWriter& writer, const Family& model, const orbits::PeriodicOrbit* orbit) {
  results::Provenance provenance = results::provenance_of(model.scene(), "slipmode orbit find");
  if (orbit != nullptr) {
    constexpr double kSamples = 1000.0;
    const dynamics::Trajectory period = dynamics::simulate(
        model.own(), orbit->start,
        {.duration = orbit->period, .sample = orbit->period / kSamples, .flow = {.tolerance = 1e-12}});
    provenance.audit = period.audit;
    results::save(writer, results::kOrbitGroup, *orbit);
    results::save(writer, results::kTrajectoryGroup, period);
  }
  results::save(writer, provenance);
}

results::Content content_of(const Family& model, std::shared_ptr<const orbits::PeriodicOrbit> orbit) {
  return {
      .kind = results::FileKind::kOrbit,
      .unit_system = model.scene().units,
      .write = [model, orbit = std::move(orbit)](results::StoreWriter& writer) { store(writer, model, orbit.get()); }};
}

results::Content content_of(const Family& model, double start,
                            std::shared_ptr<const std::vector<results::NamedBranch>> branches,
                            const std::string& command, const RunOptions& run) {
  const std::string key = model.keys().front();
  return {.kind = results::FileKind::kBranches,
          .unit_system = model.scene().units,
          .write = [model, key, run, branches = std::move(branches),
                    provenance = results::provenance_of(scene::set_key(model.scene(), key, start), command)](
                       results::StoreWriter& writer) {
            results::save(writer, provenance);
            results::store_branches(writer, key, *branches, [&model, &run](double value) {
              run.check_interrupt();
              return model.at({value});
            });
          }};
}

}  // namespace slipmode::studies
