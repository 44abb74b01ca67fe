#include <slipmode/scene/own_times.hpp>

#include "scene/messages.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

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

/// Without a word on [time], or with some.
Scene on_belt(const std::string& time) {
  return parse_scene(tests::replaced(one_mass(1.0, ""), "[time]\nduration = 1.0\n", time));
}

// Slowest period 2π: 24 of them are 151, 216 are 1357, an eightieth is 0.0785; each to one digit.
TEST(OwnTimes, OfARunAreTheStructures) {
  const TimeSpec time = on_belt("").time;
  EXPECT_EQ(time.transient, 200.0);
  EXPECT_EQ(time.duration, 1200.0);
  EXPECT_DOUBLE_EQ(time.sample, 0.08);
  EXPECT_EQ(on_belt("[time]\ntransient = 50.0\n").time.duration, 1050.0);
  EXPECT_EQ(on_belt("[time]\nduration = 300.0\n").time.transient, 0.0) << "as it says";
  EXPECT_DOUBLE_EQ(on_belt("[time]\nduration = 1.0\n").time.sample, 0.01) << "a hundred of a short run";
}

TEST(OwnTimes, OfWhatDoesNotVibrateHaveToBeGiven) {
  const std::string lone =
      "units = \"SI\"\n[structure]\nkind = \"masses\"\nmass = 1.0\n[[contact]]\nat = 1\n"
      "law = \"coulomb\"\nmu_s = 0.4\nmu_k = 0.3\nnormal_load = 1.0\n[drive]\nkind = \"belt\"\n"
      "speed = 0.2\n";
  tests::expect_parts(tests::error_of(lone),
                      {"s.toml", "time.duration: missing, and nothing vibrates", "a number > 0"});
  EXPECT_DOUBLE_EQ(parse_scene(lone + "[time]\nduration = 5.0\n").time.sample, 0.05);
}

TEST(OwnTimes, UnderAForceAreItsCycles) {
  const std::string forced =
      tests::replaced(one_mass(1.0, ""), "kind = \"belt\"\nspeed = 0.2\n[time]\nduration = 1.0\n",
                      "kind = \"force\"\nfrequency = 2.0\namplitude = 1.0\nat = 1\n");
  const Scene scene = parse_scene(forced);
  EXPECT_DOUBLE_EQ(scene.time.duration, 150.0) << "300 cycles";
  EXPECT_DOUBLE_EQ(scene.time.transient, 100.0);
  EXPECT_DOUBLE_EQ(scene.time.sample, 0.5 / 32.0);
  EXPECT_DOUBLE_EQ(parse_scene(forced + "[time]\nduration = 10.0\n").time.sample, 0.5 / 32.0);
  const ChosenTimes chosen = chosen_times(scene, {"time"});
  EXPECT_EQ(chosen.of, "the drive's period");
  ASSERT_EQ(chosen.times.size(), 3U);
  EXPECT_EQ(chosen.times[0].key, "time.cycles");
  EXPECT_EQ(chosen.times[0].value, 300.0);
}

// The number next to the decimal, as a scene file has it: 3 · 0.1 is 0.30000000000000004.
TEST(OwnTimes, AreTheirDecimal) {
  EXPECT_EQ(to_one_digit(0.3423), 0.3);
  EXPECT_EQ(to_one_digit(7.2e-5), 7e-5);
  EXPECT_EQ(to_one_digit(0.097), 0.1);
  EXPECT_EQ(to_one_digit(1.0), 1.0);
  EXPECT_EQ(to_one_digit(2349.0), 2000.0);
}

TEST(OwnTimes, AreSaid) {
  const Scene scene = with_own_times(parse_scene(one_mass(1.0, "[validation]\nblock = 100.0\n"), {"time.sample=0.5"}));
  const ChosenTimes chosen = chosen_times(scene, {"time", "validation"});
  EXPECT_NEAR(chosen.period, 6.283185307179586, 1e-12);
  ASSERT_EQ(chosen.times.size(), 6U) << "those of [validation] but the block";
  EXPECT_EQ(chosen.times.front().key, "validation.transient");
  EXPECT_EQ(chosen.times.front().value, 200.0);
  const ChosenTimes one = chosen_times(scene, {"validation.limit", "validation.block"});
  ASSERT_EQ(one.times.size(), 1U) << "the block is given";
  EXPECT_EQ(one.times.front().key, "validation.limit");
}

std::vector<std::string> keys_chosen(const Scene& scene) {
  std::vector<std::string> keys;
  for (const ChosenTimes::Time& time : chosen_times(scene, {"time", "validation"}).times) keys.push_back(time.key);
  return keys;
}

// A scene with a key set is the scene that its source and overrides say.
TEST(OwnTimes, AreThoseOfASceneWithAKeySet) {
  const Scene scene = on_belt("[time]\nduration = 300.0\n");
  for (const char* change : {"time.sample", "time.duration", "time.transient", "structure.stiffness", "drive.speed",
                             "contact.0.mu_s", "validation.horizon", "ensemble.seed", "flow.tolerance"}) {
    SCOPED_TRACE(change);
    const Scene changed = set_key(scene, change, change == std::string("ensemble.seed") ? 7.0 : 0.75);
    const Scene again = parse_scene(changed.source.text, changed.source.overrides);
    EXPECT_EQ(changed.time.duration, again.time.duration);
    EXPECT_EQ(changed.time.transient, again.time.transient);
    EXPECT_EQ(changed.time.sample, again.time.sample);
    EXPECT_EQ(changed.source.given, again.source.given);
    EXPECT_EQ(changed.source.period, again.source.period);
    EXPECT_EQ(keys_chosen(changed), keys_chosen(again));
    EXPECT_EQ(scene_to_toml(with_own_times(changed)), scene_to_toml(with_own_times(again)));
  }
  const std::string forced = tests::replaced(one_mass(1.0, ""), "kind = \"belt\"\nspeed = 0.2\n",
                                             "kind = \"force\"\nfrequency = 2.0\namplitude = 1.0\nat = 1\n");
  EXPECT_DOUBLE_EQ(set_key(parse_scene(forced), "drive.frequency", 4.0).time.sample, 0.25 / 32.0);
}

TEST(OwnTimes, SectionsAreThoseOfTextAndOverridesButASeed) {
  const Scene scene = parse_scene(one_mass(1.0, ""), {"ensemble.seed=3", "validation = {limit = 70.0}"});
  EXPECT_TRUE(has_section(scene, "time"));
  EXPECT_TRUE(has_section(scene, "validation"));
  EXPECT_FALSE(has_section(scene, "ensemble"));
  EXPECT_FALSE(has_section(scene, "reduction"));
  EXPECT_TRUE(has_section(set_key(scene, "ensemble.members", 3.0), "ensemble"));
  EXPECT_TRUE(has_section(parse_scene(one_mass(1.0, "[ensemble]\nseed = 3\n")), "ensemble"));
  EXPECT_EQ(with_own_times(scene).validation.limit, 70.0);
}

TEST(OwnTimes, WaitOneBlockWhereNoLawSticks) {
  const std::string smooth = tests::replaced(one_mass(1.0, "[validation]\n"), "coulomb", "tanh");
  const Scene scene = with_own_times(parse_scene(smooth));
  EXPECT_FALSE(has_sticking_law(scene));
  EXPECT_EQ(scene.validation.limit, scene.validation.block);
  EXPECT_EQ(with_own_times(parse_scene(smooth, {"validation.limit=5000.0"})).validation.limit, 5000.0);
}

// Free at both ends: the motion as a whole has no period, the two masses against each other have 2π/√2.
TEST(OwnTimes, ComeFromTheSlowestModeThatVibrates) {
  const Scene scene = parse_scene(one_mass(1.0, "[validation]\n"), {"structure.masses=2", "structure.ends=free-free"});
  EXPECT_EQ(with_own_times(scene).validation.transient, 100.0);  // 24 · 4.44 = 107
}

}  // namespace
}  // namespace slipmode::scene
