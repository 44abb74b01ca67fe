#pragma once

#include <slipmode/fem/beam.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace slipmode::pod {

enum class SensorKind {
  kStrain,        ///< reads the bending strain at the surface, ½ thickness · y″(x) [1]
  kDisplacement,  ///< reads y(x) [m]
};

struct Sensor {
  SensorKind kind = SensorKind::kDisplacement;
  double x = 0.0;  ///< from the clamp [m]
};

/// One sensor of a kind at each place.
[[nodiscard]] std::vector<Sensor> sensors_at(SensorKind kind, std::span<const double> x);

/// `count` displacement sensors at x = span/count, 2 span/count, …, span: pseudo-sensors, as many as wanted.
/// @throws InvalidInput  for count < 1 or a span that is not positive
[[nodiscard]] std::vector<Sensor> evenly_spaced(Eigen::Index count, double span);

/// Sensors on a beam. Readings are linear in the beam's degrees of freedom: s = S q.
class SensorArray {
 public:
  /// @throws InvalidInput  naming the sensor, for none at all, a displacement sensor outside 0 < x ≤ L + extension (at
  ///                       the clamp it would read nothing), a strain gauge outside 0 ≤ x ≤ L (a rigid extension does
  ///                       not bend), or two of a kind closer than 1e-9 of the beam's reach
  SensorArray(const fem::Beam& beam, std::vector<Sensor> sensors);

  [[nodiscard]] const std::vector<Sensor>& sensors() const { return sensors_; }
  [[nodiscard]] Eigen::Index size() const { return rows_.rows(); }
  /// S, ns x n
  [[nodiscard]] const Eigen::MatrixXd& rows() const { return rows_; }
  /// S q for every column [ns x T]. @throws InvalidInput  for another number of rows than the beam has dofs
  [[nodiscard]] Eigen::MatrixXd readings(const Eigen::MatrixXd& q) const;
  /// True when every sensor is of this kind.
  [[nodiscard]] bool all(SensorKind kind) const;

 private:
  std::vector<Sensor> sensors_;
  Eigen::MatrixXd rows_;
};

enum class NoiseScale {
  kReading,      ///< deviation is in the unit of the readings
  kRelativeRms,  ///< deviation is a fraction of each sensor's own rms about its mean
};

/// White noise, normal, independent between sensors and instants.
struct Noise {
  double deviation = 0.0;  ///< standard deviation, ≥ 0, on the scale below
  NoiseScale scale = NoiseScale::kRelativeRms;
  std::uint64_t seed = 1;  ///< sensor i (from 0) draws from Random::stream(seed, i): adding sensors changes no other
};

/// @param readings  ns x T, T ≥ 1
/// @throws InvalidInput  for a negative deviation, no readings, or values not finite
[[nodiscard]] Eigen::MatrixXd with_noise(const Eigen::MatrixXd& readings, const Noise& noise);

}  // namespace slipmode::pod
