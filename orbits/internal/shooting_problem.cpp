#include "orbits/internal/shooting_problem.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;
using dynamics::State;

double largest(const Eigen::VectorXd& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0; }

/// What a contact does in the mirror image of a motion.
ContactMode mirrored(ContactMode mode) {
  using enum ContactMode;
  constexpr std::pair<ContactMode, ContactMode> kPairs[] = {
      {kSlipNegative, kSlipPositive}, {kLeftStop, kRightStop}, {kLeftFlight, kRightFlight}};
  for (const auto& [one, other] : kPairs) {
    if (mode == one) return other;
    if (mode == other) return one;
  }
  return mode;
}

}  // namespace

void put_on_constraint(const dynamics::HybridSystem& system, State& node) {
  std::vector<std::size_t> stuck;
  for (std::size_t c = 0; c < node.modes.size(); ++c)
    if (node.modes[c] == ContactMode::kStick && friction::sticks_rigidly(friction::kind(system.contacts()[c].law)))
      stuck.push_back(c);
  if (stuck.empty()) return;
  Eigen::MatrixXd W(system.size(), static_cast<Eigen::Index>(stuck.size()));
  for (std::size_t k = 0; k < stuck.size(); ++k)
    W.col(static_cast<Eigen::Index>(k)) = system.contacts()[stuck[k]].direction;
  const Eigen::VectorXd missing = (W.transpose() * node.v).array() - system.drive().velocity(node.time);
  node.v -= W * Eigen::MatrixXd(W.transpose() * W).ldlt().solve(missing);
}

State runnable(const dynamics::HybridSystem& system, State node) {
  const auto compliant = [](const friction::Contact& contact) {
    return friction::kind(contact.law) == friction::LawKind::kCompliant;
  };
  if (std::ranges::none_of(system.contacts(), compliant)) {
    node.modes.clear();
    return node;
  }
  for (std::size_t c = 0; c < node.modes.size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    if (!friction::sticks_rigidly(friction::kind(contact.law)) || node.modes[c] == ContactMode::kStick) continue;
    const double sliding = system.drive().velocity(node.time) - contact.direction.dot(node.v);
    node.modes[c] = sliding > 0 ? ContactMode::kSlipPositive : ContactMode::kSlipNegative;
  }
  return node;
}

Eigen::VectorXd coordinate_scale(const dynamics::HybridSystem& system, const State& one, const State& other,
                                 double period) {
  const double q = std::max(largest(one.q), largest(other.q)), v = std::max(largest(one.v), largest(other.v));
  const double radian = period / (2.0 * std::numbers::pi);
  const double size = std::max(q, v * radian) > 0 ? std::max(q, v * radian) : 1.0;
  const double speed = std::max(v, q / radian) > 0 ? std::max(v, q / radian) : 1.0;
  const Eigen::Index n = system.size();
  Eigen::VectorXd scale(2 * n + system.internal_size());
  scale.head(n).setConstant(size);
  scale.segment(n, n).setConstant(speed);
  scale.tail(system.internal_size()).setConstant(size);
  for (std::size_t c = 0; c < system.contacts().size(); ++c)  // ż of a normal oscillator
    if (system.contacts()[c].normal_load.oscillator)
      scale[2 * n + system.internal_begin(static_cast<int>(c)) + internal_states(system.contacts()[c]) - 1] = speed;
  return scale;
}

ShootingProblem::ShootingProblem(const dynamics::HybridSystem& system, const ShootingOptions& options, OrbitKind kind)
    : system_(system), options_(options), kind_(kind), flow_(system, options.flow) {
  in_halves_ = kind == OrbitKind::kDriven && options.segments == 1 && !options.half_period && options.order % 2 == 1 &&
               is_symmetric(system);
}

ShootingPoint ShootingProblem::initial_point(const State& guess, double period) const {
  ShootingPoint point{.nodes = {guess}, .period = period};
  if (!options_.segment_guesses.empty()) {
    point.nodes = options_.segment_guesses;
    return point;
  }
  const double length = covered() * period / options_.segments;
  for (int k = 1; k < options_.segments; ++k) point.nodes.push_back(advanced(system_, point.nodes.back(), length));
  return point;
}

ShootingEvaluation ShootingProblem::evaluate(const ShootingPoint& point) {
  ShootingEvaluation out;
  out.point = point;
  const std::size_t count = point.nodes.size();
  const double length = covered() * point.period / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    State& node = out.point.nodes[k];
    node.time = out.point.nodes[0].time + length * static_cast<double>(k);
    dynamics::TangentResult run = flow_.run(runnable(system_, node), in_halves_ ? 0.5 * length : length);
    if (scale_.size() == 0) scale_ = coordinate_scale(system_, node, run.end, point.period);
    out.events.insert(out.events.end(), run.events.begin(), run.events.end());
    if (in_halves_) {
      out.half_state = stacked(run.end).cwiseQuotient(scale_);
      out.half_transfer = in_scale(run.monodromy);
      run = flow_.run(runnable(system_, run.end), 0.5 * length);
      out.events.insert(out.events.end(), run.events.begin(), run.events.end());
    }
    out.transfer.push_back(in_scale(run.monodromy));
    if (in_halves_) out.transfer.back() *= out.half_transfer;
    out.rate.push_back(run.rate.cwiseQuotient(scale_));
    out.ends.push_back(std::move(run.end));
    if (!out.transfer.back().allFinite() || !out.ends.back().q.allFinite())
      throw NumericalFailure("the tangent flow of a shooting segment is not finite", node.time, stacked(node),
                             std::numeric_limits<double>::quiet_NaN());
  }
  double sum = 0.0;
  out.largest = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double sign = k + 1 == count && options_.half_period ? -1.0 : 1.0;
    out.mismatch.push_back((stacked(out.ends[k]) - sign * stacked(point.nodes[(k + 1) % count])).cwiseQuotient(scale_));
    sum += out.mismatch.back().squaredNorm();
    out.largest = std::max(out.largest, largest(out.mismatch.back()));
  }
  out.norm = std::sqrt(sum);
  return out;
}

Eigen::MatrixXd ShootingProblem::in_scale(const Eigen::MatrixXd& transfer) const {
  return scale_.cwiseInverse().asDiagonal() * transfer * scale_.asDiagonal();
}

dynamics::TangentResult ShootingProblem::run(const State& start, double duration) {
  return flow_.run(runnable(system_, start), duration, {.start = Eigen::MatrixXd::Zero(scale_.size(), 1)});
}

ShootingProblem::Ends ShootingProblem::ends_of(const ShootingPoint& point) {
  const auto count = static_cast<Eigen::Index>(point.nodes.size());
  const double length = covered() * point.period / static_cast<double>(count);
  Ends out{.states = Eigen::MatrixXd(scale_.size(), count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    State node = point.nodes[static_cast<std::size_t>(k)];
    node.time = point.nodes[0].time + length * static_cast<double>(k);
    put_on_constraint(system_, node);
    const dynamics::TangentResult end = run(node, length);
    out.states.col(k) = scaled(stacked(end.end));
    out.events += end.events.size();
  }
  return out;
}

CondensedShooting ShootingProblem::condense(const ShootingEvaluation& at,
                                            const std::vector<Eigen::MatrixXd>& extra) const {
  CondensedShooting out{at.transfer[0], {}, at.mismatch[0]};
  out.columns = extra.empty() ? Eigen::MatrixXd(at.mismatch[0].size(), 0) : extra[0];
  for (std::size_t k = 1; k < at.transfer.size(); ++k) {
    out.matrix = at.transfer[k] * out.matrix;
    out.rest = at.transfer[k] * out.rest + at.mismatch[k];
    if (!extra.empty()) out.columns = at.transfer[k] * out.columns + extra[k];
  }
  out.matrix.diagonal().array() -= options_.half_period ? -1.0 : 1.0;
  return out;
}

std::vector<Eigen::MatrixXd> ShootingProblem::period_columns(const ShootingEvaluation& at) const {
  std::vector<Eigen::MatrixXd> columns;
  const double length = covered() * at.point.period / static_cast<double>(at.rate.size());
  for (const Eigen::VectorXd& rate : at.rate) columns.emplace_back(length * rate);
  return columns;
}

ShootingPoint ShootingProblem::moved(const ShootingEvaluation& at, const Eigen::VectorXd& first,
                                     const std::vector<Eigen::MatrixXd>& columns, const Eigen::VectorXd& extra,
                                     double share) const {
  ShootingPoint out = at.point;
  if (period_unknown()) out.period = at.point.period * std::exp(extra[0]);
  const std::size_t count = out.nodes.size();
  const double length = covered() * out.period / static_cast<double>(count);
  Eigen::VectorXd step = first;
  for (std::size_t k = 0; k < count; ++k) {
    State& node = out.nodes[k];
    node = with_coordinates(node, stacked(at.point.nodes[k]) + scale_.cwiseProduct(step));
    node.time = out.nodes[0].time + length * static_cast<double>(k);
    node.modes = at.ends[(k + count - 1) % count].modes;
    if (k == 0 && options_.half_period) std::ranges::transform(node.modes, node.modes.begin(), mirrored);
    put_on_constraint(system_, node);
    if (k + 1 == count) break;
    step = at.transfer[k] * step + share * at.mismatch[k];
    if (!columns.empty()) step += columns[k] * extra;
  }
  return out;
}

}  // namespace slipmode::orbits
