#include <slipmode/pod/sensors.hpp>

#include <slipmode/core/errors.hpp>
#include "cantilever.hpp"
#include "known.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace slipmode::pod {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const fem::Beam& gauged_beam() {
  static const fem::Beam shared(tests::with_tip_body(20));
  return shared;
}

auto array_of(std::vector<Sensor> sensors) {
  return [sensors] { (void)SensorArray(gauged_beam(), sensors); };
}

TEST(Sensors, ReadAParabolaExactly) {
  // y = a (x/L)²: strain ½h y″ = h a/L² everywhere; beyond the end y(L) + (x − L) y′(L) = a + 2 a (x − L)/L.
  const double a = 3e-3, L = 0.4, h = 0.00086;
  const Eigen::VectorXd q = tests::polynomial(gauged_beam(), {0.0, 0.0, a});
  const SensorArray sensors(gauged_beam(), {{SensorKind::kDisplacement, 0.1},
                                            {SensorKind::kDisplacement, 0.1234},
                                            {SensorKind::kDisplacement, L},
                                            {SensorKind::kDisplacement, 0.464},
                                            {SensorKind::kStrain, 0.0},
                                            {SensorKind::kStrain, 0.2},
                                            {SensorKind::kStrain, L}});
  Eigen::VectorXd expected(7);
  expected << a * 0.0625, a * 0.1234 * 0.1234 / (L * L), a, a * 1.32, h * a / (L * L), h * a / (L * L), h * a / (L * L);
  const Eigen::VectorXd read = sensors.readings(q);
  for (Eigen::Index i = 0; i < 7; ++i) EXPECT_NEAR(read[i], expected[i], 1e-11 * std::abs(expected[i])) << i;
}

TEST(Sensors, EvenlySpacedEndAtTheSpan) {
  const std::vector<Sensor> sensors = evenly_spaced(40, 0.4);
  ASSERT_EQ(sensors.size(), 40U);
  EXPECT_DOUBLE_EQ(sensors[0].x, 0.01);
  EXPECT_EQ(sensors[39].x, 0.4);
  EXPECT_EQ(SensorArray(gauged_beam(), sensors).size(), 40);
}

TEST(Noise, HasTheDeviationAskedFor) {
  // A sine of amplitude 2 about 5 has rms √2 about its mean; the estimate of a deviation from T values has a relative
  // standard error of 1/√(2T) and that of the mean 1/√T: six of them are allowed.
  constexpr Eigen::Index T = 40000;
  Eigen::MatrixXd readings(1, T);
  for (Eigen::Index t = 0; t < T; ++t) {
    readings(0, t) = 5.0 + 2.0 * std::sin(2.0 * std::numbers::pi * static_cast<double>(t) / 100.0);
  }
  for (const auto& [scale, expected] :
       {std::pair{NoiseScale::kRelativeRms, 0.1 * std::numbers::sqrt2}, std::pair{NoiseScale::kReading, 0.1}}) {
    const Eigen::MatrixXd added = with_noise(readings, {.deviation = 0.1, .scale = scale, .seed = 7}) - readings;
    const double deviation = std::sqrt((added.array() - added.mean()).square().mean());
    EXPECT_NEAR(deviation / expected, 1.0, 6.0 / std::sqrt(2.0 * T));
    EXPECT_NEAR(added.mean() / expected, 0.0, 6.0 / std::sqrt(double{T}));
  }
}

TEST(Noise, IsTheSameForTheSameSeedWhateverTheOtherSensors) {
  Random random(3);
  const Eigen::MatrixXd readings = tests::normal_matrix(random, 4, 50);
  const Noise noise{.deviation = 0.3, .seed = 11};
  const Eigen::MatrixXd noisy = with_noise(readings, noise);
  EXPECT_EQ(with_noise(readings, noise), noisy);
  EXPECT_EQ(with_noise(readings.topRows(2), noise), noisy.topRows(2));
  EXPECT_NE(with_noise(readings, {.deviation = 0.3, .seed = 12}), noisy);
  EXPECT_EQ(with_noise(readings, {.deviation = 0.0}), readings);
}

TEST(Noise, IsIndependentBetweenSensors) {
  constexpr Eigen::Index T = 40000;
  const Eigen::MatrixXd added =
      with_noise(Eigen::MatrixXd::Zero(2, T), {.deviation = 1.0, .scale = NoiseScale::kReading});
  EXPECT_NEAR(added.row(0).dot(added.row(1)) / T, 0.0, 6.0 / std::sqrt(double{T}));  // standard error 1/√T
}

TEST(Sensors, RefuseBadPlaces) {
  using enum SensorKind;
  EXPECT_THAT(array_of({}), ThrowsMessage<InvalidInput>(HasSubstr("at least one")));
  EXPECT_THAT(array_of({{kDisplacement, 0.1}, {kDisplacement, 0.47}}),
              ThrowsMessage<InvalidInput>(HasSubstr("sensor 2 (from 1), displacement at x = 0.47 m: off the beam")));
  EXPECT_THAT(array_of({{kDisplacement, 0.0}}), ThrowsMessage<InvalidInput>(HasSubstr("clamp")));
  EXPECT_THAT(array_of({{kStrain, -0.1}}), ThrowsMessage<InvalidInput>(HasSubstr("off the beam")));
  EXPECT_THAT(array_of({{kStrain, 0.5}}), ThrowsMessage<InvalidInput>(HasSubstr("off the beam")));
  EXPECT_THAT(array_of({{kStrain, 0.45}}), ThrowsMessage<InvalidInput>(HasSubstr("rigid extension")));
  EXPECT_THAT(array_of({{kStrain, std::nan("")}}), ThrowsMessage<InvalidInput>(HasSubstr("off the beam")));
  EXPECT_THAT(array_of({{kStrain, 0.1}, {kStrain, 0.2}, {kStrain, 0.1}}),
              ThrowsMessage<InvalidInput>(HasSubstr("same place as sensor 1")));
  EXPECT_NO_THROW(array_of({{kStrain, 0.1}, {kDisplacement, 0.1}})());
  EXPECT_THROW((void)evenly_spaced(0, 0.4), InvalidInput);
  EXPECT_THROW((void)evenly_spaced(3, 0.0), InvalidInput);
  EXPECT_THROW((void)SensorArray(gauged_beam(), {{kStrain, 0.1}}).readings(Eigen::VectorXd::Zero(3)), InvalidInput);
}

TEST(Noise, RefusesBadNumbers) {
  const Eigen::MatrixXd readings = Eigen::MatrixXd::Ones(1, 3);
  EXPECT_THAT([&] { (void)with_noise(readings, {.deviation = -0.1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("standard deviation -0.1")));
  EXPECT_THROW((void)with_noise(readings * std::nan(""), {.deviation = 0.1}), InvalidInput);
  EXPECT_THROW((void)with_noise(Eigen::MatrixXd(2, 0), {.deviation = 0.1}), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
