#include <slipmode/diagnostics/attractors/ensemble_run.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

/// One member: fills `member` and returns its snapshots.
Eigen::MatrixXd run_member(const Model& model, const dynamics::State& start, const EnsembleOptions& options,
                           EnsembleMember& member) {
  try {
    const dynamics::HybridSystem system = model.system(member.parameter);
    dynamics::Trajectory run = dynamics::simulate(system, dynamics::handed_on(system, start),
                                                  {.duration = options.duration,
                                                   .transient = options.transient,
                                                   .sample = options.sample,
                                                   .keep_events = false,
                                                   .flow = options.flow});
    member.columns = run.q.cols();
    member.audit = run.audit;
    member.statistics = std::move(run.statistics);
    member.final_state = std::move(run.final_state);
    return std::move(run.q);
  } catch (const NumericalFailure& failure) {
    member.failure = failure.what();
    return {};
  }
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
  EnsembleRun result;
  for (const double parameter : parameters) {
    for (std::size_t s = 0; s < starts.size(); ++s) {
      result.members.push_back({.parameter = parameter, .start = static_cast<Eigen::Index>(s)});
    }
  }
  const auto begin_of = [&](std::size_t part) {
    return result.members.begin() + static_cast<std::ptrdiff_t>(result.members.size() * part / options.parts);
  };
  result.members = std::vector<EnsembleMember>(begin_of(options.part - 1), begin_of(options.part));
  std::vector<Eigen::MatrixXd> snapshots(result.members.size());
  rethrow_first(parallel_for(snapshots.size(), options.parallel, [&](std::size_t i) {
    EnsembleMember& member = result.members[i];
    snapshots[i] = run_member(model, starts[static_cast<std::size_t>(member.start)], options, member);
  }));

  Eigen::Index columns = 0;
  for (const EnsembleMember& member : result.members) columns += member.columns;
  if (columns == 0 && options.parts == 1) fail_all(result.members.front().failure);
  Eigen::MatrixXd& all = result.ensemble.snapshots;
  Eigen::Index begin = 0;
  for (Eigen::MatrixXd& part : snapshots) {
    if (part.cols() == 0) continue;
    if (all.size() == 0) all.resize(part.rows(), columns);
    all.middleCols(begin, part.cols()) = part;
    result.ensemble.run_begin.push_back(begin);
    begin += part.cols();
    part.resize(0, 0);
  }
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
