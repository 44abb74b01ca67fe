#include <slipmode/scene/own_times.hpp>

#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <string>

namespace slipmode::scene {
namespace {

/// One mass on a spring: slowest period 2π sqrt(m/k).
std::string one_mass(double stiffness, const std::string& validation) {
  return "units = \"SI\"\n[structure]\nkind = \"chain\"\nmasses = 1\nstiffness = " + std::to_string(stiffness) +
         "\n[[contact]]\nat = 1\nlaw = \"coulomb\"\nmu_s = 0.4\nmu_k = 0.3\nnormal_load = 1.0\n"
         "[drive]\nkind = \"belt\"\nspeed = 0.2\n[time]\nduration = 1.0\n" +
         validation;
}

// The thesis' own times, and those found to do beside them, for its chain with a slowest period of 42.
TEST(OwnTimes, OfTheChainOfTenAreThoseOfItsSource) {
  const Scene scene = with_own_times(load_scene(SLIPMODE_SOURCE_DIR "/datasets/chain10/scene.toml"));
  EXPECT_EQ(scene.validation.transient, 1000.0);
  EXPECT_EQ(scene.validation.block, 5000.0);
  EXPECT_EQ(scene.validation.limit, 100000.0);
  EXPECT_EQ(scene.validation.sweep_limit, 5000.0);
  EXPECT_EQ(scene.validation.horizon, 100.0);
  EXPECT_EQ(scene.validation.cost_duration, 10000.0);
  EXPECT_EQ(scene.validation.lyapunov_duration, 100000.0) << "given";
}

// Stiffer by 10⁶: all times a thousandth.
TEST(OwnTimes, ScaleWithTheSlowestPeriod) {
  const ValidationSpec slow = with_own_times(parse_scene(one_mass(1.0, "[validation]\n"))).validation;
  const ValidationSpec fast = with_own_times(parse_scene(one_mass(1e6, "[validation]\n"))).validation;
  EXPECT_EQ(slow.transient, 200.0);  // 24 · 2π = 151
  EXPECT_EQ(slow.sweep_limit, 800.0);
  EXPECT_EQ(slow.horizon, 20.0);
  for (const auto time :
       {&ValidationSpec::transient, &ValidationSpec::block, &ValidationSpec::limit, &ValidationSpec::sweep_limit,
        &ValidationSpec::horizon, &ValidationSpec::lyapunov_duration, &ValidationSpec::cost_duration}) {
    EXPECT_NEAR(fast.*time, 1e-3 * slow.*time, 1e-12 * slow.*time);
  }
  EXPECT_EQ(slow.speeds.from, 0.5);
  EXPECT_EQ(slow.speeds.values().size(), 50U);
}

TEST(OwnTimes, LeaveWhatIsGivenAlone) {
  const Scene scene =
      parse_scene(one_mass(1.0, "[validation]\nlimit = 70.0\nspeeds = { from = 0.3, to = 0.1, step = 0.1 }\n"),
                  {"validation.horizon=3.0"});
  const ValidationSpec spec = with_own_times(scene).validation;
  EXPECT_EQ(spec.limit, 70.0);
  EXPECT_EQ(spec.horizon, 3.0);
  EXPECT_EQ(spec.speeds.from, 0.3);
  EXPECT_EQ(spec.block, 70.0) << "no longer than the limit";
  EXPECT_EQ(spec.transient, 200.0);
}

// Free at both ends: the motion as a whole has no period, the two masses against each other have 2π/√2.
TEST(OwnTimes, ComeFromTheSlowestModeThatVibrates) {
  const Scene scene = parse_scene(one_mass(1.0, "[validation]\n"), {"structure.masses=2", "structure.ends=free-free"});
  EXPECT_EQ(with_own_times(scene).validation.transient, 100.0);  // 24 · 4.44 = 107
}

}  // namespace
}  // namespace slipmode::scene
