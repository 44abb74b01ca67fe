#pragma once

#include <slipmode/fem/beam.hpp>
#include <slipmode/pod/sensors.hpp>

#include <array>
#include <cmath>

namespace slipmode::tests {

/// S4's main beam. Values: S4 chapter 4.
inline fem::BeamSpan source_span(int elements) {
  return {.length = 0.4,
          .width = 0.0128,
          .thickness = 0.00086,
          .youngs_modulus = 128e9,
          .density = 7488.0,
          .elements = elements};
}

/// S4's main beam with a tip body whose every number matters.
inline fem::BeamOptions with_tip_body(int elements) {
  return {.spans = {source_span(elements)},
          .tip = {.mass = 0.0155, .inertia = 3e-6, .offset = 0.02, .extension = 0.064}};
}

/// S4's main beam alone.
inline fem::BeamOptions without_tip_body(int elements) { return {.spans = {source_span(elements)}, .tip = {}}; }

inline double bending_stiffness(const fem::BeamSpan& s) {
  return s.youngs_modulus * s.width * s.thickness * s.thickness * s.thickness / 12.0;
}

/// S4's six gauges, numbered from the tip.
inline constexpr std::array<double, 6> kGauges = {0.30, 0.25, 0.20, 0.15, 0.10, 0.05};

inline pod::SensorArray gauges(const fem::Beam& beam) {
  return {beam, pod::sensors_at(pod::SensorKind::kStrain, kGauges)};
}

inline pod::SensorArray places(const fem::Beam& beam) {
  return {beam, pod::sensors_at(pod::SensorKind::kDisplacement, kGauges)};
}

/// Degrees of freedom of Σ c_i (x/L)^i, c from i = 0 up.
inline Eigen::VectorXd polynomial(const fem::Beam& beam, const std::vector<double>& c) {
  const auto count = static_cast<Eigen::Index>(beam.nodes().size());
  Eigen::VectorXd value = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
  for (Eigen::Index node = 0; node < count; ++node) {
    const double s = beam.nodes()[static_cast<std::size_t>(node)] / beam.length();
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double power = static_cast<double>(i);
      value[node] += c[i] * std::pow(s, power);
      if (i > 0) slope[node] += c[i] * power * std::pow(s, power - 1.0) / beam.length();
    }
  }
  return beam.interpolate(value, slope);
}

}  // namespace slipmode::tests
