#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <array>
#include <string>
#include <vector>

namespace {

using namespace slipmode::tests;
using testing::HasSubstr;

const std::string kBeam = SLIPMODE_SOURCE_DIR "/datasets/beam_12hz/scene.toml";

nlohmann::json modes_of(const TemporaryFolder& folder, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"modes", kBeam, "--count", "6", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = slipmode_in(folder, arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.json();
}

TEST(BeamVerbs, SlippingModesAreThoseOfACantileverWithTipMass) {
  const TemporaryFolder folder;
  const auto found = modes_of(folder);
  // Roots of 1 + cos b cosh b = b (m/(rho A L)) (sin b cosh b − cos b sinh b) for the same numbers; 40 elements are
  // within 2e-5 of the sixth, the tip mass is given to six digits.
  const std::array<double, 6> exact = {2.1009, 17.3296, 52.8822, 108.390, 184.017, 279.780};
  for (std::size_t k = 0; k < exact.size(); ++k) {
    EXPECT_NEAR(found["slipping"]["frequency"][k].get<double>() / exact[k], 1.0, 3e-5) << k;
    EXPECT_NEAR(found["slipping"]["damping_ratio"][k].get<double>(), 0.01, 1e-8) << k;
  }
}

TEST(BeamVerbs, SpringsHoldModesBetweenSlippingAndStuck) {
  const TemporaryFolder folder;
  const auto found = modes_of(folder);
  const auto stiff = modes_of(folder, {"--set", "contact.0.stiffness=2e7"});
  for (std::size_t k = 0; k < 6; ++k) {  // Rayleigh: a stiffer spring raises every frequency
    EXPECT_LT(found["slipping"]["frequency"][k], found["held_by_springs"]["frequency"][k]) << k;
    EXPECT_LT(found["held_by_springs"]["frequency"][k], stiff["held_by_springs"]["frequency"][k]) << k;
    EXPECT_LT(stiff["held_by_springs"]["frequency"][k], found["sticking"]["frequency"][k]) << k;
  }
}

TEST(BeamVerbs, ModesSayWhatShearAndRotaryInertiaChange) {
  const TemporaryFolder folder;
  const auto effects = modes_of(folder)["theory_effects"];
  ASSERT_EQ(effects.size(), 6U);
  for (const auto& effect : effects) {  // both lower every frequency; on so thin a beam by less than 1e-3
    EXPECT_LT(effect["timoshenko_change"], effect["shear_change"]);
    EXPECT_LT(effect["shear_change"], 0.0);
    EXPECT_LT(effect["rotary_change"], 0.0);
    EXPECT_GT(effect["timoshenko_change"], -1e-3);
  }
  const auto thick = modes_of(folder, {"--set", "structure.thickness=0.1"})["theory_effects"];
  EXPECT_LT(thick[5]["timoshenko_change"], -0.1);
  const Outcome text = slipmode_in(folder, {"modes", kBeam, "--count", "3"});
  EXPECT_THAT(text.out, HasSubstr("rotary inertia"));
  EXPECT_THAT(text.out, HasSubstr("held by springs f [Hz]"));
}

}  // namespace
