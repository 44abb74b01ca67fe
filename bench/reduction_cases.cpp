#include "bench/reduction_cases.hpp"

#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "bench/chain_system.hpp"
#include "bench/clock.hpp"

#include <fmt/format.h>
#include <string>
#include <vector>

namespace slipmode::bench {
namespace {

constexpr int kModes = 6;
constexpr double kTolerance = 1e-7;
/// Beyond this the shapes for snapshots of the full motion cost gigabytes. A static mode with natural ones costs
/// nothing, and unlike natural modes alone it lets the last mass slip.
constexpr int kLargestWithPoms = 1000;
constexpr double kPerRun = 1e4;  ///< units of time all costs refer to

struct BasisCost {
  pod::Basis basis;
  double seconds = 0.0;  ///< run and decomposition; the run's share is most of it
};

BasisCost basis_of(const dynamics::HybridSystem& system, bool poms) {
  BasisCost out;
  out.seconds = thread_seconds_of([&] {
    if (!poms) {
      out.basis = rom::lnm_static_basis(system, kModes - 1);
      return;
    }
    constexpr double kTransient = 200.0, kSampled = 1000.0, kApart = 0.5;
    const auto run = dynamics::simulate(system, system.rest(),
                                        {.duration = kTransient + kSampled,
                                         .transient = kTransient,
                                         .sample = kApart,
                                         .keep_events = false,
                                         .flow = {.tolerance = kTolerance, .audit = false}});
    out.basis = pod::pod(pod::Ensemble{run.q}, {.choice = {.modes = kModes}}).basis;
  });
  return out;
}

/// A model run over and over from rest.
struct Runs {
  const dynamics::HybridSystem& system;
  double duration;
  std::vector<double> times = {};
  dynamics::FlowStatistics statistics = {};

  void run() {
    times.push_back(thread_seconds_of([&] {
      statistics = dynamics::simulate(system, system.rest(),
                                      {.duration = duration,
                                       .keep_events = false,
                                       .output = dynamics::SimulateOptions::Output::kContacts,
                                       .flow = {.tolerance = kTolerance}})
                       .statistics;
    }));
  }
  [[nodiscard]] double seconds() const { return median(times); }
  [[nodiscard]] double ms() const { return 1e3 * seconds() * kPerRun / duration; }
  [[nodiscard]] double events() const { return static_cast<double>(statistics.events) / duration; }
  [[nodiscard]] double step_us() const { return 1e6 * seconds() / static_cast<double>(statistics.steps); }
  [[nodiscard]] double steps() const { return static_cast<double>(statistics.steps) / duration; }
};

void add_row(int n, bool quick, Row& out) {
  ChainProblem problem;
  problem.n = n;
  if (n >= 30) problem.ground = 0.25;
  const dynamics::HybridSystem full = system_of(problem);
  const BasisCost cost = basis_of(full, n <= kLargestWithPoms);
  const dynamics::HybridSystem reduced = rom::reduce(full, cost.basis);

  const double duration = (quick ? 0.1 : 1.0) * (n >= 1000 ? 0.1 : 1.0) * kPerRun;
  Runs of_full{full, duration}, of_reduced{reduced, duration};
  of_full.run();  // builds what is built once
  of_reduced.run();
  of_full.times.clear();
  of_reduced.times.clear();
  for (int k = 0; k < (n >= 1000 ? 3 : 5); ++k) {
    of_full.run();
    of_reduced.run();
  }

  const double ratio = of_full.ms() / of_reduced.ms(), saved = 1e-3 * (of_full.ms() - of_reduced.ms());
  const char* kind = cost.basis.kind == pod::BasisKind::kPom ? "POM" : "static";
  const std::string share = cost.basis.energy.size() > 0 ? fmt::format("{:.1f}", 100.0 * cost.basis.energy.sum()) : "-";
  out.lines.push_back(fmt::format(
      "{:>6} {:>6} {:>6} {:>10.2f} {:>10.2f} {:>7.2f} {:>8.3f} {:>8.3f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>9.2f} "
      "{:>9}",
      n, kind, share, of_full.ms(), of_reduced.ms(), ratio, of_full.events(), of_reduced.events(), of_full.steps(),
      of_reduced.steps(), of_full.step_us(), of_reduced.step_us(), cost.seconds,
      saved > 0.0 ? fmt::format("{:.1f}", cost.seconds / saved) : "never"));
  const std::string name = fmt::format("{}_masses_", n);
  out.figures.insert(out.figures.end(), {{name + "full_ms", of_full.ms()},
                                         {name + "reduced_ms", of_reduced.ms()},
                                         {name + "ratio", ratio},
                                         {name + "full_events_per_unit", of_full.events()},
                                         {name + "reduced_events_per_unit", of_reduced.events()},
                                         {name + "full_steps_per_unit", of_full.steps()},
                                         {name + "reduced_steps_per_unit", of_reduced.steps()},
                                         {name + "basis_seconds", cost.seconds}});
  out.timed.push_back({.name = fmt::format("reduction-{} full", n), .ms = of_full.ms()});
  out.timed.push_back({.name = fmt::format("reduction-{} reduced", n), .ms = of_reduced.ms()});
}

}  // namespace

Row measure_reduction(bool quick) {
  Row out;
  out.lines = {
      fmt::format("{:>6} {:>6} {:>6} {:>10} {:>10} {:>7} {:>17} {:>17} {:>17} {:>9} {:>9}", "six", "", "energy", "full",
                  "reduced", "", "events/unit", "steps/unit", "us/step", "basis", "paid for"),
      fmt::format("{:>6} {:>6} {:>6} {:>10} {:>10} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}", "of",
                  "modes", "%", "ms/1e4", "ms/1e4", "ratio", "full", "reduced", "full", "reduced", "full", "reduced",
                  "s", "after")};
  const std::vector<int> sizes = quick ? std::vector{10, 30, 100, 300} : std::vector{10, 30, 100, 300, 1000, 3000};
  for (const int n : sizes) add_row(n, quick, out);
  return out;
}

}  // namespace slipmode::bench
