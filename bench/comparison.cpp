#include "bench/comparison.hpp"

#include <slipmode/core/errors.hpp>
#include "bench/chain_system.hpp"
#include "bench/clock.hpp"
#include "bench/methods.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace slipmode::bench {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

constexpr double kPeerTolerance = 1e-9;
constexpr double kTanhTolerance = 1e-7;
constexpr double kTanhStretch = 20.0;

/// The loosest tolerance at which every event is found and no error is larger than a peer's.
MethodFigures tolerable(const HybridSystem& system, const std::vector<Truth>& truth, double stretch,
                        const MethodFigures& a, const MethodFigures& b) {
  const double allowed = std::min(a.error, b.error), allowed_worst = std::min(a.worst_error, b.worst_error);
  for (const double tolerance :
       {1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 1e-12, 1e-13}) {
    MethodFigures figures;
    try {
      figures = errors_of(slipmode_method(system, tolerance, Checks::kAudit), truth, stretch);
    } catch (const NumericalFailure&) {
      continue;  // too loose to be of use
    }
    figures.tolerance = tolerance;
    const bool accurate = figures.error <= allowed && figures.worst_error <= allowed_worst;
    if (accurate && std::isfinite(figures.event_time_error)) return figures;
  }
  throw std::runtime_error("no tolerance makes slipmode as accurate as its peers");
}

/// First short run on a new system less a second one: whatever is built once.
double setup_seconds(const ChainProblem& problem, double tolerance, dynamics::SimulateOptions::Output output) {
  constexpr double kShortRun = 100.0;
  std::vector<double> times;
  for (int i = 0; i < 3; ++i) {
    const double begin = thread_seconds();
    const HybridSystem system = system_of(problem);
    const auto run = [&] {
      (void)dynamics::simulate(system, system.rest(),
                               {.duration = kShortRun, .output = output, .flow = {.tolerance = tolerance}});
    };
    run();
    const double first = thread_seconds() - begin;
    times.push_back(std::max(0.0, first - thread_seconds_of(run)));
  }
  return median(times);
}

/// A method run over and over: seconds per unit of simulated time.
class Stopwatch {
 public:
  void run(const Method& method, const State& start, double duration) {
    const double begin = thread_seconds();
    const PeerRun run = method(start, duration);
    seconds_.push_back((thread_seconds() - begin) / duration);
    events_per_unit_ = static_cast<double>(run.event_times.size()) / duration;
  }
  void report(MethodFigures& out) const {
    out.seconds = median(seconds_);
    out.events_per_unit = events_per_unit_;
  }
  [[nodiscard]] double seconds() const { return median(seconds_); }

 private:
  std::vector<double> seconds_;
  double events_per_unit_ = 0.0;
};

/// Timed runs by turns, so that a slow spell of the machine meets all of them.
void time_all(Comparison& row, const HybridSystem& system, const State& start) {
  const ComparisonCase& setting = row.setting;
  const double tolerance = row.slipmode.tolerance;
  const Method own = slipmode_method(system, tolerance, Checks::kAudit);
  const Method plain = slipmode_method(system, tolerance, Checks::kNone);
  const Method certified = slipmode_method(system, tolerance, Checks::kCertified);
  Stopwatch slipmode, without_audit, with_proof, cvode, odeint;
  row.audit_residual =  // and builds what is built once
      dynamics::simulate(system, start, {.duration = setting.duration, .flow = {.tolerance = tolerance}})
          .audit.residual();
  (void)plain(start, setting.duration);
  (void)certified(start, setting.duration);
  for (int i = 0; i < setting.repeats; ++i) {
    slipmode.run(own, start, setting.duration);
    without_audit.run(plain, start, setting.duration);
    with_proof.run(certified, start, setting.duration);
    if (i % 3 != 0) continue;
    cvode.run(cvode_method(setting.problem, kPeerTolerance, kPeerTolerance), start, setting.peer_duration);
    odeint.run(odeint_method(setting.problem, kPeerTolerance, kPeerTolerance), start, setting.peer_duration);
  }
  slipmode.report(row.slipmode);
  cvode.report(row.cvode);
  odeint.report(row.odeint);
  row.plain_seconds = without_audit.seconds();
  row.certified_seconds = with_proof.seconds();
}

nlohmann::json figures(const MethodFigures& m) {
  const bool agree = std::isfinite(m.event_time_error);
  return {{"tolerance", m.tolerance},
          {"seconds_per_unit", m.seconds},
          {"state_error_median", m.error},
          {"state_error_worst", m.worst_error},
          {"event_time_error", agree ? nlohmann::json(m.event_time_error) : nlohmann::json()},
          {"events", m.events},
          {"events_per_unit", m.events_per_unit}};
}

}  // namespace

Comparison compare(const ComparisonCase& setting) {
  Comparison row;
  row.setting = setting;
  const HybridSystem system = system_of(setting.problem);
  const State start = start_on_attractor(system, setting.transient);
  const std::vector<Truth> truth = true_stretches(system, start, setting.stretch, setting.stretches);
  for (const Truth& t : truth) row.reference_events += static_cast<long>(t.end.event_times.size());

  row.cvode = errors_of(cvode_method(setting.problem, kPeerTolerance, kPeerTolerance), truth, setting.stretch);
  row.odeint = errors_of(odeint_method(setting.problem, kPeerTolerance, kPeerTolerance), truth, setting.stretch);
  row.cvode.tolerance = row.odeint.tolerance = kPeerTolerance;
  row.slipmode = tolerable(system, truth, setting.stretch, row.cvode, row.odeint);

  using Output = dynamics::SimulateOptions::Output;
  row.setup_rows_seconds = setup_seconds(setting.problem, row.slipmode.tolerance, Output::kContacts);
  row.setup_shapes_seconds = setup_seconds(setting.problem, row.slipmode.tolerance, Output::kAllDofs);
  time_all(row, system, start);
  return row;
}

TanhFigures measure_tanh(const Comparison& exact, double epsilon) {
  const ComparisonCase& setting = exact.setting;
  const HybridSystem system = system_of(setting.problem);
  const State start = start_on_attractor(system, setting.transient);
  const Method method = tanh_method(setting.problem, epsilon, kTanhTolerance, 1e-2 * kTanhTolerance);
  TanhFigures row{.setting = setting, .epsilon = epsilon, .tolerance = kTanhTolerance, .stretch = kTanhStretch};
  const auto truth = true_stretches(system, start, kTanhStretch, setting.stretches);
  row.error = errors_of(method, truth, kTanhStretch).error;
  Stopwatch watch;
  for (int i = 0; i < setting.repeats; i += 3) watch.run(method, start, setting.peer_duration);
  row.seconds = watch.seconds();
  row.slipmode_seconds = exact.slipmode.seconds;
  row.cvode_seconds = exact.cvode.seconds;
  return row;
}

void to_json(nlohmann::json& out, const Comparison& row) {
  out = {{"case", row.setting.problem.name},
         {"masses", row.setting.problem.n},
         {"belt_speed", row.setting.problem.belt},
         {"duration", row.setting.duration},
         {"peer_duration", row.setting.peer_duration},
         {"stretch", row.setting.stretch},
         {"stretches", row.setting.stretches},
         {"reference_events", row.reference_events},
         {"slipmode", figures(row.slipmode)},
         {"cvode_adams", figures(row.cvode)},
         {"odeint_dopri5", figures(row.odeint)},
         {"ratio_cvode", row.ratio_cvode()},
         {"ratio_odeint", row.ratio_odeint()},
         {"wanted_cvode", row.setting.wanted_cvode},
         {"wanted_odeint", row.setting.wanted_odeint},
         {"audit_off_seconds_per_unit", row.plain_seconds},
         {"certified_seconds_per_unit", row.certified_seconds},
         {"audit_residual", row.audit_residual},
         {"setup_rows_seconds", row.setup_rows_seconds},
         {"setup_shapes_seconds", row.setup_shapes_seconds}};
}

void to_json(nlohmann::json& out, const TanhFigures& row) {
  out = {{"case", row.setting.problem.name},
         {"epsilon", row.epsilon},
         {"tolerance", row.tolerance},
         {"seconds_per_unit", row.seconds},
         {"stretch", row.stretch},
         {"state_error_median", row.error},
         {"ratio_slipmode", row.seconds / row.slipmode_seconds},
         {"ratio_cvode", row.seconds / row.cvode_seconds}};
}

}  // namespace slipmode::bench
