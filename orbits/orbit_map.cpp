#include <slipmode/orbits/orbit_map.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/map_waveform.hpp"
#include "orbits/internal/motion_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace slipmode::orbits {

namespace {

void check(const dynamics::HybridSystem& system, const MapOptions& options) {
  if (options.max_order < 1 || options.block < 1 || options.max_periods < 1 || !(options.near > 0.0)) {
    throw InvalidInput(
        fmt::format("orbit map: expected max_order >= 1, block >= 1, max_periods >= 1, near > 0, found {}, "
                    "{}, {}, {}",
                    options.max_order, options.block, options.max_periods, options.near));
  }
  if (!system.drive().period()) {
    throw InvalidInput(
        "orbit map: expected a drive with a period, a shaker or a force; found a belt. Its orbits are "
        "found by 'orbit skeleton'");
  }
  if (options.row.size() != 0 && options.row.size() != system.size()) {
    throw InvalidInput(fmt::format("orbit map: expected a row of {} numbers for the amplitude, found {}", system.size(),
                                   options.row.size()));
  }
}

/// Simulates block after block and looks for the orbit.
class Settling {
 public:
  Settling(const dynamics::HybridSystem& system, const dynamics::State& start, const MapOptions& options)
      : system_(system),
        options_(options),
        period_(system.drive().period().value()),
        state_(start),
        section_(2 * system.size(), 0) {}

  SettledMotion run() {
    SettledMotion motion;
    while (motion.periods < options_.max_periods && !motion.orbit) {
      const int count = std::min(options_.block, options_.max_periods - motion.periods);
      advance(count);
      motion.periods += count;
      motion.orbit = orbit_near();
    }
    motion.end = state_;
    return motion;
  }

 private:
  void advance(int count) {
    constexpr Eigen::Index kSamples = 8;  // per period: enough to see how far the motion reaches
    const dynamics::Trajectory run = dynamics::simulate(system_, state_,
                                                        {.duration = count * period_,
                                                         .sample = period_ / kSamples,
                                                         .keep_events = false,
                                                         .flow = options_.shooting.flow});
    const Eigen::Index n = system_.size();
    const Eigen::Index kept = std::min<Eigen::Index>(section_.cols(), options_.max_order);
    Eigen::MatrixXd section(2 * n, kept + count);
    section.leftCols(kept) = section_.rightCols(kept);
    // The first sample is the state the block began with; the last may be lost to rounding, the final state is not.
    const auto between = Eigen::seqN(kSamples, count - 1, kSamples);
    section.topRows(n).middleCols(kept, count - 1) = run.q(Eigen::all, between);
    section.bottomRows(n).middleCols(kept, count - 1) = run.v(Eigen::all, between);
    section.col(kept + count - 1) << run.final_state.q, run.final_state.v;
    section_ = std::move(section);
    scale_ = detail::MotionScale(run.q, run.v);
    const double begin = state_.time;
    state_ = run.final_state;
    state_.time = begin;  // the same phase of the drive: late times would cost digits
  }

  /// Distance of two states' displacements and velocities, relative to the motion.
  [[nodiscard]] double distance(const Eigen::Ref<const Eigen::VectorXd>& a,
                                const Eigen::Ref<const Eigen::VectorXd>& b) const {
    const Eigen::Index n = system_.size();
    return scale_.distance(a.head(2 * n) - b.head(2 * n));
  }

  /// The stable orbit the motion is about to settle on.
  [[nodiscard]] std::optional<PeriodicOrbit> orbit_near() const {
    const Eigen::Index last = section_.cols() - 1;
    for (int order = 1; order <= options_.max_order && order <= last; ++order) {
      const double gap = distance(section_.col(last), section_.col(last - order));
      if (gap > options_.near) continue;
      ShootingResult found = shoot(order);
      if (found.converged()) found = least_order(std::move(found));
      if (!found.converged() || !is_reached(found.orbit, gap)) return std::nullopt;
      return std::move(found.orbit);
    }
    return std::nullopt;
  }

  [[nodiscard]] ShootingResult shoot(int order) const {
    ShootingOptions shooting = options_.shooting;
    shooting.order = order;
    return orbits::shoot(system_, state_, shooting);
  }

  /// A motion that alternates on its way to an orbit repeats after two periods first.
  [[nodiscard]] ShootingResult least_order(ShootingResult found) const {
    const Eigen::VectorXd start = stacked(found.orbit.start);
    dynamics::State state = found.orbit.start;
    for (int order = 1; 2 * order <= found.orbit.order; ++order) {
      state = advanced(system_, state, period_);
      if (found.orbit.order % order == 0 && distance(stacked(state), start) < kSame) return shoot(order);
    }
    return found;
  }

  /// True when the motion must end on the orbit: it is stable, and as near as a motion that moves by `gap` in a period
  /// can be.
  [[nodiscard]] bool is_reached(const PeriodicOrbit& orbit, double gap) const {
    if (orbit.stability == Stability::kUnstable || !(orbit.leading_modulus < 1.0)) return false;
    const double elapsed = orbit.start.time - state_.time;
    const dynamics::State here = elapsed > 0.0 ? advanced(system_, state_, elapsed) : state_;
    constexpr double kReserve = 10.0;
    return distance(stacked(orbit.start), stacked(here)) <= kReserve * gap / (1.0 - orbit.leading_modulus) + kSame;
  }

  static constexpr double kSame = 1e-7;

  const dynamics::HybridSystem& system_;
  const MapOptions& options_;
  double period_;
  dynamics::State state_;
  Eigen::MatrixXd section_;    ///< (q; q̇) once per period, the last ones
  detail::MotionScale scale_;  ///< of the last block
};

/// From samples of one run: to 1e-8 of the amplitude where the motion is smooth, at a tenth of orbits::amplitude.
double alternating(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const MapOptions& options) {
  constexpr int kSamples = 256;  // per period of the drive
  const Eigen::Index steps = Eigen::Index{kSamples} * orbit.order;
  const double step = orbit.period / static_cast<double>(steps);
  // A little longer than needed: the last sample must not be lost to rounding.
  const dynamics::Trajectory run = dynamics::simulate(
      system, orbit.start,
      {.duration = orbit.period + 0.5 * step, .sample = step, .keep_events = false, .flow = options.shooting.flow});
  const Eigen::VectorXd y = run.q.transpose() * options.row, slope = run.v.transpose() * options.row;
  detail::Waveform waveform(step);
  for (Eigen::Index k = 0; k < steps; ++k) waveform.add(y(k), slope(k), y(k + 1), slope(k + 1));
  return waveform.alternating();
}

}  // namespace

SettledMotion settled_motion(const dynamics::HybridSystem& system, const dynamics::State& start,
                             const MapOptions& options) {
  check(system, options);
  return Settling(system, start, options).run();
}

MapPoint settled_orbit(const dynamics::HybridSystem& system, const dynamics::State& start, const MapOptions& options) {
  const SettledMotion motion = settled_motion(system, start, options);
  MapPoint point{.periods = motion.periods};
  if (!motion.orbit) return point;
  const PeriodicOrbit& orbit = *motion.orbit;
  point.order = orbit.order;
  point.crossings = orbit.crossings;
  point.multiplier = orbit.multipliers.size() > 0 ? std::abs(orbit.multipliers(0)) : 0.0;
  point.symmetric = orbit.symmetric;
  point.floating = orbit.family.cols() > 0;
  point.residual = orbit.residual;
  if (options.row.size() > 0) point.alternating = alternating(system, orbit, options);
  return point;
}

OrbitMap orbit_map(const std::function<dynamics::HybridSystem(double x, double y)>& system,
                   const std::function<dynamics::State(const dynamics::HybridSystem&)>& start, const MapGrid& grid,
                   const MapOptions& options, const ParallelOptions& parallel, const MapSink& sink) {
  if (grid.x.empty() || grid.y.empty()) {
    throw InvalidInput(fmt::format("orbit map: expected a grid of at least one value each way, found {} x {}",
                                   grid.x.size(), grid.y.size()));
  }
  check(system(grid.x.front(), grid.y.front()), options);
  const auto row_at = [&](std::size_t j, int, const std::monostate&) {
    std::vector<MapPoint> row;
    row.reserve(grid.x.size());
    for (const double x : grid.x) {
      MapPoint point;
      try {
        const dynamics::HybridSystem here = system(x, grid.y[j]);
        point = settled_orbit(here, start(here), options);
      } catch (const NumericalFailure& failure) {
        point.failure = failure.what();
      }
      row.push_back(std::move(point));
    }
    return row;
  };
  auto finished = SweepRunner<std::vector<MapPoint>, std::monostate>(
                      {.settle = row_at, .carry = [](const auto&) { return std::monostate(); }}, grid.y, {},
                      SweepMode::kIndependent, 1, parallel, sink)
                      .run_alone();
  OrbitMap map{.rows = std::vector<std::vector<MapPoint>>(grid.y.size()), .interrupted = finished.interrupted};
  for (MapRow& row : finished.points) map.rows[row.index] = std::move(row.settled);
  return map;
}

}  // namespace slipmode::orbits
