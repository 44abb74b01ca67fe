#include "bench/library_cases.hpp"

#include "bench/chain_system.hpp"
#include "bench/clock.hpp"
#include "diagnostics/cost.hpp"
#include "diagnostics/model.hpp"
#include "diagnostics/sweep.hpp"
#include "pod/accumulator.hpp"
#include "pod/pod.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

namespace slipmode::bench {
namespace {

ChainProblem thousand_masses() {
  ChainProblem problem;
  problem.n = 1000;
  problem.ground = 0.25;
  return problem;
}

/// Largest resident size of this process so far [GiB].
double peak_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

/// Snapshots of one long run, block after block.
class SnapshotStream {
 public:
  SnapshotStream(const dynamics::HybridSystem& system, double sample)
      : system_(system), sample_(sample), state_(start_on_attractor(system, 500.0)) {}

  [[nodiscard]] Eigen::MatrixXd next(Eigen::Index count) {
    auto run = dynamics::simulate(system_, state_,
                                  {.duration = sample_ * static_cast<double>(count),
                                   .sample = sample_,
                                   .keep_events = false,
                                   .flow = {.tolerance = 1e-7, .audit = false}});
    state_ = diagnostics::continued(system_, run.final_state);
    return run.q.leftCols(count);
  }

 private:
  const dynamics::HybridSystem& system_;
  double sample_;
  dynamics::State state_;
};

}  // namespace

Row measure_sweep(bool coulomb, bool quick) {
  ChainProblem problem;
  problem.coulomb = coulomb;
  const auto system = system_of(problem);
  const diagnostics::Model model = diagnostics::belt_model(system);
  const auto speeds = diagnostics::sweep_values(0.5, quick ? 0.401 : 0.001, 0.001);
  diagnostics::SweepOptions options;
  options.settle = {.transient = 1000.0,
                    .block = 4000.0,
                    .limit = 4000.0,
                    .energy_samples = 0,
                    .flow = {.tolerance = 1e-7, .audit = false}};
  double seconds[2] = {0.0, 0.0}, cpu[2] = {0.0, 0.0};
  std::int64_t events = 0;
  (void)dynamics::simulate(system, system.rest(), {.duration = 100.0, .flow = options.settle.flow});
  for (const int threads : {1, 2}) {
    options.parallel.threads = threads;
    std::vector<double> repeats, cpu_repeats;
    for (int i = 0; i < 3; ++i) {
      const double begin = wall_seconds(), cpu_begin = process_seconds();
      const auto result = diagnostics::sweep(model, speeds, system.rest(), options);
      repeats.push_back(wall_seconds() - begin);
      cpu_repeats.push_back(process_seconds() - cpu_begin);
      events = 0;
      for (const auto& point : result.points) events += point.settled.events;
    }
    seconds[threads - 1] = median(repeats);
    cpu[threads - 1] = median(cpu_repeats);
  }
  const char* law = coulomb ? "Coulomb" : "Stribeck";
  return {
      {fmt::format("{} sweep, {} speeds x 5,000 units, {} events: {:.3f} s on one thread (CPU {:.3f} s), {:.3f} s on "
                   "two (CPU {:.3f} s), speed-up {:.2f}",
                   law, speeds.size(), events, seconds[0], cpu[0], seconds[1], cpu[1], seconds[0] / seconds[1])},
      {{"speeds", static_cast<double>(speeds.size())},
       {"events", static_cast<double>(events)},
       {"one_thread_seconds", seconds[0]},
       {"two_threads_seconds", seconds[1]},
       {"one_thread_cpu_seconds", cpu[0]},
       {"two_threads_cpu_seconds", cpu[1]},
       {"speed_up", seconds[0] / seconds[1]}}};
}

Row measure_reduction(bool quick) {
  const auto system = system_of(thousand_masses());
  const Eigen::Index snapshots = quick ? 500 : 4000;
  SnapshotStream stream(system, 0.5);
  const double begin = wall_seconds();
  pod::Ensemble ensemble{stream.next(snapshots)};
  const double simulated = wall_seconds();
  const pod::PodResult modes = pod::pod(ensemble, {.choice = {.modes = 6}});
  const double end = wall_seconds();
  const double duration = quick ? 500.0 : 1e4;
  const auto cost = diagnostics::measure_cost(system, modes.basis, start_on_attractor(system, 500.0), duration, 5,
                                              {.tolerance = 1e-7, .audit = false});
  const double share = modes.basis.energy.sum();
  return {{fmt::format("1,000 masses, six POMs ({:.2f} % of the energy): full {:.2f} ms, reduced {:.3f} ms per {:.0f} "
                       "units: {:.0f} times",
                       100.0 * share, 1e3 * cost.full_cpu, 1e3 * cost.reduced_cpu, duration,
                       cost.full_cpu / cost.reduced_cpu),
           fmt::format("  basis: run {:.2f} s, decomposition {:.2f} s; projection {:.3f} s; paid for after {:.0f} runs",
                       simulated - begin, end - simulated, cost.projection_wall, cost.break_even(end - begin))},
          {{"energy_share", share},
           {"duration", duration},
           {"full_cpu_seconds", cost.full_cpu},
           {"reduced_cpu_seconds", cost.reduced_cpu},
           {"ratio", cost.full_cpu / cost.reduced_cpu},
           {"basis_run_seconds", simulated - begin},
           {"basis_decomposition_seconds", end - simulated},
           {"projection_seconds", cost.projection_wall},
           {"break_even_runs", cost.break_even(end - begin)}}};
}

Row measure_pod(bool quick) {
  const auto system = system_of(thousand_masses());
  constexpr Eigen::Index kBlock = 2000;
  const Eigen::Index blocks = quick ? 5 : 50, count = blocks * kBlock;

  SnapshotStream streamed(system, 0.1);
  pod::PodAccumulator accumulator(system.size(), {.choice = {.energy = 0.99}});
  double stream_seconds = 0.0;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::MatrixXd block = streamed.next(kBlock);
    stream_seconds += thread_seconds_of([&] { accumulator.add(block); });
  }
  Eigen::Index modes = 0;
  stream_seconds += thread_seconds_of([&] { modes = accumulator.finish().basis.modes(); });
  const double stream_peak = peak_gib();

  pod::Ensemble ensemble{Eigen::MatrixXd(system.size(), count)};
  SnapshotStream kept(system, 0.1);
  for (Eigen::Index b = 0; b < blocks; ++b) ensemble.snapshots.middleCols(b * kBlock, kBlock) = kept.next(kBlock);
  const double matrix_seconds = thread_seconds_of(
      [&] { (void)pod::pod(ensemble, {.choice = {.energy = 0.99}, .method = pod::PodMethod::kQrSvd}); });
  const double matrix_peak = peak_gib();
  return {
      {fmt::format("POD of {} snapshots x 1,000 masses ({} modes for 99 %): streamed {:.1f} s, peak {:.2f} GiB; from "
                   "one matrix {:.1f} s, peak {:.2f} GiB",
                   count, modes, stream_seconds, stream_peak, matrix_seconds, matrix_peak)},
      {{"snapshots", static_cast<double>(count)},
       {"modes", static_cast<double>(modes)},
       {"stream_cpu_seconds", stream_seconds},
       {"stream_peak_gib", stream_peak},
       {"matrix_cpu_seconds", matrix_seconds},
       {"matrix_peak_gib", matrix_peak}}};
}

}  // namespace slipmode::bench
