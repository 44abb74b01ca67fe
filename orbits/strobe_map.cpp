#include "orbits/strobe_map.hpp"

#include "core/errors.hpp"

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

/// Extremes, mean and mean square of one displacement from its values and slopes at equal steps h, by the cubic through
/// both ends of each step.
class Waveform {
 public:
  explicit Waveform(double step) : step_(step) {}

  void add(double y0, double slope0, double y1, double slope1) {
    if (count_ == 0) reference_ = y0;
    include(y0);
    include(y1);
    include_turning_points(y0, step_ * slope0, y1, step_ * slope1);
    // ∫f over a step to fourth order from values and slopes.
    const double a = y0 - reference_, b = y1 - reference_;
    sum_ += 0.5 * (a + b) + step_ / 12.0 * (slope0 - slope1);
    square_ += 0.5 * (a * a + b * b) + step_ / 6.0 * (a * slope0 - b * slope1);
    ++count_;
  }

  [[nodiscard]] double alternating() const { return 0.5 * (high_ - low_); }
  [[nodiscard]] double effective() const {
    const double mean = sum_ / static_cast<double>(count_);
    return std::sqrt(std::max(0.0, square_ / static_cast<double>(count_) - mean * mean));
  }

 private:
  void include(double y) {
    low_ = std::min(low_, y);
    high_ = std::max(high_, y);
  }

  /// Roots in (0, 1) of the derivative of the cubic with ends y0, y1 and end slopes d0, d1 per step.
  void include_turning_points(double y0, double d0, double y1, double d1) {
    const double c3 = 2.0 * (y0 - y1) + d0 + d1;
    const double c2 = 3.0 * (y1 - y0) - 2.0 * d0 - d1;
    const double discriminant = c2 * c2 - 3.0 * c3 * d0;
    if (discriminant < 0.0) return;
    const double w = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    for (const double s : {w / (3.0 * c3), d0 / w}) {
      if (s > 0.0 && s < 1.0) include(y0 + s * (d0 + s * (c2 + s * c3)));
    }
  }

  double step_;
  double reference_ = 0.0;  ///< subtracted, so that a mean far from zero does not cost digits
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
  double sum_ = 0.0, square_ = 0.0;
  std::int64_t count_ = 0;
};

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
    Waveform waveform(step);
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
