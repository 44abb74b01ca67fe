#include <slipmode/orbits/strobe_map.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/map_waveform.hpp"
#include "orbits/internal/motion_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace slipmode::orbits {

namespace {

void check(const dynamics::HybridSystem& system, const StrobeOptions& options) {
  if (options.kept < 1 || options.periods <= options.kept || options.samples < 8 || options.max_order < 1 ||
      !(options.tolerance > 0.0)) {
    throw InvalidInput(
        fmt::format("stroboscopic map: expected 1 <= kept < periods, samples >= 8, max_order >= 1, "
                    "tolerance > 0, found {}, {}, {}, {}, {}",
                    options.kept, options.periods, options.samples, options.max_order, options.tolerance));
  }
  if (!system.drive().period()) {
    throw InvalidInput(
        "stroboscopic map: expected a drive with a period, a shaker or a force; found a belt. Use "
        "'sweep' for a belt");
  }
  if (options.rows.rows() < 1 || options.rows.cols() != system.size()) {
    throw InvalidInput(fmt::format("stroboscopic map: expected at least one row of {} numbers, found {} of {}",
                                   system.size(), options.rows.rows(), options.rows.cols()));
  }
}

void find_order(const Eigen::MatrixXd& section, const detail::MotionScale& scale, const StrobeOptions& options,
                Strobe& out_point) {
  // Half of the sections at least must be seen to repeat, over the last max(3m, 20) of them.
  for (Eigen::Index m = 1; m <= options.max_order && 2 * m <= section.cols(); ++m) {
    const Eigen::Index stretch = std::min(section.cols() - m, std::max<Eigen::Index>(3 * m, 20));
    const double apart =
        scale.distance(section.rightCols(stretch) - section.middleCols(section.cols() - stretch - m, stretch));
    if (apart > options.tolerance) continue;
    out_point.order = static_cast<int>(m);
    out_point.mismatch = apart;
    return;
  }
}

/// The first `steps` samples and the end. As a sample the end may be lost to rounding.
Eigen::MatrixXd with_end(const Eigen::MatrixXd& samples, Eigen::Index steps, const Eigen::VectorXd& end) {
  Eigen::MatrixXd all(samples.rows(), steps + 1);
  all << samples.leftCols(steps), end;
  return all;
}

/// @param q, v  samples one step apart, the end of the last step among them
void measure_amplitudes(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, double step, const StrobeOptions& options,
                        Strobe& out_point) {
  const Eigen::MatrixXd y = options.rows * q;
  const Eigen::MatrixXd slope = options.rows * v;
  const Eigen::Index steps = q.cols() - 1;
  out_point.alternating.resize(y.rows());
  out_point.effective.resize(y.rows());
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    detail::Waveform waveform(step);
    for (Eigen::Index k = 0; k < steps; ++k) waveform.add(y(r, k), slope(r, k), y(r, k + 1), slope(r, k + 1));
    out_point.alternating(r) = waveform.alternating();
    out_point.effective(r) = waveform.effective();
  }
}

}  // namespace

double Strobe::sine_gap(Eigen::Index row) const {
  if (row < 0 || row >= alternating.size()) {
    throw InvalidInput(fmt::format("sine gap: expected a row below {}, found {}", alternating.size(), row));
  }
  return std::abs(std::numbers::sqrt2 * effective(row) - alternating(row)) / alternating(row);
}

Strobe strobe(const dynamics::HybridSystem& system, const dynamics::State& start, const StrobeOptions& options) {
  check(system, options);
  const double period = system.drive().period().value();
  const double step = period / options.samples;
  const dynamics::Trajectory run = dynamics::simulate(system, start,
                                                      {.duration = options.periods * period,
                                                       .transient = (options.periods - options.kept) * period,
                                                       .sample = step,
                                                       .keep_events = false,
                                                       .flow = options.flow});
  Strobe point;
  const Eigen::Index steps = Eigen::Index{options.kept} * options.samples;
  const Eigen::MatrixXd q = with_end(run.q, steps, run.final_state.q), v = with_end(run.v, steps, run.final_state.v);
  const auto section = Eigen::seqN(Eigen::Index{0}, Eigen::Index{options.kept} + 1, Eigen::Index{options.samples});
  Eigen::MatrixXd states(2 * system.size(), options.kept + 1);
  states << q(Eigen::all, section), v(Eigen::all, section);
  find_order(states, detail::MotionScale(q, v), options, point);
  measure_amplitudes(q, v, step, options, point);
  point.section = options.rows * states.topLeftCorner(system.size(), options.kept);
  point.end = run.final_state;
  return point;
}

StrobeMap strobe_map(const std::function<dynamics::HybridSystem(double)>& system,
                     const std::function<dynamics::State(const dynamics::HybridSystem&)>& start,
                     const std::vector<double>& values, const StrobeOptions& options, const ParallelOptions& parallel,
                     const StrobeSink& sink) {
  if (values.empty()) throw InvalidInput("stroboscopic map: expected at least one value, found none");
  check(system(values.front()), options);
  using Begin = std::optional<dynamics::State>;  // where the value before ended; none: the value's own start
  const auto settle = [&](std::size_t k, int, const Begin& before) {
    const dynamics::HybridSystem here = system(values[k]);
    return strobe(here, before ? dynamics::handed_on(here, *before) : start(here), options);
  };
  return SweepRunner<Strobe, Begin>({.settle = settle, .carry = [](const Strobe& point) { return point.end; }}, values,
                                    std::nullopt, options.follow ? SweepMode::kFollow : SweepMode::kIndependent, 1,
                                    parallel, sink)
      .run_alone();
}

}  // namespace slipmode::orbits
