#include <slipmode/diagnostics/validation/driven_compare.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/median.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/series/point_sets.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {

namespace {

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? kNone : sum / static_cast<double>(values.size());
}

std::vector<double> section_points(const DrivenMotion& motion, Eigen::Index reading) {
  if (reading < 0 || reading >= motion.readings.rows()) {
    throw InvalidInput(fmt::format("driven sweeps: expected a reading between 0 and {}, found {}",
                                   motion.readings.rows() - 1, reading));
  }
  const Eigen::VectorXd row = motion.readings.row(reading);
  return {row.begin(), row.end()};
}

/// In units of the full motion's size; a motion at rest is measured in its own unit.
double unit_of(const DrivenMotion& full, Eigen::Index reading) {
  return full.rms(reading) > 0.0 ? full.rms(reading) : 1.0;
}

void check_same_values(const std::vector<DrivenPoint>& a, const std::vector<DrivenPoint>& b) {
  if (a.size() != b.size()) {
    throw InvalidInput(
        fmt::format("driven sweeps: expected as many points in both, found {} and {}", a.size(), b.size()));
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].parameter == b[i].parameter) continue;
    throw InvalidInput(
        fmt::format("driven sweeps: expected the same values in the same order, found {} and {} at place {}",
                    a[i].parameter, b[i].parameter, i));
  }
}

}  // namespace

bool same_period(const DrivenPeriod& a, const DrivenPeriod& b) { return a.period == b.period; }

DrivenAgreement compare_driven(const std::vector<DrivenPoint>& full, const std::vector<DrivenPoint>& reduced,
                               Eigen::Index reading) {
  check_same_values(full, reduced);
  DrivenAgreement out;
  std::vector<double> hausdorffs, found;
  double same_labels = 0.0, same_periods = 0.0, decided = 0.0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    out.wasserstein.push_back(kNone);
    if (!full[i].ok() || !reduced[i].ok()) {
      ++out.failed;
      continue;
    }
    ++out.values;
    const DrivenMotion &a = full[i].settled, &b = reduced[i].settled;
    same_labels += a.label == b.label ? 1.0 : 0.0;
    if (a.period.repeat != DrivenRepeat::kUndecided && b.period.repeat != DrivenRepeat::kUndecided) {
      ++decided;
      same_periods += same_period(a.period, b.period) ? 1.0 : 0.0;
    }
    const std::vector<double> p = section_points(a, reading), q = section_points(b, reading);
    out.wasserstein.back() = wasserstein(p, q) / unit_of(a, reading);
    found.push_back(out.wasserstein.back());
    hausdorffs.push_back(hausdorff(p, q) / unit_of(a, reading));
  }
  if (out.values > 0) out.same_label = same_labels / static_cast<double>(out.values);
  if (decided > 0.0) out.same_period = same_periods / decided;
  out.mean_wasserstein = mean_of(found);
  out.median_wasserstein = median(found);
  out.mean_hausdorff = mean_of(hausdorffs);
  return out;
}

double hysteresis(const std::vector<DrivenPoint>& forward, const std::vector<DrivenPoint>& reverse,
                  Eigen::Index reading) {
  constexpr double kSame = 0.01;
  const std::vector<DrivenPoint> turned(reverse.rbegin(), reverse.rend());
  const DrivenAgreement agreement = compare_driven(forward, turned, reading);
  double different = 0.0;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (!forward[i].ok() || !turned[i].ok()) continue;
    const DrivenMotion &up = forward[i].settled, &down = turned[i].settled;
    const bool repeats = up.period.period > 0 && down.period.period > 0;
    const bool apart = repeats && agreement.wasserstein[i] > kSame;
    different += up.label != down.label || !same_period(up.period, down.period) || apart ? 1.0 : 0.0;
  }
  return agreement.values > 0 ? different / static_cast<double>(agreement.values) : kNone;
}

std::vector<AmplitudePeak> amplitude_peaks(const std::vector<DrivenPoint>& points, Eigen::Index reading) {
  constexpr double kLeastRise = 0.05;
  std::vector<AmplitudePeak> curve;
  double largest = 0.0;
  for (const DrivenPoint& point : points) {
    if (!point.ok()) continue;
    curve.push_back({point.parameter, std::numbers::sqrt2 * point.settled.rms(reading)});
    largest = std::max(largest, curve.back().amplitude);
  }
  // A peak's ground on one side: the lowest value on the way to something higher, or to the end.
  const auto rise = [&curve](std::size_t at, int direction) {
    double ground = curve[at].amplitude;
    for (std::size_t i = at; direction > 0 ? i + 1 < curve.size() : i > 0;) {
      i = direction > 0 ? i + 1 : i - 1;
      if (curve[i].amplitude > curve[at].amplitude) break;
      ground = std::min(ground, curve[i].amplitude);
    }
    return curve[at].amplitude - ground;
  };
  std::vector<AmplitudePeak> peaks;
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    const bool highest = curve[i].amplitude > curve[i - 1].amplitude && curve[i].amplitude >= curve[i + 1].amplitude;
    if (highest && std::min(rise(i, -1), rise(i, 1)) >= kLeastRise * largest) peaks.push_back(curve[i]);
  }
  return peaks;
}

}  // namespace slipmode::diagnostics
