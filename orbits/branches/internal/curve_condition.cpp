#include "orbits/branches/internal/curve_condition.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace slipmode::orbits {
namespace {

using dynamics::State;

constexpr int kTouchSamples = 256;  ///< of what is run, to part extremes
/// A special point's orbit is found to 1e-8 and better: a stop further off than this, of the motion, is not touched.
constexpr double kTouches = 1e-4;
/// Step of a condition's differences, where the matrix stretches nothing.
constexpr double kConditionStep = 1e-5;
/// A correction below this, scaled, changes a condition by less than it is known.
constexpr double kLeastCorrection = 1e-13;

/// Displacement beyond the middle of the gap towards a stop, and its rate.
struct Approach {
  const friction::Contact& contact;
  int side;
  double gap;

  [[nodiscard]] double way(const State& state) const {
    return side * (contact.direction.dot(state.q) + contact.offset);
  }
  [[nodiscard]] double speed(const State& state) const { return side * contact.direction.dot(state.v); }
};

std::optional<Approach> approach(const friction::Contact& contact, int side) {
  const std::optional<double> gap = gap_towards(contact, side);
  if (!gap) return std::nullopt;
  return Approach{contact, side, *gap};
}

/// A stretch in which an approach turns back.
struct Turn {
  State from;
  double length, after;  ///< [s]; `after` the origin
};

/// All of them, in a pass that goes on a little beyond the end: an extreme may lie at the origin.
std::vector<Turn> turns(ShootingProblem& problem, const ShootingPoint& point, const Approach& approach) {
  const std::size_t count = point.nodes.size();
  const double length = problem.covered() * point.period / static_cast<double>(count), step = length / kTouchSamples;
  std::vector<double> times(kTouchSamples + 1);
  std::vector<Turn> found;
  for (std::size_t k = 0; k < count; ++k) {
    State last = runnable(problem.system(), point.nodes[k]);
    const double start = last.time;
    for (std::size_t j = 0; j < times.size(); ++j) times[j] = start + step * static_cast<double>(j + 1);
    const dynamics::Tangents none{.start = Eigen::MatrixXd::Zero(problem.scale().size(), 1)};
    static_cast<void>(
        problem.flow().run(last, length + 1.5 * step, none, times, [&](const State& next, const Eigen::MatrixXd&) {
          if (approach.speed(last) > 0.0 && approach.speed(next) <= 0.0)
            found.push_back({last, next.time - last.time, last.time - point.nodes[0].time});
          last = next;
        }));
  }
  return found;
}

/// Where the approach turns back, by Illinois' rule on its speed.
Touch located(ShootingProblem& problem, const ShootingPoint& point, const Approach& approach, const Turn& turn) {
  double low = 0.0, high = turn.length;
  double at_low = approach.speed(turn.from), at_high = approach.speed(problem.end_of(turn.from, high));
  State top = turn.from;
  double at = 0.0;
  int same = 0;
  for (int k = 0; k < 60 && high - low > 1e-9 * turn.length; ++k) {
    at = at_low == at_high ? 0.5 * (low + high) : high - at_high * (high - low) / (at_high - at_low);
    at = std::clamp(at, low, high);
    top = problem.end_of(turn.from, at);
    const double here = approach.speed(top);
    if (here == 0.0 || std::abs(here) <= 1e-15 * std::abs(at_low)) break;
    if (here > 0.0) {
      low = at, at_low = here;
      if (same > 0) at_high *= 0.5;
      same = 1;
    } else {
      high = at, at_high = here;
      if (same < 0) at_low *= 0.5;
      same = -1;
    }
  }
  return {approach.gap - approach.way(top), (turn.after + at) / point.period};
}

}  // namespace

CurveCondition condition_of(const SpecialPoint& special, const KeyRange& other) {
  return {special.kind == SpecialKind::kNonSmoothFold ? SpecialKind::kGrazing : special.kind, other};
}

std::optional<double> gap_towards(const friction::Contact& contact, int side) {
  const friction::Clearance* law = friction::clearance(contact.law);
  if (law == nullptr) return std::nullopt;
  const std::optional<friction::Stop>& stop = side > 0 ? law->right : law->left;
  return stop ? std::optional(stop->gap) : std::nullopt;
}

double shares_apart(double a, double b) { return std::abs(a - b - std::round(a - b)); }

CurveCondition nearest_touch(std::size_t contacts, double size, const CurveCondition& like,
                             const std::function<std::vector<Touch>(std::size_t contact, int side)>& touches) {
  CurveCondition out = like;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < contacts; ++c)
    for (const int side : {1, -1})
      for (const Touch& touch : touches(c, side)) {
        if (std::abs(touch.clearance) >= least) continue;
        least = std::abs(touch.clearance);
        out.contact = c, out.side = side, out.touch = touch.share;
      }
  if (least <= kTouches * size) return out;
  throw InvalidInput(fmt::format(
      "a grazing is followed where a contact with a clearance just reaches a stop; of this one the nearest comes "
      "within "
      "{:.3g} of one, {:.1e} of the motion: what comes or goes there is a separation, or a stop that lets go",
      least, least / size));
}

double condition_step(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  return kConditionStep / std::sqrt(std::max(1.0, matrix.norm()));
}

void append(const Eigen::RowVectorXd& row, double value, Eigen::MatrixXd& out_J, Eigen::VectorXd& out_r) {
  out_J.conservativeResize(out_J.rows() + 1, Eigen::NoChange);
  out_J.bottomRows(1) = row;
  out_r.conservativeResize(out_J.rows());
  out_r[out_r.size() - 1] = value;
}

Touch touch_near(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& condition, double share) {
  const bool halves = problem.covered() < 1.0;
  double nearest = 2.0;
  std::optional<Turn> best;
  int best_side = 0;
  for (const int side : {1, -1}) {
    if (side != condition.side && !halves) continue;
    const auto own = approach(problem.system().contacts()[condition.contact], side);
    if (!own) continue;
    for (const Turn& turn : turns(problem, point, *own)) {
      const double middle = (turn.after + 0.5 * turn.length) / point.period;
      const double away = shares_apart(middle + (side == condition.side ? 0.0 : 0.5), share);
      if (away < nearest) nearest = away, best = turn, best_side = side;
    }
  }
  if (!best)
    throw NumericalFailure("the contact that grazes its stop does not turn back any more", point.nodes[0].time,
                           stacked(point.nodes[0]), 0.0);
  Touch touch = located(problem, point, *approach(problem.system().contacts()[condition.contact], best_side), *best);
  if (best_side != condition.side) touch.share += 0.5;
  touch.share -= std::floor(touch.share);
  return touch;
}

CurveCondition grazed(ShootingProblem& problem, const ShootingPoint& point, const CurveCondition& like) {
  const auto& contacts = problem.system().contacts();
  const double size = problem.scale().head(problem.system().size()).maxCoeff();
  return nearest_touch(contacts.size(), size, like, [&](std::size_t c, int side) {
    std::vector<Touch> out;
    if (const auto own = approach(contacts[c], side))
      for (const Turn& turn : turns(problem, point, *own)) out.push_back(located(problem, point, *own, turn));
    return out;
  });
}

Eigen::MatrixXd critical_matrix(SpecialKind kind, const Eigen::MatrixXd& J, Eigen::Index states, bool half_period) {
  if (kind == SpecialKind::kFold) return J.leftCols(J.rows());
  const Eigen::MatrixXd twice = 2.0 * Eigen::MatrixXd::Identity(states, states);
  const Eigen::MatrixXd closing = J.topLeftCorner(states, states);
  return half_period ? Eigen::MatrixXd(twice - closing) : Eigen::MatrixXd(twice + closing);
}

std::function<double(const Eigen::MatrixXd&)> least_singular_value_near(const Eigen::MatrixXd& from) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(from, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Index last = svd.matrixV().cols() - 1;
  return [u = Eigen::VectorXd(svd.matrixU().col(last)),
          v = Eigen::VectorXd(svd.matrixV().col(last))](const Eigen::MatrixXd& A) { return u.dot(A * v); };
}

Eigen::VectorXcd multipliers_of(const Eigen::MatrixXd& J, Eigen::Index states, bool half_period) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(states, states), closing = J.topLeftCorner(states, states);
  return sorted_eigenvalues(half_period ? Eigen::MatrixXd(one - closing) : Eigen::MatrixXd(one + closing));
}

MultiplierPair critical_pair(const Eigen::VectorXcd& mu, const std::optional<MultiplierPair>& near) {
  std::optional<MultiplierPair> best;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < mu.size(); ++i)
    for (Eigen::Index j = 0; j < i; ++j) {
      const std::complex<double> sum = mu[i] + mu[j], product = mu[i] * mu[j];
      if (std::abs(sum.imag()) + std::abs(product.imag()) > 1e-9) continue;
      const double away =
          near ? std::hypot(sum.real() - near->sum, product.real() - near->product) : std::abs(product.real() - 1.0);
      if (away < least) least = away, best = MultiplierPair{sum.real(), product.real()};
    }
  if (best) return *best;
  throw NumericalFailure("there is no pair of multipliers", 0.0, {}, 0.0);
}

std::string resonance_met(const MultiplierPair& pair) {
  if (pair.complex()) return {};
  return fmt::format("the pair of multipliers meets at {}: a strong resonance, where Neimark-Sacker points end",
                     pair.sum < 0.0 ? "-1" : "1");
}

double slowest_touch(const std::vector<dynamics::Event>& events) {
  double slowest = std::numeric_limits<double>::infinity();
  for (const dynamics::Event& event : events)
    if (event.kind == dynamics::EventKind::kContact && event.before == dynamics::ContactMode::kGap)
      slowest = std::min(slowest, std::abs(event.velocity));
  return slowest;
}

Eigen::RowVectorXd condition_row(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double here, double step,
                                 const std::function<std::optional<double>(const Eigen::VectorXd&)>& value) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
  std::vector<Eigen::VectorXd> directions;
  for (Eigen::Index k = J.rows(); k < J.cols(); ++k) directions.emplace_back(svd.matrixV().col(k));
  const Eigen::VectorXd correction = svd.solve(r);
  if (correction.norm() > kLeastCorrection) directions.push_back(correction.normalized());
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(J.cols());
  for (const Eigen::VectorXd& direction : directions) {
    const std::optional<double> above = value(step * direction), below = value(-step * direction);
    if (!above && !below) continue;
    const double rise = above.value_or(here) - below.value_or(here);
    row += (rise / (above && below ? 2.0 * step : step)) * direction.transpose();
  }
  return row;
}

}  // namespace slipmode::orbits
