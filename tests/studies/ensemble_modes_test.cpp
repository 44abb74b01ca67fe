// What rank 0 makes of what other ranks say. Modes: tests/cli/pod_of_ranks_test.cpp.

#include <slipmode/core/exchange.hpp>
#include <slipmode/scene/scene.hpp>
#include <slipmode/studies/ensemble_modes.hpp>
#include "cli/small_scenes.hpp"
#include "core/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

namespace slipmode::studies {
namespace {

using testing::HasSubstr;

scene::Scene free_ends() { return scene::parse_scene(tests::kFreeEnds, {}, "free.toml"); }

/// What modes are refused with.
std::string refusal_of(const scene::Scene& scene, Eigen::Index modes, const Ranks* ranks = nullptr) {
  RunOptions run;
  bool simulated = false;
  run.progress = [&simulated](const std::string&) {
    simulated = true;
    return ProgressCallback();
  };
  try {
    (void)ensemble_modes(scene, modes, run, ranks);
  } catch (const InvalidInput& error) {
    EXPECT_EQ(simulated, ranks != nullptr);
    return error.what();
  }
  return "";
}

TEST(EnsembleModes, AreRefusedBeforeTheEnsembleIsSimulated) {
  EXPECT_EQ(refusal_of(free_ends(), 4),
            "free.toml: --modes 4: the scene has 3 degrees of freedom; expected 1 to 3, or 0 for all modes there are");
  EXPECT_EQ(refusal_of(free_ends(), -1), "modes = -1: expected 1 or more, or 0 for all there are");
  EXPECT_THAT(refusal_of(scene::load_scene(tests::kShakenBeam), 2),
              HasSubstr("modes = 2: under a shaker all are kept"));
}

// Rank 1 has the same study and no snapshot, and fails when modes are sought.
TEST(EnsembleModes, ArePassedOverInWhatAnotherRankSays) {
  tests::Network network(2);
  const Ranks zero = network.rank(0), one = network.rank(1);
  const Exchange other(one, nullptr);
  for (int k = 0; k < 2; ++k) other.send(0, "");  // the study is its own, no audit
  other.send(0, std::vector<double>{0, 0, 0});
  one.send(0, "f2 not enough memory");
  EXPECT_EQ(refusal_of(free_ends(), 2, &zero), "rank 1: not enough memory");
}

}  // namespace
}  // namespace slipmode::studies
