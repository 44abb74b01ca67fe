#include "orbits/strobe_map.hpp"

#include "core/errors.hpp"
#include "orbits/map_waveform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <utility>

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

/// Relative distance of section states m apart, at most, over the last max(3m, 20) of them.
double repeat_distance(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, Eigen::Index m) {
  const Eigen::Index stretch = std::min(q.cols() - m, std::max<Eigen::Index>(3 * m, 20));
  const auto relative = [&](const Eigen::MatrixXd& x) {
    const double reach = x.cwiseAbs().maxCoeff();
    const double apart = (x.rightCols(stretch) - x.middleCols(x.cols() - stretch - m, stretch)).cwiseAbs().maxCoeff();
    return reach > 0.0 ? apart / reach : 0.0;
  };
  return std::max(relative(q), relative(v));
}

void find_order(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, const StrobeOptions& options,
                StrobePoint& out_point) {
  // Half of the sections at least must be seen to repeat.
  for (int m = 1; m <= options.max_order && 2 * m <= q.cols(); ++m) {
    const double apart = repeat_distance(q, v, m);
    if (apart > options.tolerance) continue;
    out_point.order = m;
    out_point.mismatch = apart;
    return;
  }
}

void measure_amplitudes(const dynamics::Trajectory& run, double step, const StrobeOptions& options,
                        StrobePoint& out_point) {
  const Eigen::MatrixXd y = options.rows * run.q;
  const Eigen::MatrixXd slope = options.rows * run.v;
  const Eigen::Index steps = static_cast<Eigen::Index>(options.kept) * options.samples;
  out_point.alternating.resize(y.rows());
  out_point.effective.resize(y.rows());
  for (Eigen::Index r = 0; r < y.rows(); ++r) {
    detail::Waveform waveform(step);
    for (Eigen::Index k = 0; k < steps; ++k) waveform.add(y(r, k), slope(r, k), y(r, k + 1), slope(r, k + 1));
    out_point.alternating(r) = waveform.alternating();
    out_point.effective(r) = waveform.effective();
  }
}

/// The same point of the drive's cycle at another frequency: the cycle begins anew at time 0.
dynamics::State carried(const dynamics::State& end) {
  return {.time = 0.0, .q = end.q, .v = end.v, .internal = end.internal};
}

}  // namespace

double StrobePoint::sine_gap(Eigen::Index row) const {
  if (row < 0 || row >= alternating.size()) {
    throw InvalidInput(fmt::format("sine gap: expected a row below {}, found {}", alternating.size(), row));
  }
  return std::abs(std::numbers::sqrt2 * effective(row) - alternating(row)) / alternating(row);
}

StrobePoint strobe(const dynamics::HybridSystem& system, const dynamics::State& start, const StrobeOptions& options) {
  check(system, options);
  const double period = system.drive().period().value();
  const double step = period / options.samples;
  // A little longer than needed: the last sample must not be lost to rounding.
  const dynamics::Trajectory run = dynamics::simulate(system, start,
                                                      {.duration = options.periods * period + 0.5 * step,
                                                       .transient = (options.periods - options.kept) * period,
                                                       .sample = step,
                                                       .keep_events = false,
                                                       .flow = options.flow});
  StrobePoint point;
  const auto section = Eigen::seqN(Eigen::Index{0}, Eigen::Index{options.kept} + 1, Eigen::Index{options.samples});
  const Eigen::MatrixXd q = run.q(Eigen::all, section), v = run.v(Eigen::all, section);
  find_order(q, v, options, point);
  measure_amplitudes(run, step, options, point);
  point.section = options.rows * q.leftCols(options.kept);
  point.end = {.time = start.time + options.periods * period, .q = q.rightCols<1>(), .v = v.rightCols<1>()};
  return point;
}

StrobeMap strobe_map(const std::function<dynamics::HybridSystem(double)>& system,
                     const std::function<dynamics::State(const dynamics::HybridSystem&)>& start,
                     const std::vector<double>& values, const StrobeOptions& options, const ParallelOptions& parallel,
                     const StrobeSink& sink) {
  if (values.empty()) throw InvalidInput("stroboscopic map: expected at least one value, found none");
  check(system(values.front()), options);
  StrobeMap map;
  map.points.resize(values.size());
  std::mutex sink_mutex;
  const auto compute = [&](std::size_t k) {
    if (sink.recall) map.points[k] = sink.recall(k);
    if (map.points[k]) return;
    const dynamics::HybridSystem here = system(values[k]);
    const bool first = !options.follow || k == 0;
    const dynamics::State begin = first ? start(here) : carried(map.points[k - 1]->end);
    StrobePoint point;
    try {
      point = strobe(here, begin, options);
    } catch (const NumericalFailure& failure) {
      point.failure = failure.what();
      point.end = begin;
    }
    point.parameter = values[k];
    if (sink.store) {
      const std::lock_guard lock(sink_mutex);
      sink.store(k, point);
    }
    map.points[k] = std::move(point);
  };
  ParallelOptions in_order = parallel;
  if (options.follow) in_order.threads = 1;
  const BatchResult batch = parallel_for(values.size(), in_order, compute);
  for (const std::exception_ptr& error : batch.errors) {
    if (error) std::rethrow_exception(error);
  }
  map.interrupted = batch.interrupted;
  return map;
}

}  // namespace slipmode::orbits
