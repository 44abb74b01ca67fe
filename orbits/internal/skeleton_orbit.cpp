#include "orbits/internal/skeleton_orbit.hpp"

#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits::detail {

namespace {

constexpr dynamics::FlowOptions kFlow{.tolerance = 1e-12, .audit = false};

/// States of the orbit from `offset` after its start on, `step` apart.
Eigen::MatrixXd points_from(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, double offset,
                            double step, Eigen::Index count, const std::optional<pod::Basis>& basis) {
  // A little longer than needed: the last sample must not be lost to rounding.
  const double duration = offset + (static_cast<double>(count) - 0.5) * step;
  const dynamics::Trajectory run = dynamics::simulate(
      system, orbit.start,
      {.duration = duration, .transient = offset, .sample = step, .keep_events = false, .flow = kFlow});
  return points_of(run.q.leftCols(count), run.v.leftCols(count), basis);
}

Passages events_of(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Section& section,
                   const std::optional<pod::Basis>& basis) {
  std::vector<dynamics::State> states;
  dynamics::SimulateOptions run{.duration = orbit.period, .keep_events = false, .flow = kFlow};
  run.on_event = [&](const dynamics::Event& event, const dynamics::State& state) {
    if (event.contact == section.contact && event.kind == section.event) states.push_back(state);
    return true;
  };
  (void)dynamics::simulate(system, orbit.start, run);
  Passages passages{.points = points_of(states, basis),
                    .offsets = Eigen::VectorXd(static_cast<Eigen::Index>(states.size()))};
  for (std::size_t k = 0; k < states.size(); ++k) {
    passages.offsets(static_cast<Eigen::Index>(k)) = states[k].time - orbit.start.time;
  }
  return passages;
}

/// Largest distance between columns of a and those of b, `shift` further on.
double shifted_distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, Eigen::Index shift) {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < a.cols(); ++k) {
    largest = std::max(largest, (a.col(k) - b.col((k + shift) % b.cols())).norm());
  }
  return largest;
}

}  // namespace

Passages passages_of(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Section& section,
                     double phase, const std::optional<pod::Basis>& basis) {
  if (!section.is_stroboscopic()) return events_of(system, orbit, section, basis);
  const double drive = system.drive().period().value();
  const double turns = (phase - orbit.start.time) / drive;
  double offset = (turns - std::floor(turns)) * drive;
  if (drive - offset < 1e-9 * drive) offset = 0.0;
  const auto count = static_cast<Eigen::Index>(orbit.order);
  return {.points = points_from(system, orbit, offset, drive, count, basis),
          .offsets = Eigen::VectorXd::LinSpaced(count, offset, offset + static_cast<double>(count - 1) * drive)};
}

Eigen::Index least_length(const Eigen::MatrixXd& points, double same) {
  for (Eigen::Index q = 1; 2 * q <= points.cols(); ++q) {
    if (points.cols() % q == 0 && shifted_distance(points, points, q) <= same) return q;
  }
  return points.cols();
}

double cyclic_distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Eigen::Index shift = 0; shift < b.cols(); ++shift) {
    smallest = std::min(smallest, shifted_distance(a, b, shift));
  }
  return smallest;
}

Eigen::VectorXd intervals_of(const Passages& passages, double period) {
  const Eigen::Index p = passages.offsets.size();
  Eigen::VectorXd intervals(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const double next = k + 1 < p ? passages.offsets(k + 1) : passages.offsets(0) + period;
    intervals(k) = next - passages.offsets(k);
  }
  return intervals;
}

Eigen::MatrixXd path_of(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Passages& passages,
                        int samples, const std::optional<pod::Basis>& basis) {
  const Eigen::VectorXd intervals = intervals_of(passages, orbit.period);
  Eigen::MatrixXd path(passages.points.rows(), intervals.size() * samples);
  for (Eigen::Index k = 0; k < intervals.size(); ++k) {
    path.middleCols(k * samples, samples) =
        points_from(system, orbit, passages.offsets(k), intervals(k) / samples, samples, basis);
  }
  return path;
}

double share_near(const Eigen::MatrixXd& points, const Eigen::MatrixXd& path, double radius) {
  if (points.cols() == 0) return 0.0;
  const Eigen::Index K = path.cols();
  const Eigen::VectorXd size = path.colwise().squaredNorm();
  Eigen::VectorXd edge(K);
  for (Eigen::Index k = 0; k < K; ++k) edge(k) = (path.col((k + 1) % K) - path.col(k)).squaredNorm();
  Eigen::Index near = 0;
  Eigen::VectorXd square(K);
  for (Eigen::Index s = 0; s < points.cols(); ++s) {
    square.noalias() = -2.0 * (path.transpose() * points.col(s));
    square += size;
    square.array() += points.col(s).squaredNorm();
    double smallest = square.minCoeff();
    for (Eigen::Index k = 0; k < K; ++k) {
      if (!(edge(k) > 0.0)) continue;
      // Foot of the perpendicular on the edge, from squared distances alone.
      const double along = 0.5 * (square(k) + edge(k) - square((k + 1) % K)) / edge(k);
      if (along > 0.0 && along < 1.0) smallest = std::min(smallest, square(k) - along * along * edge(k));
    }
    if (smallest <= radius * radius) ++near;
  }
  return static_cast<double>(near) / static_cast<double>(points.cols());
}

double farthest(const Eigen::MatrixXd& points, const Eigen::MatrixXd& others) {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    largest = std::max(largest, (others.colwise() - points.col(k)).colwise().squaredNorm().minCoeff());
  }
  return std::sqrt(largest);
}

}  // namespace slipmode::orbits::detail
