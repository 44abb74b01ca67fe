#include <slipmode/results/table.hpp>
#include "cli/folder_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using namespace slipmode::tests;
using testing::HasSubstr;
namespace fs = std::filesystem;
namespace results = slipmode::results;

const std::string kPlay = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/play_oscillator/scene.toml";

class OrbitBasins : public InFolder {
 protected:
  /// S2's Figure 10: ξ = 0.2, ω = 0.5005, a = 0.3.
  static std::vector<std::string> figure_10(const std::string& step, const std::string& file,
                                            const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"orbit",
                                      "basins",
                                      kPlay,
                                      "--set",
                                      "drive.amplitude=0.3",
                                      "--set",
                                      "drive.omega=0.5005",
                                      "--set",
                                      "structure.link.0.damping=0.4",
                                      "--over",
                                      "initial.displacement.0=-2:2:" + step,
                                      "--over",
                                      "initial.velocity.0=-2:2:" + step,
                                      "-o",
                                      file,
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::string refused(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = {"orbit", "basins"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.insert(words.end(), {"-o", "b.h5"});
    const Outcome outcome = slipmode_in(folder, words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_FALSE(fs::exists(folder.path() / "b.h5"));
    return outcome.err;
  }
};

// 18.1 ± 0.3 % as in tests/orbits/basins_test.cpp; the orbit beside the gap is Table 2's row 9(d): four crossings.
TEST_F(OrbitBasins, SayAndKeepSharesAttractorsAndBoundary) {
  const Outcome outcome = slipmode_in(folder, figure_10("0.04", "b.h5"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json said = outcome.json();
  EXPECT_EQ(said["starts"], nlohmann::json({101, 101}));
  ASSERT_EQ(said["attractors"].size(), 4U);
  EXPECT_EQ(said["attractors"][0]["kind"], "gap");
  EXPECT_NEAR(said["attractors"][0]["share"].get<double>(), 0.181, 0.003);
  EXPECT_EQ(said["attractors"][1]["kind"], "gap-edge");
  EXPECT_EQ(said["attractors"][2]["crossings"], 4);
  EXPECT_EQ(said["attractors"][3]["starts"], 0);  // undecided
  const results::StoreReader store(folder.path() / "b.h5");
  const results::Table table = results::load_table(store, "basins/attractors");
  const Eigen::MatrixXd attractor = store.matrix("basins/attractor", 101, 101);
  for (std::size_t k = 0; k < table.rows(); ++k) {
    EXPECT_EQ(static_cast<double>((attractor.array() == table.numbers("attractor")[k]).count()),
              table.numbers("starts")[k]);
    EXPECT_EQ(table.numbers("share")[k], said["attractors"][k]["share"].get<double>());
  }
  EXPECT_EQ(store.text("basins/x/key"), "initial.displacement.0");
  EXPECT_EQ(store.number("basins/uncertainty_exponent"), said["uncertainty"]["exponent"].get<double>());
}

TEST_F(OrbitBasins, AreDrawn) {
  ASSERT_EQ(slipmode_in(folder, figure_10("0.2", "b.h5", {"--along", "drive.amplitude=0.2:0.4:0.1"})).exit_code, 0);
  for (const std::string figure : {"basins", "periods", "coordinate", "uncertainty", "shares"}) {
    const Outcome outcome = slipmode_in(folder, {"plot", "b.h5", "--figure", figure, "-o", figure + ".png"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(is_figure(folder.path() / (figure + ".png")));
  }
}

// The scene's own amplitude among those of the third key: its shares are those of the plane.
TEST_F(OrbitBasins, AlongAThirdKeyHoldThePlanesOwnShares) {
  const Outcome outcome = slipmode_in(folder, figure_10("0.2", "b.h5", {"--along", "drive.amplitude=0.2:0.4:0.1"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json said = outcome.json();
  ASSERT_EQ(said["along"].size(), 3U);
  EXPECT_NEAR(said["along"][1]["value"].get<double>(), 0.3, 1e-12);
  EXPECT_EQ(said["along"][1]["attractors"][0]["share"], said["attractors"][0]["share"]);
}

TEST_F(OrbitBasins, GoOnAfterAKillAsIfThereHadBeenNone) {
  const auto words = [](const std::string& file, const std::string& threads) {
    return figure_10("0.02", file, {"--threads", threads, "--along", "drive.amplitude=0.25:0.3:0.05"});
  };
  ASSERT_EQ(slipmode_in(folder, words("whole.h5", "2")).exit_code, 0);
  SlipmodeProcess process(words("stopped.h5", "1"), folder.path());
  ASSERT_TRUE(process.signal_when([&] { return journalled("stopped.h5") >= 20; }, SIGKILL));
  EXPECT_EQ(process.wait().signal, SIGKILL);
  const Outcome resumed = slipmode_in(folder, words("stopped.h5", "2"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_GE(resumed.json()["resumed"], 20);
  EXPECT_EQ(bytes("stopped.h5"), bytes("whole.h5"));
}

TEST_F(OrbitBasins, SayWhatIsWrong) {
  const std::string x = "initial.displacement.0=-2:2:1", v = "initial.velocity.0=-2:2:1";
  EXPECT_THAT(refused({kPlay, "--over", x}), HasSubstr("twice"));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", x}), HasSubstr("given twice"));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", "initial.velocity.1=-2:2:1"}),
              testing::AllOf(HasSubstr("initial.velocity.1"), HasSubstr("K = 0")));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", "drive.omega=1:2:1"}), HasSubstr("no coordinate of the start"));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", "initial.velocity.0=-2:inf:1"}), HasSubstr("finite"));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", v, "--along", "initial.velocity.0=0:1:1"}), HasSubstr("--along"));
  EXPECT_THAT(refused({kPlay, "--over", x, "--over", v, "--along", "drive.omega=1:-1:1"}), HasSubstr("drive.omega"));
  const std::string belt = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml";
  EXPECT_THAT(refused({belt, "--over", x, "--over", v}), HasSubstr("valid: drive.kind"));
}

}  // namespace
