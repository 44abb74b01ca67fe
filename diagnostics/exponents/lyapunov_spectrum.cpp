#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/model.hpp>
#include "diagnostics/exponents/internal/spectrum_statistics.hpp"
#include "diagnostics/exponents/internal/tangent_frame.hpp"
#include "diagnostics/exponents/internal/tangent_walk.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace slipmode::diagnostics {
namespace {

/// A run that fails before so many intervals has nothing to give.
constexpr Eigen::Index kLeastIntervals = 16;

void check(const TangentOptions& options, Eigen::Index size) {
  const bool times = options.transient >= 0.0 && std::isfinite(options.transient) && options.interval > 0.0 &&
                     options.duration >= options.interval && std::isfinite(options.duration) &&
                     options.alignment >= 0.0 && std::isfinite(options.alignment);
  if (!times) {
    throw InvalidInput(
        fmt::format("exponents: expected transient >= 0, interval > 0, duration >= interval and alignment >= 0, found "
                    "{}, {}, {}, {}",
                    options.transient, options.interval, options.duration, options.alignment));
  }
  if (options.exponents < 0 || options.exponents > size) {
    throw InvalidInput(
        fmt::format("exponents: expected 1 to {} of them, or 0 for all, found {}", size, options.exponents));
  }
}

/// A belt whose speed changes has no long-term motion.
void require_steady(const friction::Drive& drive, double time) {
  if (!drive.next_corner(time) && (drive.belt() == nullptr || drive.belt()->acceleration(time) == 0.0)) return;
  throw InvalidInput(
      fmt::format("exponents: expected a belt of constant speed, found one that still changes at time {:g}, after the "
                  "transient; give a longer transient",
                  time));
}

dynamics::State after_transient(const dynamics::HybridSystem& system, const dynamics::State& start,
                                const TangentOptions& options) {
  const dynamics::State begin = system.drive().period() ? start : dynamics::handed_on(system, start);
  if (options.transient == 0.0) return begin;
  dynamics::FlowOptions flow = options.flow;
  flow.audit = false;
  const dynamics::SimulateOptions run{.duration = options.transient, .keep_events = false, .flow = flow};
  return dynamics::simulate(system, begin, run).final_state;
}

void poll(const StopFlag* stop) {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Interrupted();
}

/// Sums over the time measured to means, and what the exponents add up to.
VolumeBalance mean_balance(const VolumeBalance& sums, const Eigen::MatrixXd& growth, const LyapunovSpectrum& spectrum) {
  const double time = spectrum.duration;
  const Eigen::Index finite = spectrum.size - spectrum.lost;
  return {.viscous = sums.viscous / time,
          .friction = sums.friction / time,
          .events = sums.events / time,
          .revived = growth.bottomRows(spectrum.lost).sum() / time,
          .sum = growth.topRows(finite).sum() / time,
          .unexplained = sums.unexplained};
}

}  // namespace

LyapunovSpectrum lyapunov_spectrum(const dynamics::HybridSystem& system, const dynamics::State& start,
                                   const TangentOptions& options) {
  LyapunovSpectrum spectrum{.size = 2 * system.size() + system.internal_size(),
                            .interval = options.interval,
                            .self_excited = system.drive().is_constant()};
  check(options, spectrum.size);
  const dynamics::State begin = after_transient(system, start, options);
  require_steady(system.drive(), begin.time);
  TangentWalk walk(system, begin, options);
  const auto aligning = static_cast<Eigen::Index>(std::ceil(options.alignment * options.duration / options.interval));
  const auto intervals = static_cast<Eigen::Index>(std::floor(options.duration / options.interval + 1e-9));

  Eigen::MatrixXd growth(walk.exponents(), intervals);
  Eigen::Index done = 0;
  try {
    for (Eigen::Index i = -aligning; i < intervals; ++i) {
      poll(options.stop);
      if (i == 0) walk.clear_balance();
      walk.advance_to(begin.time + static_cast<double>(i + aligning + 1) * options.interval);
      if (options.progress)
        options.progress(static_cast<std::size_t>(i + aligning + 1), static_cast<std::size_t>(aligning + intervals));
      if (i >= 0) growth.col(done++) = walk.growth();
    }
  } catch (const NumericalFailure& failure) {
    if (done < kLeastIntervals) throw;
    spectrum.failure = fmt::format("at time {:g}: {}", failure.time, failure.what());
  }
  growth.conservativeResize(Eigen::NoChange, done);
  spectrum.lost = walk.lost();
  spectrum.shortest = walk.shortest();
  spectrum.end = walk.state();
  summarise(spectrum, growth);
  if (walk.balance()) spectrum.balance = mean_balance(*walk.balance(), growth, spectrum);
  return spectrum;
}

LyapunovSpectrum lyapunov_spectrum(const TangentMap& step, const TangentMapOptions& options) {
  if (options.size < 1 || options.exponents < 0 || options.exponents > options.size || !(options.time_step > 0.0) ||
      options.alignment < 0 || options.steps < 1) {
    throw InvalidInput(fmt::format(
        "exponents of a map: expected size >= 1, 0 to {} exponents, time step > 0, "
        "alignment >= 0 and steps >= 1, found {}, {}, {}, {}, {}",
        options.size, options.size, options.exponents, options.time_step, options.alignment, options.steps));
  }
  const Eigen::Index count = options.exponents == 0 ? options.size : options.exponents;
  Random random(options.seed);
  Eigen::MatrixXd frame = random_frame(options.size, count, random);
  Eigen::MatrixXd growth = Eigen::MatrixXd::Zero(count, options.steps);
  for (int i = -options.alignment; i < options.steps; ++i) {
    const Eigen::MatrixXd images = step(frame);
    if (images.rows() != options.size || images.cols() != frame.cols())
      throw InvalidInput(
          fmt::format("exponents of a map: expected images of {} directions with {} entries, found {} x "
                      "{}",
                      frame.cols(), options.size, images.rows(), images.cols()));
    Orthonormalised next = orthonormalise(images);
    frame = std::move(next.directions);
    if (i >= 0) growth.col(i).head(frame.cols()) = next.log_growth;
  }
  LyapunovSpectrum spectrum{.size = options.size, .interval = options.time_step};
  // A map that loses a direction loses it within one application, and with it the exponents behind the last one kept.
  spectrum.lost = frame.cols() < count ? options.size - frame.cols() : 0;
  summarise(spectrum, growth);
  return spectrum;
}

}  // namespace slipmode::diagnostics
