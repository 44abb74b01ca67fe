#include "orbits/mixed/internal/mixed_problem.hpp"

#include <slipmode/core/errors.hpp>
#include "orbits/internal/legendre_panel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace slipmode::orbits {
namespace {

using dynamics::State;

double largest_entry(const Eigen::VectorXd& x) { return x.lpNorm<Eigen::Infinity>(); }

/// Nodes and weights of Gauss' rule over one period, in panels that end at its events.
struct Quadrature {
  struct Panel {
    double from, length;
    double before = 1e300;  ///< last terms of the panel that this is a half of
  };
  std::vector<Panel> panels;
  std::vector<double> time, weight;

  /// Between events, none longer than `longest`.
  Quadrature(double start, double period, const std::vector<dynamics::Event>& events, double longest) {
    double from = start;
    const auto add_up_to = [&](double to) {
      if (!(to > from)) return;
      const int pieces = std::max(1, static_cast<int>(std::ceil((to - from) / longest)));
      for (int k = 0; k < pieces; ++k)
        panels.push_back({.from = from + (to - from) * k / pieces, .length = (to - from) / pieces});
      from = to;
    };
    for (const dynamics::Event& event : events) add_up_to(std::min(event.time, start + period));
    add_up_to(start + period);
    place();
  }

  /// Halves the panels whose last terms are above `resolved`, but for those where that did not help: what they have
  /// left is the flow's own. True if there were any. @param last  one per panel
  bool halve(const std::vector<double>& last, double resolved, double noise) {
    std::vector<Panel> finer;
    for (std::size_t k = 0; k < panels.size(); ++k) {
      const auto [from, length, before] = panels[k];
      const double own = last[k];
      if (!(own > resolved) || (own < noise && own > 0.25 * before)) {
        finer.push_back({from, length, own});
        continue;
      }
      finer.push_back({from, 0.5 * length, own});
      finer.push_back({from + 0.5 * length, 0.5 * length, own});
    }
    const bool halved = finer.size() > panels.size();
    panels = std::move(finer);
    place();
    return halved;
  }

 private:
  void place() {
    time.clear();
    weight.clear();
    const LegendrePanel::Rule& rule = LegendrePanel::rule();
    for (const auto& [from, length, before] : panels)
      for (std::size_t i = 0; i < rule.point.size(); ++i) {
        time.push_back(from + 0.5 * length * (1.0 + rule.point[i]));
        weight.push_back(length * rule.share[i]);
      }
  }
};

/// A rule that is exact to rounding for the displacements times the highest harmonic: on each panel their Legendre
/// series end before their last terms.
Quadrature quadrature(dynamics::TangentFlow& flow, const State& start, double period, double highest_rate) {
  constexpr double kRadians = 3.0, kResolved = 1e-14, kNoise = 1e-9;
  constexpr int kHalvings = 14;
  const Eigen::MatrixXd none(stacked(start).size(), 0);
  Quadrature rule(start.time, period, flow.run(start, period, {.start = none}).events, 2.0 * kRadians / highest_rate);
  for (int turn = 0; turn < kHalvings; ++turn) {
    constexpr Eigen::Index kTerms = LegendrePanel::kTerms;
    Eigen::MatrixXd q(start.q.size(), std::ssize(rule.time));
    Eigen::Index next = 0;
    static_cast<void>(flow.run(start, period, {.start = none}, rule.time,
                               [&](const State& state, const Eigen::MatrixXd&) { q.col(next++) = state.q; }));
    const double size = q.cwiseAbs().maxCoeff();
    std::vector<double> last;
    for (Eigen::Index k = 0; k < std::ssize(rule.panels); ++k)
      last.push_back(
          (q.middleCols(k * kTerms, kTerms) * LegendrePanel::rule().to_terms.rightCols<2>()).cwiseAbs().maxCoeff());
    if (!rule.halve(last, kResolved * size, kNoise * size)) return rule;
  }
  throw NumericalFailure("the motion near the contacts has no series on panels of a 16,384th of the period", start.time,
                         stacked(start), std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

double MixedProblem::period() const { return 2.0 * std::numbers::pi / partition_.omega(); }

MixedEvaluation MixedProblem::evaluate(const MixedPoint& point) {
  const dynamics::HybridSystem near = system_at(point);
  const Eigen::Index n = near.size(), N = 2 * n + near.internal_size(), nb = partition_.coupled(),
                     block = partition_.block(), H = partition_.harmonics(), unknown = N + nb * block;
  const State start = runnable(near, point.start);
  dynamics::TangentFlow flow(near, flow_);
  MixedEvaluation out;
  out.point = point;
  dynamics::Tangents tangents{.start = Eigen::MatrixXd::Identity(N, unknown)};
  if (nb > 0) {
    tangents.forces = Eigen::MatrixXd::Zero((partition_.own_directions() + nb) * block, unknown);
    tangents.forces.bottomRightCorner(nb * block, nb * block).setIdentity();
  }
  std::vector<double> times, weights;
  if (nb > 0) {
    Quadrature rule = quadrature(flow, start, period(), static_cast<double>(H) * partition_.omega());
    times = std::move(rule.time);
    weights = std::move(rule.weight);
  }
  const Eigen::Index count = std::ssize(times);
  // Rows: what is integrated times cos kΩt, sin kΩt; columns: the coupled motion, then its derivatives.
  Eigen::MatrixXd waves(block, count), motions(nb, count);
  std::vector<Eigen::MatrixXd> changes(static_cast<std::size_t>(nb), Eigen::MatrixXd(count, unknown));
  Eigen::Index next = 0;
  const dynamics::TangentResult run =
      flow.run(start, period(), tangents, times, [&](const State& state, const Eigen::MatrixXd& there) {
        const double share = weights[static_cast<std::size_t>(next)] / period();
        for (Eigen::Index k = 0; k <= H; ++k) {
          const double theta = static_cast<double>(k) * partition_.omega() * state.time;
          waves(k, next) = (k == 0 ? share : 2.0 * share) * std::cos(theta);
          if (k > 0) waves(H + k, next) = 2.0 * share * std::sin(theta);
        }
        for (Eigen::Index b = 0; b < nb; ++b) {
          motions(b, next) = state.q[partition_.boundary(b)];
          changes[static_cast<std::size_t>(b)].row(next) = there.row(partition_.boundary(b));
        }
        ++next;
      });
  out.events = run.events;
  out.end = run.end;
  out.motion.resize(nb * block);
  Eigen::MatrixXd by(nb * block, unknown);
  for (Eigen::Index b = 0; b < nb; ++b) {
    out.motion.segment(b * block, block) = waves * motions.row(b).transpose();
    by.middleRows(b * block, block) = waves * changes[static_cast<std::size_t>(b)];
  }

  out.newton = {Eigen::MatrixXd(unknown, unknown), Eigen::VectorXd(unknown)};
  out.newton.r.head(N) = stacked(run.end) - stacked(start);
  out.newton.J.topRows(N) = run.monodromy;
  double force_size = 0.0;
  if (nb > 0) {
    const Eigen::VectorXd answer = partition_.own_coupling() + partition_.coupling_by(out.motion);
    if (scale_.size() == 0) force_size = std::max(largest_entry(answer), largest_entry(point.coupling));
    out.newton.r.tail(nb * block) = point.coupling - answer;
    out.newton.J.bottomRows(nb * block) = -partition_.coupling_by(by);
    out.newton.J.bottomRightCorner(nb * block, nb * block).diagonal().array() += 1.0;
  }
  out.newton.J.topLeftCorner(N, N).diagonal().array() -= 1.0;
  if (!out.newton.J.allFinite() || !out.newton.r.allFinite())
    throw NumericalFailure("the tangent flow near the contacts is not finite", start.time, stacked(start),
                           std::numeric_limits<double>::quiet_NaN());
  if (scale_.size() == 0) {
    scale_ = Eigen::VectorXd::Constant(unknown, force_size > 0.0 ? force_size : 1.0);
    scale_.head(N) = coordinate_scale(near, start, run.end, period());
  }
  out.newton.r = out.newton.r.cwiseQuotient(scale_).eval();
  out.newton.J = scale_.cwiseInverse().asDiagonal() * out.newton.J * scale_.asDiagonal();
  out.norm = out.newton.r.norm();
  out.largest = largest_entry(out.newton.r);
  return out;
}

std::optional<MixedPoint> MixedProblem::moved(const MixedEvaluation& at, const Eigen::VectorXd& step,
                                              double /*share*/) const {
  const Eigen::Index N = stacked(at.point.start).size();
  MixedPoint out = at.point;
  out.start = with_coordinates(out.start, stacked(at.point.start) + scale_.head(N).cwiseProduct(step.head(N)));
  out.start.modes = at.end.modes;
  out.coupling += scale_.tail(step.size() - N).cwiseProduct(step.tail(step.size() - N));
  put_on_constraint(system_at(out), out.start);
  return out;
}

}  // namespace slipmode::orbits
