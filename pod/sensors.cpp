#include <slipmode/pod/sensors.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/random.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::pod {

namespace {

constexpr double kSamePlace = 1e-9;   // of the beam's reach
constexpr double kEnd = 1.0 + 1e-12;  // positions computed by arithmetic miss the ends by rounding

std::string label(const Sensor& sensor, std::size_t index) {
  return fmt::format("sensor {} (from 1), {} at x = {} m", index + 1,
                     sensor.kind == SensorKind::kStrain ? "strain" : "displacement", sensor.x);
}

void check_place(const fem::Beam& beam, const Sensor& sensor, std::size_t index) {
  if (sensor.kind == SensorKind::kDisplacement) {
    if (sensor.x > 0.0 && sensor.x <= kEnd * beam.reach()) return;
    throw InvalidInput(fmt::format("{}: off the beam; expected 0 < x <= {} m (the clamp at 0 does not move)",
                                   label(sensor, index), beam.reach()));
  }
  if (sensor.x >= 0.0 && sensor.x <= kEnd * beam.length()) return;
  if (sensor.x > beam.length() && sensor.x <= kEnd * beam.reach()) {
    throw InvalidInput(fmt::format(
        "{}: on the rigid extension, which does not bend; expected 0 <= x <= {} m, or a displacement sensor",
        label(sensor, index), beam.length()));
  }
  throw InvalidInput(fmt::format("{}: off the beam; expected 0 <= x <= {} m", label(sensor, index), beam.length()));
}

void check_distinct(const fem::Beam& beam, const std::vector<Sensor>& sensors, std::size_t index) {
  for (std::size_t j = 0; j < index; ++j) {
    if (sensors[j].kind != sensors[index].kind) continue;
    if (std::abs(sensors[j].x - sensors[index].x) > kSamePlace * beam.reach()) continue;
    throw InvalidInput(
        fmt::format("{}: in the same place as sensor {}; remove one or move it", label(sensors[index], index), j + 1));
  }
}

double rms_about_mean(const Eigen::Ref<const Eigen::RowVectorXd>& signal) {
  const double mean = signal.mean();
  return std::sqrt((signal.array() - mean).square().mean());
}

}  // namespace

std::vector<Sensor> sensors_at(SensorKind kind, std::span<const double> x) {
  std::vector<Sensor> sensors;
  for (const double place : x) sensors.push_back({kind, place});
  return sensors;
}

std::vector<Sensor> evenly_spaced(Eigen::Index count, double span) {
  if (count < 1 || !(span > 0.0) || !std::isfinite(span)) {
    throw InvalidInput(
        fmt::format("sensors: {} evenly spaced over {} m; expected at least 1 over a positive length", count, span));
  }
  std::vector<Sensor> sensors;
  for (Eigen::Index i = 1; i < count; ++i) {
    sensors.push_back({SensorKind::kDisplacement, span * static_cast<double>(i) / static_cast<double>(count)});
  }
  sensors.push_back({SensorKind::kDisplacement, span});
  return sensors;
}

SensorArray::SensorArray(const fem::Beam& beam, std::vector<Sensor> sensors) : sensors_(std::move(sensors)) {
  if (sensors_.empty()) throw InvalidInput("sensors: none given; expected at least one");
  rows_.resize(static_cast<Eigen::Index>(sensors_.size()), beam.structure().size());
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    check_place(beam, sensors_[i], i);
    check_distinct(beam, sensors_, i);
    const double x = sensors_[i].x;
    rows_.row(static_cast<Eigen::Index>(i)) =
        (sensors_[i].kind == SensorKind::kStrain ? beam.strain_row(x) : beam.displacement_row(x)).transpose();
  }
}

Eigen::MatrixXd SensorArray::readings(const Eigen::MatrixXd& q) const {
  if (q.rows() != rows_.cols()) {
    throw InvalidInput(
        fmt::format("sensors: displacements have {} rows; expected {}, one per degree of freedom of the "
                    "beam",
                    q.rows(), rows_.cols()));
  }
  return rows_ * q;
}

bool SensorArray::all(SensorKind kind) const {
  return std::ranges::all_of(sensors_, [kind](const Sensor& sensor) { return sensor.kind == kind; });
}

Eigen::MatrixXd with_noise(const Eigen::MatrixXd& readings, const Noise& noise) {
  if (!(noise.deviation >= 0.0) || !std::isfinite(noise.deviation)) {
    throw InvalidInput(
        fmt::format("noise: standard deviation {}; expected a finite number, at least 0", noise.deviation));
  }
  if (readings.size() == 0 || !readings.allFinite()) {
    throw InvalidInput(
        fmt::format("noise: {} x {} readings; expected at least one, all finite", readings.rows(), readings.cols()));
  }
  Eigen::MatrixXd noisy = readings;
  for (Eigen::Index i = 0; i < readings.rows(); ++i) {
    Random random = Random::stream(noise.seed, static_cast<std::uint64_t>(i));
    const double unit = noise.scale == NoiseScale::kRelativeRms ? rms_about_mean(readings.row(i)) : 1.0;
    for (Eigen::Index t = 0; t < readings.cols(); ++t) noisy(i, t) += noise.deviation * unit * random.normal();
  }
  return noisy;
}

}  // namespace slipmode::pod
