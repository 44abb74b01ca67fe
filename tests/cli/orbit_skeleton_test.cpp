#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/table.hpp>
#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
namespace scene = slipmode::scene;
using testing::HasSubstr;

const std::string kTenMasses = std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml";

/// A search that takes a second.
std::vector<std::string> short_search(const std::string& file, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"orbit", "skeleton",     kTenMasses, "--duration", "150000", "--max-length",
                                        "3",     "--per-length", "4",        "-o",         file,     "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class OrbitSkeleton : public testing::Test {
 protected:
  TemporaryFolder folder;
};

// S4 section 3.5.4: unstable orbits in the chaotic attractor at belt speed 0.2. Each stored orbit is an orbit record.
// How many of them a record of this length passes is chance (2 to 6 in twelve records a hair apart), that its dozen
// closest returns lead to one is not.
TEST_F(OrbitSkeleton, OfTheChainHoldsUnstableOrbits) {
  const Outcome outcome = slipmode_in(folder, short_search("skeleton.h5"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json full = outcome.json()["full"];
  ASSERT_FALSE(full["orbits"].empty());
  for (const auto& orbit : full["orbits"]) {
    EXPECT_EQ(orbit["stability"], "unstable");
    EXPECT_GT(orbit["leading_modulus"], 1.0);
    EXPECT_LT(orbit["residual"], 1e-10);
  }
  EXPECT_EQ(
      full["candidates"].get<std::size_t>(), full["refused"].size() + [&] {
        std::size_t hits = 0;
        for (const auto& orbit : full["orbits"]) hits += orbit["hits"].get<std::size_t>();
        return hits;
      }());
  const results::StoreReader store(folder.path() / "skeleton.h5");
  const auto stored = results::load_orbit(store, "skeleton/full/orbit_001");
  EXPECT_EQ(stored.period, full["orbits"][0]["period"]);
  for (const std::string figure : {"orbits", "spectrum"}) {
    ASSERT_EQ(slipmode_in(folder, {"plot", "skeleton.h5", "--figure", figure, "-o", figure + ".png"}).exit_code, 0);
    EXPECT_TRUE(is_figure(folder.path() / (figure + ".png")));
  }
}

TEST_F(OrbitSkeleton, HasTheSameBytesForAnyNumberOfThreads) {
  ASSERT_EQ(slipmode_in(folder, short_search("one.h5", {"--threads", "1"})).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, short_search("two.h5", {"--threads", "2"})).exit_code, 0);
  EXPECT_EQ(bytes_of(folder.path() / "one.h5"), bytes_of(folder.path() / "two.h5"));
}

// All ten natural modes are the full model in other coordinates: orbits that were found in either must be in both.
TEST_F(OrbitSkeleton, OfAModelWithAllModesMissesNothing) {
  ASSERT_EQ(slipmode_in(folder, {"reduce", kTenMasses, "lnm", "--modes", "10", "-o", "rom.h5"}).exit_code, 0);
  const Outcome outcome = slipmode_in(folder, short_search("both.h5", {"--compare-with", "rom:rom.h5"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json comparison = outcome.json()["comparison"];
  EXPECT_TRUE(comparison["missed"].empty());
  EXPECT_TRUE(comparison["extra"].empty());
  ASSERT_FALSE(comparison["matched"].empty());
  for (const auto& match : comparison["matched"]) {
    EXPECT_LT(std::abs(match["period"].get<double>()), 1e-8);
    EXPECT_LT(match["shape"].get<double>(), 1e-5);
  }
  ASSERT_EQ(slipmode_in(folder, {"plot", "both.h5", "-o", "comparison.svg"}).exit_code, 0);
  EXPECT_TRUE(is_figure(folder.path() / "comparison.svg"));
}

// At belt speed 0.45 the chain settles to T = 45.10211 (reference: checked orbit p1): 90.2 samples of 0.5.
TEST_F(OrbitSkeleton, ReturnsOfASeriesFindItsPeriod) {
  ASSERT_EQ(slipmode_in(folder, {"simulate", kTenMasses, "--single", "--set", "drive.speed=0.45", "--set",
                                 "time.duration=21000.0", "-o", "run.h5"})
                .exit_code,
            0);
  const Outcome outcome =
      slipmode_in(folder, {"orbit", "returns", "run.h5:trajectory/v", "--column", "1", "--delay", "11", "--dimension",
                           "6", "--threshold", "0.2", "--max-length", "120", "-o", "returns.h5", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json orbits = outcome.json()["orbits"];
  ASSERT_FALSE(orbits.empty());
  const auto nearest = std::min_element(orbits.begin(), orbits.end(), [](const auto& a, const auto& b) {
    return a["distance"].template get<double>() < b["distance"].template get<double>();
  });
  EXPECT_EQ((*nearest)["length"], 90);
  EXPECT_EQ(results::load_table(results::StoreReader(folder.path() / "returns.h5"), "returns/orbits").rows(),
            orbits.size());
  EXPECT_EQ(slipmode_in(folder, {"orbit", "returns", "run.h5:trajectory/v"}).exit_code, 2);
  EXPECT_EQ(slipmode_in(folder, {"orbit", "returns", "run.h5"}).exit_code, 2);
}

TEST_F(OrbitSkeleton, SaysWhatIsWrong) {
  const auto refused = [&](const std::vector<std::string>& more, int exit_code = 2) {
    const Outcome outcome = slipmode_in(folder, short_search("s.h5", more));
    EXPECT_EQ(outcome.exit_code, exit_code);
    return outcome.err;
  };
  EXPECT_THAT(refused({"--model", "rom6.h5"}), HasSubstr("rom:FILE"));
  EXPECT_THAT(refused({"--compare-with", "rom:none.h5"}), HasSubstr("none.h5"));
  EXPECT_THAT(refused({"--model", "rom:a.h5", "--compare-with", "rom:b.h5"}), HasSubstr("leave --model out"));
  // A belt faster than the mass ever moves: no stick, no section.
  EXPECT_THAT(refused({"--set", "drive.speed=5.0"}, 3), HasSubstr("passages of the section"));
  EXPECT_FALSE(fs::exists(folder.path() / "s.h5"));
}

}  // namespace
