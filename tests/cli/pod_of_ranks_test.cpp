// Modes of a scene's ensemble under mpirun: its members simulated and held by ranks, and the bytes of one process.
// The shares that a decomposition may have: tests/pod/pod_of_ranks_test.cpp.

#include <slipmode/results/records.hpp>
#include "cli/mpirun.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <chrono>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

class RanksPod : public testing::Test {
 protected:
  void SetUp() override { write_file(folder.path() / "free.toml", kFreeEnds); }
  [[nodiscard]] fs::path path(const char* name) const { return folder.path() / name; }
  [[nodiscard]] Words pod(const Words& more) const { return Words{"pod", "free.toml", "-o", "r.h5"} + more; }
  /// When so many ranks run, and have done so for a second: in the middle of the ensemble.
  [[nodiscard]] static auto under_way(const SlipmodeProcess& launched, std::size_t ranks) {
    return [&launched, ranks, since = std::chrono::steady_clock::now()]() mutable {
      const auto ready =
          std::ranges::count_if(ranks_of(launched.id()), [](pid_t own) { return catches(own, SIGUSR1); });
      if (ready < static_cast<std::ptrdiff_t>(ranks)) since = std::chrono::steady_clock::now();
      return std::chrono::steady_clock::now() - since > std::chrono::seconds(1);
    };
  }

  TemporaryFolder folder;
  // Three members of 27,001 snapshots each: twenty blocks of 4096, none of which ends with a member.
  const Words longer = {"--set", "time.duration=3000.0", "--set", "time.transient=300.0", "--set", "time.sample=0.1"};
  // Of 20,000 members, which take ten minutes.
  const Words endless = {"--set", "ensemble.members=20000", "--set", "time.duration=20000.0",
                         "--set", "time.sample=50.0"};
};

// Five ranks are more than there are members: some have no snapshot.
TEST_F(RanksPod, HasTheBytesOfOneProcessAndOfAnEnsembleThatIsKept) {
  SLIPMODE_NEEDS_MPIRUN();
  ASSERT_EQ(slipmode_in(folder, Words{"simulate", "free.toml", "-o", "kept.h5"} + longer).exit_code, 0);
  const Outcome kept = slipmode_in(folder, {"pod", "kept.h5", "-o", "r.h5"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("81003 snapshots of 3 degrees of freedom, rank 3"));
  const std::string expected = bytes_of(path("r.h5"));
  for (const int ranks : {0, 1, 2, 3, 4, 5}) {
    SCOPED_TRACE(ranks);
    fs::remove(path("r.h5"));
    const Outcome one =
        ranks == 0 ? slipmode_in(folder, pod(longer)) : mpirun(ranks, pod(longer), folder.path()).wait();
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_EQ(one.out, kept.out) << "said once";
    EXPECT_EQ(bytes_of(path("r.h5")) == expected, true);
  }
}

// The same in numbers, beside a decomposition by another way: eigenvalues of the covariance of all snapshots.
TEST_F(RanksPod, GivesTheModesOfTheEnsemble) {
  SLIPMODE_NEEDS_MPIRUN();
  ASSERT_EQ(slipmode_in(folder, Words{"simulate", "free.toml", "-o", "kept.h5"} + longer).exit_code, 0);
  ASSERT_EQ(mpirun(3, pod(longer), folder.path()).wait().exit_code, 0);
  const auto ensemble = slipmode::results::load_ensemble(slipmode::results::StoreReader(path("kept.h5")));
  const auto expected = slipmode::pod::pod(ensemble, {.method = slipmode::pod::PodMethod::kCovariance});
  const auto found = slipmode::results::load_pod(slipmode::results::StoreReader(path("r.h5")));
  const auto apart = [](const auto& a, const auto& b) { return (a - b).cwiseAbs().maxCoeff(); };
  EXPECT_LT(apart(found.singular_values, expected.singular_values), 1e-12 * expected.singular_values[0]);
  EXPECT_LT(apart(found.shares, expected.shares), 1e-12);
  EXPECT_LT(apart(found.basis.vectors, expected.basis.vectors), 1e-12);
  EXPECT_LT(apart(found.basis.mean, expected.basis.mean), 1e-12);
}

// Few snapshots of many degrees of freedom, and modes by number.
TEST_F(RanksPod, OfFewSnapshotsHasTheBytesOfOneProcess) {
  SLIPMODE_NEEDS_MPIRUN();
  const Words few = {"--set", "structure.masses=40", "--set", "time.duration=105.0", "--modes", "4"};
  const Outcome one = slipmode_in(folder, pod(few));
  ASSERT_EQ(one.exit_code, 0) << one.err;
  const std::string expected = bytes_of(path("r.h5"));
  const Outcome ranks = mpirun(2, pod(few + Words{"--json"}), folder.path()).wait();
  EXPECT_EQ(ranks.exit_code, 0) << ranks.err;
  EXPECT_EQ(ranks.json()["snapshots"], 33);
  EXPECT_EQ(bytes_of(path("r.h5")) == expected, true);
}

// A window that holds too many events at one of three speeds only.
TEST_F(RanksPod, GoesOnWithoutMembersThatFail) {
  SLIPMODE_NEEDS_MPIRUN();
  const Words failing =
      longer + Words{"--set", "ensemble.speeds=[0.2, 0.5, 0.8]", "--set", "flow.max_events_per_window=40",
                     "--set", "flow.zeno_window=100.0",          "--json"};
  const Outcome one = slipmode_in(folder, pod(failing));
  ASSERT_EQ(one.exit_code, 3) << one.err;
  ASSERT_GT(one.json()["failures"].size(), 0U);
  ASSERT_LT(one.json()["failures"].size(), 9U);
  EXPECT_THAT(one.json()["message"].get<std::string>(),
              HasSubstr("runs failed; the modes of the others are kept in r.h5"));
  const std::string expected = bytes_of(path("r.h5"));
  for (const int ranks : {2, 11}) {
    fs::remove(path("r.h5"));
    const Outcome shared = mpirun(ranks, pod(failing), folder.path()).wait();
    EXPECT_EQ(shared.exit_code, 3);
    EXPECT_EQ(shared.out, one.out);
    EXPECT_EQ(bytes_of(path("r.h5")) == expected, true);
  }
  const Outcome all = mpirun(2, pod(failing + Words{"--set", "ensemble.speeds=[0.2]"}), folder.path()).wait();
  EXPECT_EQ(all.exit_code, 3);
  EXPECT_THAT(all.err, HasSubstr("ensemble: every member failed; the first with: Zeno"));
}

TEST_F(RanksPod, EndsWhenARankIsKilledOrStopped) {
  SLIPMODE_NEEDS_MPIRUN();
  for (const std::size_t rank : {0U, 2U}) {
    SCOPED_TRACE(rank);
    SlipmodeProcess killed = mpirun(3, pod(endless), folder.path());
    ASSERT_TRUE(killed.signal_when(under_way(killed, 3), 0));
    kill(ranks_of(killed.id()).at(rank), SIGKILL);
    const Outcome outcome = killed.wait();
    EXPECT_EQ(outcome.exit_code, 137);
    EXPECT_THAT(outcome.err, HasSubstr("exited on signal 9")) << "mpirun says which";
  }
  SlipmodeProcess stopped = mpirun(3, pod(endless), folder.path());
  ASSERT_TRUE(stopped.signal_when(under_way(stopped, 3), SIGUSR1));
  const Outcome outcome = stopped.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.err, HasSubstr("interrupted"));
  EXPECT_EQ(folder.names(), std::vector<std::string>({"free.toml"}));
}

TEST_F(RanksPod, RefusesOnceWhatItCannotDo) {
  SLIPMODE_NEEDS_MPIRUN();
  const auto refused = [&](const Words& words, const std::string& said, const Words& through = {}) {
    const Outcome outcome = mpirun(2, words, folder.path(), through).wait();
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(said));
    const std::size_t first = outcome.err.find("slipmode: ");
    EXPECT_EQ(outcome.err.find("slipmode: ", first + 1), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(path("r.h5")));
  };
  refused({"pod", "kept.h5", "-o", "r.h5"}, "start it without mpirun, or give the scene (.toml)");
  refused({"pod", kShakenBeam, "-o", "r.h5"},
          "drive.kind = \"shaker\": its modes are found by one process; start it without mpirun");
  refused({"pod", kShakenBeam, "-o", "r.h5", "--modes", "2"}, "modes = 2: under a shaker all are kept");
  // Before the ensemble, which takes ten minutes.
  refused(pod(endless + Words{"--modes", "4"}), "free.toml: --modes 4: the scene has 3 degrees of freedom");
  refused(pod({"--set", "time.sample=-1.0"}), "time.sample");
  write_file(path("start.sh"),
             "[ \"$OMPI_COMM_WORLD_RANK\" = 0 ] || set -- \"$@\" --set contact.0.mu_s=0.6\nexec \"$@\"\n");
  refused(pod(endless), "rank 1: its study is another than rank 0's", {"sh", "start.sh"});
}

}  // namespace
