#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/periodic_orbit.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace slipmode::orbits {
namespace {

constexpr int kIntervals = 4;                    // of a panel
constexpr int kConditions = 2 * kIntervals + 2;  // values and slopes at its nodes
constexpr int kGauss = 10;
constexpr int kMaxPanels = 1 << 14;

/// Gauss' rule of ten points on [−1, 1] (positive half).
constexpr std::array<double, 5> kGaussPoint{0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                            0.8650633666889845, 0.9739065285171717};
constexpr std::array<double, 5> kGaussWeight{0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                             0.1494513491505806, 0.0666713443086881};

/// Powers 1, s, s² … and their derivatives.
Eigen::RowVectorXd powers(double s) {
  Eigen::RowVectorXd row(kConditions);
  double power = 1.0;
  for (int k = 0; k < kConditions; ++k, power *= s) row[k] = power;
  return row;
}
Eigen::RowVectorXd slopes(double s) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(kConditions);
  double power = 1.0;
  for (int k = 1; k < kConditions; ++k, power *= s) row[k] = k * power;
  return row;
}

/// Values and slopes at the five nodes of [−1, 1] → coefficients of the polynomial through them.
Eigen::MatrixXd hermite_basis() {
  Eigen::MatrixXd conditions(kConditions, kConditions);
  for (int j = 0; j <= kIntervals; ++j) {
    const double s = -1.0 + 2.0 * j / kIntervals;
    conditions.row(j) = powers(s);
    conditions.row(kIntervals + 1 + j) = slopes(s);
  }
  return conditions.partialPivLu().inverse();
}

/// ∫y, ∫(y − shift)² and extremes gathered over panels.
struct Sums {
  double shift = 0.0, time = 0.0, first = 0.0, second = 0.0;
  double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();
  double min_time = 0.0, max_time = 0.0;
  double terms = 0.0;  ///< largest of what y is a sum of

  void candidate(double t, double y) {
    if (y < min) min = y, min_time = t;
    if (y > max) max = y, max_time = t;
  }
};

/// The root of the slope between two nodes of a panel where it has opposite signs: bisection safeguarded by secants.
double slope_root(const Eigen::VectorXd& coefficients, double left, double right) {
  double at_left = slopes(left) * coefficients, at_right = slopes(right) * coefficients;
  for (int k = 0; k < 80 && right - left > 1e-15; ++k) {
    const double secant = left - at_left * (right - left) / (at_right - at_left);
    const double middle = k % 3 == 2 || !(secant > left && secant < right) ? 0.5 * (left + right) : secant;
    const double here = slopes(middle) * coefficients;
    if (here == 0.0) return middle;
    (here < 0) == (at_left < 0) ? (left = middle, at_left = here) : (right = middle, at_right = here);
  }
  return 0.5 * (left + right);
}

class Measure {
 public:
  Measure(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Eigen::VectorXd& row)
      : system_(system), orbit_(orbit), row_(row), basis_(hermite_basis()) {
    for (std::size_t k = 0; k < kGaussPoint.size(); ++k) {
      at_gauss_.row(static_cast<Eigen::Index>(2 * k)) = powers(kGaussPoint[k]) * basis_;
      at_gauss_.row(static_cast<Eigen::Index>(2 * k + 1)) = powers(-kGaussPoint[k]) * basis_;
    }
  }

  /// Over one period, every stretch between events cut into `panels`.
  [[nodiscard]] Sums over_period(int panels) const {
    Sums sums;
    sums.shift = row_.dot(orbit_.start.q);
    dynamics::State state = orbit_.start;
    const double end = orbit_.start.time + orbit_.period;
    for (std::size_t k = 0; k <= orbit_.events.size(); ++k) {
      const double length = (k < orbit_.events.size() ? orbit_.events[k].time : end) - state.time;
      if (length > 1e-13 * orbit_.period) state = add_stretch(state, length, panels, sums);
    }
    return sums;
  }

 private:
  dynamics::State add_stretch(const dynamics::State& from, double length, int panels, Sums& sums) const {
    const dynamics::Trajectory run = simulate(system_, from,
                                              {.duration = length,
                                               .sample = length / (kIntervals * panels),
                                               .keep_events = false,
                                               .flow = {.tolerance = 1e-12, .audit = false}});
    const Eigen::VectorXd y = run.q.transpose() * row_, slope = run.v.transpose() * row_;
    const double half = 0.5 * length / panels;
    for (int p = 0; p < panels; ++p) {
      Eigen::VectorXd given(kConditions);
      const Eigen::Index at = Eigen::Index{kIntervals} * p;
      given << y.segment<kIntervals + 1>(at).array() - sums.shift, half * slope.segment<kIntervals + 1>(at);
      add_panel(from.time + half * (2 * p + 1), half, given, sums);
    }
    sums.time += length;
    sums.terms = std::max(sums.terms, row_.lpNorm<1>() * run.q.cwiseAbs().maxCoeff());
    return run.final_state;
  }

  void add_panel(double centre, double half, const Eigen::VectorXd& given, Sums& sums) const {
    const Eigen::VectorXd values = at_gauss_ * given;
    for (std::size_t k = 0; k < kGaussPoint.size(); ++k)
      for (const Eigen::Index side : {0, 1}) {
        const double value = values[static_cast<Eigen::Index>(2 * k) + side];
        sums.first += half * kGaussWeight[k] * value;
        sums.second += half * kGaussWeight[k] * value * value;
      }
    const Eigen::VectorXd coefficients = basis_ * given;
    for (int j = 0; j <= kIntervals; ++j) {
      const double s = -1.0 + 2.0 * j / kIntervals;
      sums.candidate(centre + half * s, sums.shift + given[j]);
      if (j == kIntervals) break;
      const double here = given[kIntervals + 1 + j], next = given[kIntervals + 2 + j];
      if ((here < 0) == (next < 0)) continue;
      const double root = slope_root(coefficients, s, s + 2.0 / kIntervals);
      sums.candidate(centre + half * root, sums.shift + powers(root).dot(coefficients));
    }
  }

  const dynamics::HybridSystem& system_;
  const PeriodicOrbit& orbit_;
  const Eigen::VectorXd& row_;
  Eigen::MatrixXd basis_;
  Eigen::Matrix<double, kGauss, kConditions> at_gauss_;
};

/// What a place rounds by, of the terms it is a sum of: the range of a contact that sticks throughout.
constexpr double kRoundingOfTerms = 1e-13;

Amplitude from_sums(const Sums& sums) {
  const double mean = sums.first / sums.time;
  const double variance = sums.second / sums.time - mean * mean;
  return {.min = sums.min,
          .max = sums.max,
          .min_time = sums.min_time,
          .max_time = sums.max_time,
          .mean = sums.shift + mean,
          .alternating = 0.5 * (sums.max - sums.min),
          .effective = std::sqrt(std::max(variance, 0.0))};
}

}  // namespace

Amplitude amplitude(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit, const Eigen::VectorXd& row) {
  if (row.size() != system.size())
    throw InvalidInput("an amplitude was asked of a row of " + std::to_string(row.size()) +
                       " entries; the system has " + std::to_string(system.size()) + " degrees of freedom");
  const Measure measure(system, orbit, row);
  Amplitude coarse = from_sums(measure.over_period(4));
  for (int panels = 8; panels <= kMaxPanels; panels *= 2) {
    const Sums sums = measure.over_period(panels);
    const Amplitude fine = from_sums(sums);
    const double change = std::max({std::abs(fine.mean - coarse.mean), std::abs(fine.effective - coarse.effective),
                                    std::abs(fine.alternating - coarse.alternating)});
    const double range = std::max(fine.alternating, 1e-3 * std::abs(fine.mean));
    if (change <= std::max(1e-10 * range, kRoundingOfTerms * sums.terms)) return fine;
    coarse = fine;
  }
  throw NumericalFailure("the amplitude of an orbit did not settle to 1e-10 of its range with " +
                             std::to_string(kMaxPanels) + " panels between events",
                         orbit.start.time, stacked(orbit.start), coarse.alternating);
}

std::vector<Amplitude> contact_amplitudes(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  std::vector<Amplitude> amplitudes;
  for (const friction::Contact& contact : system.contacts()) {
    Amplitude own = amplitude(system, orbit, contact.direction);
    own.min += contact.offset;
    own.max += contact.offset;
    own.mean += contact.offset;
    amplitudes.push_back(own);
  }
  return amplitudes;
}

}  // namespace slipmode::orbits
