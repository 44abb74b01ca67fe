// What happens to a computer happens to a run: killed at any moment, a full disc, limits, its folder gone, another one
// on the same file. Earlier results stay, nothing half-written is left under a result's name, and the same command goes
// on.
//
// SLIPMODE_KILLS sets how often each verb is killed (4 by default; docs/limits.md says when it was many).

#include <slipmode/core/random.hpp>
#include "cli/folder_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <cstdlib>

extern "C" void __asan_init() __attribute__((weak));  // NOLINT: its name; there where the library is instrumented

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;

int kills() {
  const char* asked = std::getenv("SLIPMODE_KILLS");
  return asked != nullptr ? std::atoi(asked) : 4;
}

struct Killed {
  std::string name;
  std::vector<std::string> arguments;  ///< writes out.h5 or the folder out
  bool resumes = true;
  std::vector<std::string> compared = {"out.h5"};
};

void PrintTo(const Killed& verb, std::ostream* out) { *out << verb.name; }

class KilledAtAnyMoment : public testing::TestWithParam<Killed> {};

// Moments are drawn over the whole run and a little beyond. What is left is nothing, the whole file, or a journal from
// which the same command takes every value that was finished. Temporary files of the killed are the only litter.
TEST_P(KilledAtAnyMoment, GivesTheSameBytesWhenRepeated) {
  const TemporaryFolder whole, folder;
  for (const TemporaryFolder* each : {&whole, &folder}) write_file(each->path() / "scene.toml", kTwoContacts);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(slipmode_in(whole, GetParam().arguments).exit_code, 0);
  const std::chrono::duration<double> lasts = std::chrono::steady_clock::now() - begin;
  slipmode::Random random(1);
  for (int k = 0; k < kills(); ++k) {
    SCOPED_TRACE(testing::Message() << "kill " << k);
    const auto moment = std::chrono::steady_clock::now() + 1.1 * lasts * random.uniform();
    SlipmodeProcess process(GetParam().arguments, folder.path());
    process.signal_when([&] { return std::chrono::steady_clock::now() >= moment; }, SIGKILL);
    process.wait();
    if (k % 3 == 1) continue;  // killed again before it could finish
    const int kept = finished_in(folder.path() / "out.h5.journal");
    const bool done = fs::exists(folder.path() / "out.h5");
    const Outcome repeated = slipmode_in(folder, GetParam().arguments);
    ASSERT_EQ(repeated.exit_code, 0) << repeated.err;
    if (GetParam().resumes && !done) {
      EXPECT_EQ(repeated.json()["resumed"], kept);
    }
    for (const std::string& file : GetParam().compared)
      EXPECT_EQ(bytes_of(folder.path() / file) == bytes_of(whole.path() / file), true) << file;
    fs::remove(folder.path() / "out.h5");
    fs::remove_all(folder.path() / "out");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Verbs, KilledAtAnyMoment,
    testing::Values(Killed{"Sweep",
                           {"sweep", "scene.toml", "--over", "drive.speed=0.3:0.1:0.004", "-o", "out.h5", "--json"}},
                    Killed{"Shard",
                           {"sweep", "scene.toml", "--over", "drive.speed=0.3:0.1:0.002", "--shard", "2/3", "-o",
                            "out.h5", "--json"}},
                    Killed{"ShardOfExponents",
                           {"diagnose", "scene.toml", "--over", "drive.speed=0.3:0.1:0.01", "--duration", "20",
                            "--shard", "1/2", "-o", "out.h5", "--json"}},
                    Killed{"ShardOfBasins",
                           {"orbit", "basins", kBacklash, "--over", "initial.displacement.0=-3:3:0.1", "--over",
                            "initial.velocity.0=-3:3:0.1", "--shard", "2/3", "-o", "out.h5", "--json"}},
                    Killed{"OrbitMap",
                           {"orbit", "map", kBacklash, "--over", "drive.omega=0.4:1.8:0.1", "--over",
                            "drive.amplitude=0.6:1.4:0.1", "-o", "out.h5", "--json"}},
                    Killed{"OrbitBasins",
                           {"orbit", "basins", kBacklash, "--over", "initial.displacement.0=-3:3:0.1", "--over",
                            "initial.velocity.0=-3:3:0.1", "-o", "out.h5", "--json"}},
                    Killed{"Exponents",
                           {"diagnose", "scene.toml", "--over", "drive.speed=0.3:0.1:0.02", "--duration", "20", "-o",
                            "out.h5", "--json"}},
                    Killed{"Trade", {"trade", "scene.toml", "--axes", "flow", "-o", "out.h5", "--json"}, true, {}},
                    Killed{"ShardOfAnEnsemble",
                           {"simulate", "scene.toml", "--set", "ensemble.members=24", "--set", "ensemble.spread=0.1",
                            "--shard", "2/2", "-o", "out.h5", "--json"}},
                    Killed{"Simulate", {"simulate", "scene.toml", "-o", "out.h5", "--json"}, false},
                    Killed{"Run", {"run", "scene.toml", "-o", "out", "--json"}, false, {"out/trajectory.h5"}}),
    [](const auto& tested) { return tested.param.name; });

/// Limits what processes started while it lives may use.
class WithLimit {
 public:
  WithLimit(__rlimit_resource resource, rlim_t most) : resource_(resource) {
    getrlimit(resource, &before_);
    const rlimit lowered{.rlim_cur = most, .rlim_max = before_.rlim_max};
    setrlimit(resource, &lowered);
  }
  ~WithLimit() { setrlimit(resource_, &before_); }
  WithLimit(const WithLimit&) = delete;
  WithLimit& operator=(const WithLimit&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

class Faults : public InFolder {
 protected:
  void SetUp() override { write_file(folder.path() / "scene.toml", kTwoContacts); }

  Outcome simulate() { return slipmode_in(folder, {"simulate", "scene.toml", "-o", "out.h5"}); }
  std::vector<std::string> sweep(const std::string& output) {
    return {"sweep", "scene.toml", "--over", "drive.speed=0.3:0.1:0.0005", "-o", output, "--json"};
  }
};

// A limit on file sizes fails writes as a full disc does, wherever in the file it is met: HDF5's first bytes, a
// dataset, the last flush. HDF5 1.10 crashed at exit over the file that it could not close.
TEST_F(Faults, AFullDiscIsAnErrorAndKeepsTheEarlierResult) {
  ASSERT_EQ(simulate().exit_code, 0);
  const std::string earlier = bytes_of(folder.path() / "out.h5");
  const auto size = static_cast<rlim_t>(earlier.size());
  for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, rlim_t{4096}, size / 4, size / 2, size - 5000, size - 1}) {
    SCOPED_TRACE(limit);
    Outcome full;
    {
      const WithLimit limited(RLIMIT_FSIZE, limit);
      full = simulate();
    }
    EXPECT_EQ(full.exit_code, 2);
    EXPECT_EQ(full.signal, 0);
    if (limit > 1000) {  // else what it says is cut off too
      EXPECT_THAT(full.err, AnyOf(HasSubstr("disc full"), HasSubstr("cannot be written")));
    }
    EXPECT_EQ(bytes_of(folder.path() / "out.h5") == earlier, true);
    EXPECT_THAT(folder.names(), ElementsAre("out.h5", "scene.toml"));
  }
}

TEST_F(Faults, AJournalThatCannotGrowSaysHowToGoOn) {
  Outcome full;
  {
    const WithLimit limited(RLIMIT_FSIZE, 20000);
    full = slipmode_in(folder, sweep("out.h5"));
  }
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.json()["message"], HasSubstr("free some space and run the same command again"));
  const Outcome repeated = slipmode_in(folder, sweep("out.h5"));
  ASSERT_EQ(repeated.exit_code, 0) << repeated.err;
  EXPECT_GT(repeated.json()["resumed"], 0);
  ASSERT_EQ(slipmode_in(folder, sweep("whole.h5")).exit_code, 0);
  EXPECT_EQ(bytes_of(folder.path() / "out.h5") == bytes_of(folder.path() / "whole.h5"), true);
}

TEST_F(Faults, TooLittleMemoryIsAnErrorAndKeepsTheEarlierResult) {
  if (&__asan_init != nullptr) GTEST_SKIP() << "the sanitizer reserves more than any limit";
  ASSERT_EQ(simulate().exit_code, 0);
  const std::string earlier = bytes_of(folder.path() / "out.h5");
  Outcome starved;
  {
    const WithLimit limited(RLIMIT_AS, rlim_t{1} << 30);
    starved = slipmode_in(folder, {"simulate", "scene.toml", "-o", "out.h5", "--set", "time.sample=1e-7"});
  }
  EXPECT_EQ(starved.exit_code, 2) << starved.signal;
  EXPECT_THAT(starved.err, HasSubstr("not enough memory"));
  EXPECT_EQ(bytes_of(folder.path() / "out.h5") == earlier, true);
  EXPECT_THAT(folder.names(), ElementsAre("out.h5", "scene.toml"));
}

TEST_F(Faults, AFolderRemovedMeanwhileIsAnError) {
  fs::create_directory(folder.path() / "results");
  SlipmodeProcess process(sweep("results/out.h5"), folder.path());
  ASSERT_TRUE(process.signal_when([&] { return journalled("results/out.h5") >= 2; }, SIGSTOP));
  fs::remove_all(folder.path() / "results");
  ASSERT_TRUE(process.signal_when([] { return true; }, SIGCONT));
  const Outcome ended = process.wait();
  EXPECT_EQ(ended.exit_code, 2);
  EXPECT_THAT(ended.json()["message"], HasSubstr("results/out.h5"));
}

TEST_F(Faults, ASecondProcessOnTheSameOutputIsRefusedAndTheFirstGoesOn) {
  SlipmodeProcess first(sweep("out.h5"), folder.path());
  ASSERT_TRUE(first.signal_when([&] { return journalled("out.h5") >= 1; }, SIGSTOP));
  const Outcome second = slipmode_in(folder, sweep("out.h5"));
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.json()["message"], HasSubstr("another process"));
  ASSERT_TRUE(first.signal_when([] { return true; }, SIGCONT));
  EXPECT_EQ(first.wait().exit_code, 0);
}

}  // namespace
