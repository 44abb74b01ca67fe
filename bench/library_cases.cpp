#include "bench/library_cases.hpp"

#include <slipmode/diagnostics/attractors/sweep.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/pod/pod.hpp>
#include "bench/chain_system.hpp"
#include "bench/clock.hpp"
#include "bench/machine.hpp"
#include "pod/internal/accumulator.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

namespace slipmode::bench {
namespace {

/// Of the Stribeck sweep on two threads [s], with kernels of eight doubles.
constexpr double kWantedSweep = 0.2;

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
    state_ = run.final_state;
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
  options.settle = {
      .transient = 1000.0, .block = 4000.0, .limit = 4000.0, .energy_samples = 0, .flow = {.tolerance = 1e-7}};
  std::int64_t events = 0;
  (void)dynamics::simulate(system, system.rest(), {.duration = 100.0, .flow = options.settle.flow});
  struct Seconds {
    double wall, cpu;
  };
  const auto measure = [&](int threads, bool audit) {
    options.parallel.threads = threads;
    options.settle.flow.audit = audit;
    std::vector<double> wall, cpu;
    for (int i = 0; i < 3; ++i) {
      const double begin = wall_seconds(), cpu_begin = process_seconds();
      const auto result = diagnostics::sweep(model, speeds, system.rest(), options);
      wall.push_back(wall_seconds() - begin);
      cpu.push_back(process_seconds() - cpu_begin);
      events = 0;
      for (const auto& point : result.points) events += point.settled.events;
    }
    return Seconds{median(wall), median(cpu)};
  };
  const Seconds one = measure(1, true), two = measure(2, true), plain = measure(2, false);
  const std::string wanted = coulomb ? "" : fmt::format(" (wanted {:.2f})", kWantedSweep / wanted_share());
  return {.lines = {fmt::format(
              "{} sweep, {} speeds x 5,000 units, {} events: {:.3f} s on one thread, {:.3f} s on two{} (CPU {:.3f} s), "
              "speed-up {:.2f}; audit off {:.3f} s on two",
              coulomb ? "Coulomb" : "Stribeck", speeds.size(), events, one.wall, two.wall, wanted, two.cpu,
              one.wall / two.wall, plain.wall)},
          .figures = {{"speeds", static_cast<double>(speeds.size())},
                      {"events", static_cast<double>(events)},
                      {"one_thread_seconds", one.wall},
                      {"two_threads_seconds", two.wall},
                      {"one_thread_cpu_seconds", one.cpu},
                      {"two_threads_cpu_seconds", two.cpu},
                      {"two_threads_audit_off_seconds", plain.wall},
                      {"speed_up", one.wall / two.wall}},
          .timed = {{.name = coulomb ? "sweep-coulomb" : "sweep-stribeck",
                     .ms = 1e3 * two.wall,
                     .audit_on_off = two.cpu / plain.cpu}}};
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
       {"matrix_peak_gib", matrix_peak}},
      {{.name = "pod streamed", .ms = 1e3 * stream_seconds}, {.name = "pod matrix", .ms = 1e3 * matrix_seconds}}};
}

}  // namespace slipmode::bench
