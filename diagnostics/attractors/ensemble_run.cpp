#include <slipmode/diagnostics/attractors/ensemble_run.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace slipmode::diagnostics {

namespace {

void check(const std::vector<double>& parameters, const std::vector<dynamics::State>& starts,
           const EnsembleOptions& options) {
  if (parameters.empty() || starts.empty()) {
    throw InvalidInput(
        fmt::format("ensemble: expected at least one parameter value and one initial state, found {} "
                    "and {}",
                    parameters.size(), starts.size()));
  }
  if (!(options.sample > 0.0) || !(options.transient >= 0.0) || !(options.transient < options.duration)) {
    throw InvalidInput(fmt::format("ensemble: expected sample > 0 and 0 <= transient < duration, found {}, {}, {}",
                                   options.sample, options.transient, options.duration));
  }
  if (options.part < 1 || options.part > options.parts)
    throw InvalidInput(fmt::format("ensemble: expected part 1 to {}, found {}", options.parts, options.part));
}

MemberRun run_member(const Model& model, double parameter, const dynamics::State& start,
                     const EnsembleOptions& options) {
  const dynamics::HybridSystem system = model.system(parameter);
  dynamics::Trajectory run = dynamics::simulate(system, dynamics::handed_on(system, start),
                                                {.duration = options.duration,
                                                 .transient = options.transient,
                                                 .sample = options.sample,
                                                 .keep_events = false,
                                                 .flow = options.flow});
  return {.snapshots = std::move(run.q), .audit = run.audit, .statistics = std::move(run.statistics)};
}

/// The members of a result, and their snapshots side by side.
EnsembleRun joined(std::vector<SweptValue<MemberRun>> runs, std::size_t starts) {
  EnsembleRun result;
  Eigen::Index columns = 0, rows = 0;
  for (const auto& run : runs) {
    columns += run.settled.snapshots.cols();
    rows = std::max(rows, run.settled.snapshots.rows());
  }
  result.ensemble.snapshots.resize(columns > 0 ? rows : 0, columns);
  Eigen::Index begin = 0;
  for (auto& run : runs) {
    Eigen::MatrixXd snapshots = std::move(run.settled.snapshots);
    result.members.push_back({.parameter = run.parameter,
                              .start = static_cast<Eigen::Index>(run.index % starts),
                              .columns = snapshots.cols(),
                              .audit = run.settled.audit,
                              .statistics = std::move(run.settled.statistics),
                              .failure = std::move(run.failure)});
    if (snapshots.cols() == 0) continue;
    result.ensemble.snapshots.middleCols(begin, snapshots.cols()) = snapshots;
    result.ensemble.run_begin.push_back(begin);
    begin += snapshots.cols();
  }
  return result;
}

}  // namespace

void fail_all(const std::string& first) {
  throw NumericalFailure("ensemble: every member failed; the first with: " + first, std::nan(""), {}, std::nan(""));
}

std::vector<dynamics::State> random_states(const dynamics::HybridSystem& system, const RandomStateOptions& options) {
  if (options.count < 1 || !(options.spread >= 0.0) || !std::isfinite(options.spread)) {
    throw InvalidInput(fmt::format("initial states: expected count >= 1 and a finite spread >= 0, found {} and {}",
                                   options.count, options.spread));
  }
  const bool about_rest = options.centre == RandomStateOptions::Centre::kRest;
  const dynamics::State centre = about_rest ? system.rest() : sliding_equilibrium(system);
  std::vector<dynamics::State> states(static_cast<std::size_t>(options.count), centre);
  for (std::size_t k = 0; k < states.size(); ++k) {
    Random random = Random::stream(options.seed, k);
    for (double& x : states[k].q) x += options.spread * random.normal();
    for (double& x : states[k].v) x += options.spread * random.normal();
  }
  return states;
}

EnsembleRun run_ensemble(const Model& model, const std::vector<double>& parameters,
                         const std::vector<dynamics::State>& starts, const EnsembleOptions& options) {
  check(parameters, starts, options);
  const std::size_t all = parameters.size() * starts.size();
  const std::size_t first = all * (options.part - 1) / options.parts, end = all * options.part / options.parts;
  std::vector<double> values;  // by member
  for (std::size_t i = first; i < end; ++i) values.push_back(parameters[i / starts.size()]);
  if (values.empty()) return {};
  const auto run = [&](std::size_t i, int, std::monostate) {
    return run_member(model, values[i], starts[(first + i) % starts.size()], options);
  };
  auto found = SweepRunner<MemberRun, std::monostate>({.settle = run, .carry = {}, .leader = options.model}, values, {},
                                                      SweepMode::kIndependent, 1, options.parallel, options.sink)
                   .run_alone();
  if (found.interrupted) throw Interrupted();
  for (auto& point : found.points) point.index += first;
  EnsembleRun result = joined(std::move(found.points), starts.size());
  const bool all_failed = result.members.size() == all && result.ensemble.snapshots.cols() == 0;
  if (all_failed && options.sink.sharing.leads) fail_all(result.members.front().failure);
  return result;
}

const EnsembleMember* EnsembleRun::worst() const {
  const EnsembleMember* worst = nullptr;
  for (const EnsembleMember& member : members) {
    if (!member.failure.empty()) continue;
    if (worst == nullptr || std::abs(member.audit.residual()) > std::abs(worst->audit.residual())) worst = &member;
  }
  return worst;
}

double EnsembleRun::worst_audit() const {
  const EnsembleMember* member = worst();
  return member == nullptr ? 0.0 : std::abs(member->audit.residual());
}

dynamics::FlowStatistics EnsembleRun::total() const {
  dynamics::FlowStatistics sum;
  for (const EnsembleMember& member : members) {
    if (!member.failure.empty()) continue;
    sum.steps += member.statistics.steps;
    sum.rejected += member.statistics.rejected;
    sum.certified += member.statistics.certified;
    sum.events += member.statistics.events;
  }
  return sum;
}

}  // namespace slipmode::diagnostics
