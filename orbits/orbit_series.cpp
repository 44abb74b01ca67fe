#include <slipmode/orbits/orbit_series.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/legendre_panel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace slipmode::orbits {
namespace {

using dynamics::State;

constexpr int kTerms = OrbitSeries::kTerms;
static_assert(kTerms == LegendrePanel::kTerms);
/// Last terms below this share of a quantity's size are rounding.
constexpr double kResolved = 1e-14;
/// Displacements and velocities round by all of the motion: of a contact that sticks nothing else is left.
constexpr double kMotionRounding = 16.0 * std::numeric_limits<double>::epsilon();
/// Where halving a panel no longer lowers its last terms they are the flow's own error, if they are below this.
constexpr double kNoise = 1e-9;
constexpr double kShortest = 1.0 / 16384.0;

/// Spherical Bessel functions j_0 … j_15 at x ≥ 0: upward where that is stable, else downward from far above (Miller),
/// put to scale by the larger of the first two.
Eigen::Vector<double, kTerms> spherical_bessel(double x) {
  Eigen::Vector<double, kTerms> j = Eigen::Vector<double, kTerms>::Zero();
  if (x < 1e-8) {  // j_1 = x/3, j_2 below rounding
    j[0] = 1.0;
    j[1] = x / 3.0;
    return j;
  }
  const double first = std::sin(x) / x;
  const double second = x < 0.05 ? x / 3.0 * (1.0 - x * x / 10.0 * (1.0 - x * x / 28.0)) : (first - std::cos(x)) / x;
  if (x > kTerms) {
    j[0] = first;
    j[1] = second;
    for (int n = 1; n + 1 < kTerms; ++n) j[n + 1] = (2 * n + 1) / x * j[n] - j[n - 1];
    return j;
  }
  double above = 0.0, here = 1e-300;
  for (int n = kTerms + 30; n > 0; --n) {
    const double below = (2 * n + 1) / x * here - above;
    above = here;
    here = below;
    if (n - 1 < kTerms) j[n - 1] = here;
    if (std::abs(here) > 1e200) {
      above *= 1e-200;
      here *= 1e-200;
      j *= 1e-200;
    }
  }
  return j * (std::abs(first) > std::abs(second) ? first / j[0] : second / j[1]);
}

/// 64 samples of it.
dynamics::Trajectory coarse_look(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  constexpr double kLooks = 64.0;
  return simulate(system, orbit.start,
                  {.duration = orbit.period,
                   .sample = orbit.period / kLooks,
                   .keep_events = false,
                   .flow = {.tolerance = 1e-13, .audit = false}});
}

/// Of its displacements and, where all is at rest, of what the contacts' forces would move.
double size_of_run(const dynamics::HybridSystem& system, const dynamics::Trajectory& run, double period) {
  const double radian = period / (2.0 * std::numbers::pi);
  double q = std::max(run.q.cwiseAbs().maxCoeff(), run.v.cwiseAbs().maxCoeff() * radian);
  for (Eigen::Index c = 0; c < run.lambda.rows(); ++c) {
    const Eigen::VectorXd& w = system.contacts()[static_cast<std::size_t>(c)].direction;
    const double stiffness = w.dot(fem::multiply(system.structure().K(), w).col(0)) / w.squaredNorm();
    if (stiffness > 0.0) q = std::max(q, run.lambda.row(c).cwiseAbs().maxCoeff() / stiffness);
  }
  return q;
}

/// Cuts the stays of an orbit into panels.
class Cutter {
 public:
  Cutter(const dynamics::HybridSystem& system, const Eigen::MatrixXd& rows, double period)
      : system_(system), rows_(rows), shortest_(kShortest * period) {}

  /// Sizes of all quantities, from a coarse look.
  void measure(const PeriodicOrbit& orbit) {
    const dynamics::Trajectory run = coarse_look(system_, orbit);
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      const Eigen::VectorXd now = quantities(run, k);
      if (k == 0) size_ = now.cwiseAbs();
      size_ = size_.cwiseMax(now.cwiseAbs());
    }
    const Eigen::Index nc = run.contact_q.rows();
    const double q = size_of_run(system_, run, orbit.period);
    const double v = q * 2.0 * std::numbers::pi / orbit.period;
    rounding_ = Eigen::VectorXd::Zero(size_.size());
    for (Eigen::Index c = 0; c < nc; ++c) {
      const double reach = system_.contacts()[static_cast<std::size_t>(c)].direction.lpNorm<1>();
      rounding_[c] = kMotionRounding * reach * q;
      rounding_[nc + c] = kMotionRounding * reach * v;
    }
    for (Eigen::Index r = 0; r < rows_.cols(); ++r) {
      rounding_[3 * nc + r] = kMotionRounding * rows_.col(r).lpNorm<1>() * q;
      rounding_[3 * nc + rows_.cols() + r] = kMotionRounding * rows_.col(r).lpNorm<1>() * v;
    }
  }

  /// A stay from `state` on; its last state.
  State cut(const State& state, double length) { return add(state, length, 1e300); }

  std::vector<OrbitSeries::Panel> panels;
  double defect = 0.0;

 private:
  [[nodiscard]] Eigen::VectorXd quantities(const dynamics::Trajectory& run, Eigen::Index k) const {
    Eigen::VectorXd all(3 * run.contact_q.rows() + 2 * rows_.cols());
    all << run.contact_q.col(k), run.contact_v.col(k), run.lambda.col(k), rows_.transpose() * run.q.col(k),
        rows_.transpose() * run.v.col(k);
    return all;
  }

  /// @param before  last terms of the panel that this is a half of
  State add(const State& from, double length, double before) {
    OrbitSeries::Panel panel{.middle = from.time + 0.5 * length, .half = 0.5 * length, .terms = {}};
    Eigen::MatrixXd values(size_.size(), kTerms);
    State state = from;
    double passed = 0.0;
    const auto go_on = [&](double to) {
      const double step = to - passed;
      dynamics::Trajectory run = simulate(
          system_, state,
          {.duration = step, .sample = step, .keep_events = false, .flow = {.tolerance = 1e-13, .audit = false}});
      passed = to;
      state = std::move(run.final_state);
      return run;
    };
    for (int i = 0; i < kTerms; ++i) {
      const dynamics::Trajectory run =
          go_on(panel.half * (1.0 + LegendrePanel::rule().point[static_cast<std::size_t>(i)]));
      values.col(i) = quantities(run, run.times.size() - 1);
    }
    panel.terms = values * LegendrePanel::rule().to_terms;
    double last = 0.0;
    for (Eigen::Index r = 0; r < size_.size(); ++r)
      if (const double own = panel.terms.row(r).tail<2>().cwiseAbs().maxCoeff(); own > rounding_[r])
        last = std::max(last, own / std::max(size_[r], values.row(r).cwiseAbs().maxCoeff()));
    const bool noise = last < kNoise && last > 0.25 * before;
    if (last > kResolved && !noise) {
      if (length < shortest_)
        throw NumericalFailure("a panel of " + std::to_string(length) + " s still leaves " + std::to_string(last) +
                                   " of a quantity's size out of its series",
                               from.time, stacked(from), last);
      const State middle = add(from, 0.5 * length, last);
      return add(middle, 0.5 * length, last);
    }
    static_cast<void>(go_on(length));
    defect = std::max(defect, last);
    panels.push_back(std::move(panel));
    return state;
  }

  const dynamics::HybridSystem& system_;
  const Eigen::MatrixXd& rows_;
  double shortest_;
  Eigen::VectorXd size_, rounding_;
};

}  // namespace

double size_of_motion(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  return size_of_run(system, coarse_look(system, orbit), orbit.period);
}

OrbitSeries::OrbitSeries(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Eigen::MatrixXd& rows)
    : contacts_(static_cast<Eigen::Index>(system.contacts().size())),
      rows_(rows.cols()),
      start_(std::fmod(orbit.start.time, orbit.period)),
      period_(orbit.period) {
  if (rows.cols() > 0 && rows.rows() != system.size())
    throw InvalidInput("an orbit's series was asked of rows of " + std::to_string(rows.rows()) +
                       " entries; the system has " + std::to_string(system.size()) + " degrees of freedom");
  const Eigen::MatrixXd chosen = rows.cols() > 0 ? rows : Eigen::MatrixXd(system.size(), 0);
  Cutter cutter(system, chosen, period_);
  cutter.measure(orbit);
  State state = orbit.start;
  state.time = start_;  // whole periods earlier: a clock that has run long has fewer digits for instants
  const double end = start_ + period_;
  for (std::size_t k = 0; k <= orbit.events.size(); ++k) {
    const double next = k < orbit.events.size() ? start_ + (orbit.events[k].time - orbit.start.time) : end;
    const double length = next - state.time;
    if (length > 1e-13 * period_) state = cutter.cut(state, length);
  }
  panels_ = std::move(cutter.panels);
  defect_ = cutter.defect;
}

Eigen::VectorXd OrbitSeries::at(double time) const {
  const double within = time - start_;
  const double t = start_ + (within - period_ * std::floor(within / period_));
  const auto next = std::upper_bound(panels_.begin(), panels_.end(), t,
                                     [](double value, const Panel& p) { return value < p.middle - p.half; });
  const Panel& panel = next == panels_.begin() ? *next : *(next - 1);
  return panel.terms * LegendrePanel::polynomials((t - panel.middle) / panel.half);
}

Eigen::VectorXcd OrbitSeries::coefficient(int order) const {
  // ∫ P_j(s) e^{−iκs} ds over [−1, 1] = 2 (−i)^j j_j(κ).
  const double rate = 2.0 * std::numbers::pi * order / period_;
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(3 * contacts_ + 2 * rows_);
  for (const Panel& panel : panels_) {
    const Eigen::Vector<double, kTerms> bessel = spherical_bessel(rate * panel.half);
    Eigen::Vector<double, kTerms> even = bessel, odd = bessel;  // (−i)^j = 1, −i, −1, i, …
    for (int j = 0; j < kTerms; ++j) {
      (j % 2 == 0 ? odd : even)[j] = 0.0;
      if (j % 4 >= 2) (j % 2 == 0 ? even : odd)[j] *= -1.0;
    }
    const std::complex<double> turn = std::polar(2.0 * panel.half / period_, -rate * panel.middle);
    Eigen::VectorXcd own(sum.size());
    own.real() = panel.terms * even;
    own.imag() = -(panel.terms * odd);
    sum += turn * own;
  }
  return sum;
}

}  // namespace slipmode::orbits
