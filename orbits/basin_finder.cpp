#include <slipmode/orbits/basin_finder.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include "orbits/internal/motion_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::orbits {

namespace {

/// Points of a motion that does not repeat, and how many of a motion in a row must lie near them.
constexpr Eigen::Index kCloud = 1024;
constexpr int kStay = 32;
/// Periods in a row that a motion must near the edge of the gap's continuum.
constexpr int kEdgeStay = 16;
/// Orbits whose points are nearer than this, relative to the motion, are one.
constexpr double kSameOrbit = 1e-6;

/// Half the reach of each coordinate, by its kind: displacements, velocities, contacts' own states. 1 where none of a
/// kind moves.
Eigen::VectorXd scale_of(const Eigen::MatrixXd& samples, Eigen::Index n) {
  Eigen::VectorXd scale(samples.rows());
  for (const auto& [begin, count] : {std::pair(Eigen::Index{0}, n), {n, n}, {2 * n, samples.rows() - 2 * n}})
    if (count > 0) scale.segment(begin, count) = detail::half_reaches(samples.middleRows(begin, count));
  return (scale.array() > 0.0).select(scale, 1.0);
}

Eigen::MatrixXd columns_of(const std::vector<dynamics::State>& states) {
  Eigen::MatrixXd columns(stacked(states.front()).size(), static_cast<Eigen::Index>(states.size()));
  for (std::size_t k = 0; k < states.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = stacked(states[k]);
  return columns;
}

double nearest(const Eigen::MatrixXd& cloud, const Eigen::VectorXd& point) {
  return std::sqrt((cloud.colwise() - point).colwise().squaredNorm().minCoeff());
}

bool keeps_modes(const dynamics::HybridSystem& system) {
  return std::ranges::any_of(system.contacts(), [](const friction::Contact& contact) {
    return friction::spring_stiffness(contact.law) > 0.0;
  });
}

}  // namespace

const char* to_string(BasinAttractor::Kind kind) {
  switch (kind) {
    case BasinAttractor::Kind::kOrbit:
      return "orbit";
    case BasinAttractor::Kind::kGap:
      return "gap";
    case BasinAttractor::Kind::kEdge:
      return "gap-edge";
    case BasinAttractor::Kind::kChaotic:
      return "chaotic";
  }
  return "";
}

BasinFinder::BasinFinder(dynamics::HybridSystem system, BasinOptions options)
    : system_(std::move(system)), options_(std::move(options)), period_(0.0) {
  if (options_.patience < 0 || options_.sample < 1) {
    throw InvalidInput(fmt::format("basins: expected patience >= 0 and sample >= 1, found {} and {}", options_.patience,
                                   options_.sample));
  }
  if (!system_.drive().period()) {
    throw InvalidInput(
        "basins: expected a drive with a period, a force or a shaker; found a belt, whose motions have no common "
        "phase. Its attractors over a key: 'sweep'");
  }
  period_ = system_.drive().period().value();
  gap_ = GapMotion::of(system_);
}

void BasinFinder::advance(Path& path, BasinCell& out_cell) const {
  dynamics::Trajectory run = dynamics::simulate(
      system_, path.state, {.duration = period_, .keep_events = false, .flow = options_.settle.shooting.flow});
  out_cell.met_event = out_cell.met_event || run.statistics.events > 0;
  ++out_cell.periods;
  path.state = std::move(run.final_state);
  path.state.time = 0.0;  // the same phase: late times would cost digits
}

double BasinFinder::coordinate_of(BasinAttractor::Kind kind, const Eigen::VectorXd& x) const {
  const bool in_gap = kind == BasinAttractor::Kind::kGap || kind == BasinAttractor::Kind::kEdge;
  if (!in_gap || gap_->continuum() == GapMotion::Continuum::kNone) return kNone;
  return gap_->coordinate(x);
}

bool BasinFinder::nears_edge(Path& path) const {
  constexpr double kNear = 0.01, kTransient = 0.1;
  const Eigen::VectorXd x = stacked(path.state);
  const GapMotion::Room end = gap_->room_at_end(x);
  const double beyond = -end.least, before = std::exchange(path.beyond, beyond);
  return beyond > 0.0 && beyond < before && beyond < kNear * gap_->reach() && end.next > 0.0 &&
         end.least - gap_->room(x).least <= kTransient * beyond;
}

bool BasinFinder::arrives(const std::vector<BasinAttractor>& known, Path& path, BasinCell& out_cell) const {
  path.stays.resize(known.size(), 0);
  for (std::size_t k = 0; k < known.size(); ++k) {
    const BasinAttractor& attractor = known[k];
    bool here = false;
    switch (attractor.kind) {
      case BasinAttractor::Kind::kOrbit:
        here = attractor.trap.holds(path.state);
        break;
      case BasinAttractor::Kind::kGap:
        here = gap_->room(stacked(path.state)).least > 0.0;
        break;
      case BasinAttractor::Kind::kEdge:
        path.stays[k] = nears_edge(path) ? path.stays[k] + 1 : 0;
        here = path.stays[k] >= kEdgeStay;
        break;
      case BasinAttractor::Kind::kChaotic: {
        const Eigen::VectorXd point = attractor.metric.scaled(stacked(path.state));
        path.stays[k] = nearest(attractor.cloud, point) <= attractor.reach ? path.stays[k] + 1 : 0;
        here = path.stays[k] >= kStay;
        break;
      }
    }
    if (!here) continue;
    out_cell.attractor = static_cast<int>(k);
    out_cell.coordinate = coordinate_of(attractor.kind, stacked(path.state));
    return true;
  }
  return false;
}

BasinFinder::Arrival BasinFinder::follow(const dynamics::State& start, const std::vector<BasinAttractor>& known) const {
  if (start.time != 0.0) {
    throw InvalidInput(fmt::format(
        "basins: expected starts at time 0, the phase at which attractors are known; found {}", start.time));
  }
  Arrival arrival;
  try {
    Path path{.state = start};
    if (start.internal.size() == 0) path.state.internal = Eigen::VectorXd::Zero(system_.internal_size());
    bool arrived = arrives(known, path, arrival.cell);
    while (!arrived && arrival.cell.periods < options_.patience) {
      advance(path, arrival.cell);
      arrived = arrives(known, path, arrival.cell);
    }
    if (!arrived) follow_on(known, path, arrival);
  } catch (const NumericalFailure& failure) {
    arrival.cell.failure = failure.what();
  }
  return arrival;
}

void BasinFinder::follow_on(const std::vector<BasinAttractor>& known, Path& path, Arrival& out_arrival) const {
  BasinCell& cell = out_arrival.cell;
  SettledMotion motion = settled_motion(system_, path.state, options_.settle);
  cell.periods += motion.periods;
  if (motion.orbit) {
    Found found{.order = motion.orbit->order, .state = motion.orbit->start};
    const BasinAttractor attractor = of_orbit(std::move(*motion.orbit));
    cell.met_event = cell.met_event || attractor.orbit.crossings > 0;
    const std::size_t index = index_of(attractor, known);
    if (index == known.size()) {
      out_arrival.found = std::move(found);
      return;
    }
    cell.attractor = static_cast<int>(index);
    cell.coordinate = coordinate_of(known[index].kind, attractor.points.col(0));
    return;
  }
  path = {.state = motion.end};
  for (int k = 0; k < 2 * kStay; ++k) {
    advance(path, cell);
    if (arrives(known, path, cell)) return;
  }
  if (options_.exponent) out_arrival.found = Found{.order = 0, .state = path.state};
}

std::optional<BasinAttractor> BasinFinder::describe(const Found& found) const {
  try {
    return found.order == 0 ? chaotic(found.state) : stable_orbit(found);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

std::optional<BasinAttractor> BasinFinder::stable_orbit(const Found& found) const {
  ShootingOptions shooting = options_.settle.shooting;
  shooting.order = found.order;
  ShootingResult result = shoot(system_, found.state, shooting);
  if (!result.converged() || !(result.orbit.leading_modulus < 1.0)) return std::nullopt;
  BasinAttractor attractor = of_orbit(std::move(result.orbit));
  if (attractor.orbit.family.cols() > 0) return attractor;
  dynamics::State centre = with_coordinates(attractor.orbit.start, attractor.points.col(0));
  centre.time = 0.0;
  centre.modes = attractor.trap.modes;
  attractor.trap = measure_trap(system_, centre, found.order * period_, attractor.scale, shooting.flow);
  return attractor;
}

BasinAttractor BasinFinder::of_orbit(PeriodicOrbit orbit) const {
  BasinAttractor attractor{.kind = BasinAttractor::Kind::kOrbit, .orbit = std::move(orbit)};
  // The origin of an orbit may lie off the phase of time 0.
  const double late = std::fmod(attractor.orbit.start.time, period_);
  dynamics::State at = attractor.orbit.start;
  if (late > 0.0) at = advanced(system_, at, period_ - late);
  at.time = 0.0;
  std::vector<dynamics::State> points{at};
  while (static_cast<int>(points.size()) < attractor.orbit.order) {
    points.push_back(advanced(system_, points.back(), period_));
    points.back().time = 0.0;
  }
  attractor.points = columns_of(points);
  if (keeps_modes(system_)) attractor.trap.modes = at.modes;
  constexpr int kSamples = 32;  // per period: enough to see how far the motion reaches
  attractor.scale =
      scale_of(columns_of(sample_orbit(system_, attractor.orbit, kSamples * attractor.orbit.order)), system_.size());
  return attractor;
}

std::optional<BasinAttractor> BasinFinder::chaotic(const dynamics::State& state) const {
  BasinAttractor attractor{.kind = BasinAttractor::Kind::kChaotic};
  Path path{.state = state};
  BasinCell uncounted;
  attractor.points.resize(stacked(state).size(), kCloud);
  for (Eigen::Index k = 0; k < kCloud; ++k) {
    attractor.points.col(k) = stacked(path.state);
    advance(path, uncounted);
  }
  const MeasuredExponent exponent = options_.exponent(system_, path.state);
  constexpr double kErrors = 4.0;
  if (!(exponent.value > kErrors * exponent.error)) return std::nullopt;
  attractor.exponent = exponent.value;
  attractor.exponent_error = exponent.error;
  // Chaos that only passes settles at last.
  for (Eigen::Index k = 0; k < kCloud; ++k) advance(path, uncounted);
  MapOptions brief = options_.settle;
  brief.max_periods = std::min(brief.max_periods, 4 * brief.block);
  if (settled_motion(system_, path.state, brief).orbit) return std::nullopt;
  attractor.metric = Metric::of(attractor.points);
  attractor.cloud = attractor.metric.scaled(attractor.points);
  const Eigen::MatrixXd first = attractor.cloud.leftCols(kCloud / 2);
  for (Eigen::Index k = kCloud / 2; k < kCloud; ++k) {
    attractor.reach = std::max(attractor.reach, nearest(first, attractor.cloud.col(k)));
  }
  return attractor;
}

bool BasinFinder::is_same(const BasinAttractor& a, const BasinAttractor& b) const {
  using Kind = BasinAttractor::Kind;
  if (b.kind == Kind::kOrbit && (a.kind == Kind::kGap || a.kind == Kind::kEdge)) {
    // Shooting comes to orbits of the continuum too, and near its edge takes a motion that hardly moves for an orbit.
    constexpr double kNear = 1e-3;
    const GapMotion::Room end = gap_->room_at_end(b.points.col(0));
    if (a.kind == Kind::kGap) return b.orbit.events.empty() && end.least > 0.0;
    return end.least <= 0.0 && end.least > -kNear * gap_->reach() && end.next > 0.0;
  }
  if (a.kind != b.kind) return false;
  if (a.kind == Kind::kGap || a.kind == Kind::kEdge) return true;
  if (a.kind == Kind::kChaotic) {
    constexpr double kMost = 0.9;
    const Eigen::MatrixXd others = a.metric.scaled(b.points);
    Eigen::Index near = 0;
    for (Eigen::Index k = 0; k < others.cols(); ++k) near += nearest(a.cloud, others.col(k)) <= a.reach ? 1 : 0;
    return static_cast<double>(near) >= kMost * static_cast<double>(others.cols());
  }
  if (a.orbit.order != b.orbit.order || a.orbit.family.cols() != b.orbit.family.cols()) return false;
  for (Eigen::Index k = 0; k < a.points.cols(); ++k) {
    Eigen::VectorXd apart = b.points.col(0) - a.points.col(k);
    if (a.orbit.family.cols() > 0) {
      apart -= a.orbit.family * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(a.orbit.family).solve(apart);
    }
    if (apart.cwiseQuotient(a.scale).cwiseAbs().maxCoeff() < kSameOrbit) return true;
  }
  return false;
}

std::size_t BasinFinder::index_of(const BasinAttractor& attractor, const std::vector<BasinAttractor>& known) const {
  const auto same = std::ranges::find_if(known, [&](const BasinAttractor& one) { return is_same(one, attractor); });
  return static_cast<std::size_t>(same - known.begin());
}

std::vector<BasinAttractor> BasinFinder::gap_attractors() const {
  if (!gap_ || !(gap_->room(gap_->middle()).least > 0.0)) return {};
  const Eigen::Index n = system_.size();
  const dynamics::State middle{.q = gap_->middle().head(n), .v = gap_->middle().tail(n)};
  ShootingResult found = shoot(system_, middle, options_.settle.shooting);
  if (!found.converged()) return {};
  std::vector<BasinAttractor> both{of_orbit(std::move(found.orbit))};
  both.front().kind = BasinAttractor::Kind::kGap;
  if (gap_->continuum() != GapMotion::Continuum::kShift) return both;
  both.push_back(both.front());
  both.back().kind = BasinAttractor::Kind::kEdge;
  return both;
}

}  // namespace slipmode::orbits
