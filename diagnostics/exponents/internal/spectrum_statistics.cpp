#include "diagnostics/exponents/internal/spectrum_statistics.hpp"

#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/exponents/lyapunov.hpp>
#include <slipmode/diagnostics/series/kaplan_yorke.hpp>
#include "diagnostics/series/internal/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace slipmode::diagnostics {
namespace {

constexpr double kLost = -std::numeric_limits<double>::infinity();

/// @param zero  index of the exponent to be taken as zero, or −1. NaN where leading exponents alone do not reach a
/// negative sum.
double dimension_of(Eigen::VectorXd exponents, Eigen::Index zero, Eigen::Index size) {
  if (zero >= 0) exponents[zero] = 0.0;
  // A neutral direction (a floating structure's) leaves rounding of either sign.
  constexpr double kRounding = 1e-12;
  const double largest = exponents.unaryExpr([](double x) { return std::isfinite(x) ? std::abs(x) : 0.0; }).maxCoeff();
  for (double& exponent : exponents)
    if (std::abs(exponent) <= kRounding * largest) exponent = 0.0;
  if (exponents.size() < size && exponents.sum() >= 0.0) return kNone;
  return kaplan_yorke_dimension(exponents);
}

/// Index of the exponent that is zero in a self-excited system, the nearest to zero; −1 where none is within its error.
Eigen::Index vanishing(const LyapunovSpectrum& spectrum, Eigen::Index finite) {
  // The motion's own direction keeps its length up to a factor that does not grow.
  constexpr double kLogOfFactor = 5.0;
  if (!spectrum.self_excited || finite == 0) return -1;
  Eigen::Index nearest = 0;
  const double least = spectrum.nats.head(finite).cwiseAbs().minCoeff(&nearest);
  const double error = std::isfinite(spectrum.error[nearest]) ? kErrorsOfPositive * spectrum.error[nearest] : 0.0;
  return least <= error + kLogOfFactor / spectrum.duration ? nearest : -1;
}

/// How far growth strays from its trend, per length of the record: the error that its ends leave to a regular motion,
/// whose equal stretches may all err by the same. Of a random walk it is 0.6 standard errors.
Eigen::VectorXd error_of_ends(const Eigen::MatrixXd& rates) {
  const auto m = static_cast<double>(rates.cols());
  const Eigen::VectorXd mean = rates.rowwise().mean();
  Eigen::VectorXd stray = Eigen::VectorXd::Zero(rates.rows()), low = stray, high = stray;
  for (const auto& rate : rates.colwise()) {
    stray += rate - mean;
    low = low.cwiseMin(stray);
    high = high.cwiseMax(stray);
  }
  return 0.5 * (high - low) / m;
}

/// Directions that have not parted over the record by a factor of e³ share their growth: only its sum is told.
void widen_unparted(const LyapunovSpectrum& spectrum, Eigen::Index finite, Eigen::VectorXd& out_error) {
  constexpr double kParted = 3.0;
  for (Eigen::Index i = 1; i < finite; ++i) {
    const double apart = spectrum.nats[i - 1] - spectrum.nats[i];
    if (apart * spectrum.duration >= kParted) continue;
    for (const Eigen::Index j : {i - 1, i}) out_error[j] = std::max(out_error[j], 0.5 * apart);
  }
}

/// By leaving out one stretch at a time. @param parts  finite exponents of the stretches; @param lost  −∞ ones behind
double dimension_error(const Eigen::MatrixXd& parts, Eigen::Index lost, Eigen::Index zero, Eigen::Index size) {
  Eigen::VectorXd without(kStretches);
  Eigen::VectorXd exponents = Eigen::VectorXd::Constant(parts.rows() + lost, kLost);
  for (Eigen::Index s = 0; s < kStretches; ++s) {
    exponents.head(parts.rows()) = (parts.rowwise().sum() - parts.col(s)) / static_cast<double>(kStretches - 1);
    without[s] = dimension_of(exponents, zero, size);
  }
  const double mean = without.mean();
  return std::sqrt((without.array() - mean).square().sum() * (kStretches - 1) / kStretches);
}

}  // namespace

Eigen::VectorXd LyapunovSpectrum::bits() const { return nats / std::numbers::ln2; }

Eigen::MatrixXd LyapunovSpectrum::running() const {
  Eigen::MatrixXd means = rates;
  for (Eigen::Index j = 1; j < means.cols(); ++j) means.col(j) += means.col(j - 1);
  for (Eigen::Index j = 0; j < means.cols(); ++j) means.col(j) /= static_cast<double>(j + 1);
  return means;
}

bool LyapunovSpectrum::is_chaotic() const { return nats.size() > 0 && nats[0] > kErrorsOfPositive * error[0]; }

bool LyapunovSpectrum::is_undecided() const {
  if (nats.size() == 0 || is_chaotic() || nats[0] <= error[0]) return false;  // an error not known: not within it
  return nats[0] * duration > 1.0;
}

void summarise(LyapunovSpectrum& spectrum, const Eigen::Ref<const Eigen::MatrixXd>& growth) {
  const Eigen::Index k = growth.rows(), m = growth.cols();
  const Eigen::Index finite = std::min(k, spectrum.size - spectrum.lost);
  const Eigen::MatrixXd unordered = growth.topRows(finite) / spectrum.interval;
  const Eigen::VectorXd mean = unordered.rowwise().mean();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(finite));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&mean](Eigen::Index a, Eigen::Index b) { return mean[a] > mean[b]; });
  const Eigen::MatrixXd ordered = unordered(order, Eigen::all);

  spectrum.duration = spectrum.interval * static_cast<double>(m);
  spectrum.rates = Eigen::MatrixXd::Constant(k, m, kLost);
  spectrum.rates.topRows(finite) = ordered;
  spectrum.nats = Eigen::VectorXd::Constant(k, kLost);
  spectrum.nats.head(finite) = mean(order);
  spectrum.halves = Eigen::MatrixXd::Constant(k, 2, m < 2 ? kNone : kLost);
  spectrum.error = Eigen::VectorXd::Constant(k, 0.0);
  spectrum.error.head(finite).setConstant(kNone);
  spectrum.dimension_error = kNone;
  if (m >= 2) spectrum.halves.topRows(finite) = stretch_means(ordered, 2);
  if (m < kStretches) {
    spectrum.dimension = dimension_of(spectrum.nats, vanishing(spectrum, finite), spectrum.size);
    return;
  }
  const Eigen::MatrixXd parts = stretch_means(ordered);
  Eigen::VectorXd error = standard_error(parts).cwiseMax(error_of_ends(ordered));
  widen_unparted(spectrum, finite, error);
  spectrum.error.head(finite) = error;
  const Eigen::Index zero = vanishing(spectrum, finite);
  spectrum.dimension = dimension_of(spectrum.nats, zero, spectrum.size);
  // Where a sum of exponents may be of either sign the dimension jumps, if not from stretch to stretch.
  Eigen::VectorXd most = spectrum.nats, least = spectrum.nats;
  most.head(finite) += error;
  least.head(finite) -= error;
  const double spread = dimension_of(most, zero, spectrum.size) - dimension_of(least, zero, spectrum.size);
  spectrum.dimension_error = std::max(dimension_error(parts, k - finite, zero, spectrum.size), 0.5 * spread);
}

}  // namespace slipmode::diagnostics
