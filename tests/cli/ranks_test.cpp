// A study as ranks under mpirun: stopped, with a rank killed, refused, and as one process in what it says.
// That the bytes are those of one process: shards_test.cpp.

#include "cli/mpirun.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

class Ranks : public testing::Test {
 protected:
  void SetUp() override { write_file(folder.path() / "two.toml", kTwoContacts); }
  [[nodiscard]] fs::path path(const char* name) const { return folder.path() / name; }
  [[nodiscard]] std::uintmax_t journal_size() const {
    std::error_code none;
    const auto size = fs::file_size(path("r.h5.journal"), none);
    return none ? 0 : size;
  }
  /// Of one process; computed once.
  [[nodiscard]] std::string expected() const {
    if (!fs::exists(path("one.h5"))) {
      const Outcome outcome = slipmode_in(folder, sweep + Words{"-o", "one.h5"});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    return bytes_of(path("one.h5"));
  }
  /// What is left goes on with another number of ranks, or none, to the bytes of one process.
  void goes_on(int ranks) const {
    const auto lines = bytes_of(path("r.h5.journal"));
    const auto kept = std::count(lines.begin(), lines.end(), '\n') - 1;  // but the head
    EXPECT_GT(kept, 0);
    const Words words = sweep + Words{"-o", "r.h5", "--json"};
    const Outcome rest = ranks == 1 ? slipmode_in(folder, words) : mpirun(ranks, words, folder.path()).wait();
    ASSERT_EQ(rest.exit_code, 0) << rest.err;
    EXPECT_EQ(rest.json()["resumed"], kept);
    EXPECT_EQ(bytes_of(path("r.h5")) == expected(), true);
  }

  TemporaryFolder folder;
  const Words sweep = {"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.00004"};  // 5,001 values, about 5 s
  const Words ranks_sweep = sweep + Words{"-o", "r.h5"};
};

TEST_F(Ranks, AreStoppedTogetherAndGoOnAsAnotherNumber) {
  SLIPMODE_NEEDS_MPIRUN();
  int others = 0;
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) {
    SCOPED_TRACE(signal);
    SlipmodeProcess launched = mpirun(3, ranks_sweep, folder.path());
    ASSERT_TRUE(launched.signal_when([&] { return journal_size() > 3000; }, signal)) << "over before it was stopped";
    const Outcome stopped = launched.wait();
    EXPECT_NE(stopped.exit_code, 0);
    // Of SIGINT and SIGTERM mpirun makes SIGTERM, and often SIGKILL before anything can be said.
    if (signal == SIGUSR1) {
      EXPECT_EQ(stopped.exit_code, 130);
      EXPECT_THAT(stopped.err, HasSubstr("of 5001 values done; what is done is kept in r.h5.journal"));
    }
    EXPECT_FALSE(fs::exists(path("r.h5")));
    goes_on(others++ == 1 ? 1 : 2);
    fs::remove(path("r.h5"));
  }
}

TEST_F(Ranks, AreAllStoppedByASignalToOne) {
  SLIPMODE_NEEDS_MPIRUN();
  for (const std::size_t rank : {0U, 2U}) {
    SCOPED_TRACE(rank);
    SlipmodeProcess launched = mpirun(3, ranks_sweep, folder.path());
    ASSERT_TRUE(launched.signal_when([&] { return journal_size() > 3000; }, 0));
    kill(ranks_of(launched.id()).at(rank), SIGTERM);
    const Outcome stopped = launched.wait();
    EXPECT_EQ(stopped.exit_code, 130);
    EXPECT_THAT(stopped.err, HasSubstr("of 5001 values done"));
    goes_on(2);
    fs::remove(path("r.h5"));
  }
}

TEST_F(Ranks, KeepWhatIsFinishedWhenOneIsKilled) {
  SLIPMODE_NEEDS_MPIRUN();
  std::uintmax_t after = 500;
  for (const std::size_t rank : {1U, 2U, 0U}) {
    SCOPED_TRACE(rank);
    SlipmodeProcess launched = mpirun(3, ranks_sweep, folder.path());
    ASSERT_TRUE(launched.signal_when([&] { return journal_size() > after; }, 0));
    kill(ranks_of(launched.id()).at(rank), SIGKILL);
    const Outcome ended = launched.wait();
    EXPECT_EQ(ended.exit_code, 137);
    EXPECT_THAT(ended.err, HasSubstr("exited on signal 9")) << "mpirun says which";
    EXPECT_FALSE(fs::exists(path("r.h5")));
    goes_on(rank == 1 ? 1 : 3);
    fs::remove(path("r.h5"));
    after *= 20;
  }
}

TEST_F(Ranks, SayWhatOneProcessSaysOnce) {
  SLIPMODE_NEEDS_MPIRUN();
  const Words few = {"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.02", "-o", "r.h5"};
  for (const Words& words : {few, few + Words{"--json"}, Words{"--version"}, Words{"sweep", "--help"}}) {
    const Outcome one = slipmode_in(folder, words), ranks = mpirun(3, words, folder.path()).wait();
    EXPECT_EQ(ranks.exit_code, 0) << ranks.err;
    EXPECT_FALSE(one.out.empty());
    EXPECT_EQ(ranks.out, one.out);
  }
}

TEST_F(Ranks, RefuseOnceWhatTheyCannotDo) {
  SLIPMODE_NEEDS_MPIRUN();
  const auto refused = [&](const Words& words, const testing::Matcher<const std::string&>& said) {
    const Outcome outcome = mpirun(2, words, folder.path()).wait();
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, said);
    const std::size_t first = outcome.err.find("slipmode: ");
    EXPECT_EQ(outcome.err.find("slipmode: ", first + 1), std::string::npos) << outcome.err;
    EXPECT_EQ(folder.names(), std::vector<std::string>({"two.toml"}));
  };
  refused({"run", "two.toml", "-o", "r.h5"}, HasSubstr("run: is computed by one process; start it without"));
  refused({"simulate", "two.toml", "-o", "r.h5"}, HasSubstr("mpirun: runs of an ensemble are divided"));
  refused({"trade", "two.toml"}, HasSubstr("mpirun: expected a name for the result; give one with -o"));
  refused({"diagnose", "two.toml", "-o", "r.h5"},
          HasSubstr("mpirun: values of a key are divided; give one with --over"));
  refused(ranks_sweep + Words{"--shard", "1/2"}, HasSubstr("--shard divides the study, and so does mpirun"));
  refused(ranks_sweep + Words{"--slurm", "jobs"}, HasSubstr("--slurm divides the study, and so does mpirun"));
  refused(ranks_sweep + Words{"--set", "drive.sped=1"}, HasSubstr("sped"));
}

// The lock of the journal is rank 0's alone to fail at: the others wait for it, and are ended.
TEST_F(Ranks, EndWhenTheFirstCannotBegin) {
  SLIPMODE_NEEDS_MPIRUN();
  write_file(path("r.h5.journal"), "slipmode-journal 1 of another task\n");
  const Outcome outcome = mpirun(3, ranks_sweep, folder.path()).wait();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("r.h5.journal: holds unfinished results of another task"));
}

// Files that a node has in another state would mix bytes.
TEST_F(Ranks, WithAnotherSceneAreNamed) {
  SLIPMODE_NEEDS_MPIRUN();
  write_file(path("start.sh"),
             "[ \"$OMPI_COMM_WORLD_RANK\" = 0 ] || set -- \"$@\" --set drive.kind=belt\nexec \"$@\"\n");
  EXPECT_EQ(mpirun(2, ranks_sweep, folder.path(), {"sh", "start.sh"}).wait().exit_code, 0)
      << "the same, said otherwise";
  write_file(path("start.sh"),
             "[ \"$OMPI_COMM_WORLD_RANK\" = 0 ] || set -- \"$@\" --set contact.0.mu_s=0.6\nexec \"$@\"\n");
  const Outcome outcome = mpirun(2, ranks_sweep, folder.path(), {"sh", "start.sh"}).wait();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("rank 1: its study is another than rank 0's"));
}

// Of an MPI that this build does not have, as of none: what the launcher leaves in the environment is all there is.
TEST_F(Ranks, OfALauncherThatIsNotTheirsAreRefused) {
  setenv("PMI_SIZE", "2", 1);
  setenv("PMI_RANK", "0", 1);
  const Outcome first = slipmode_in(folder, ranks_sweep);
  setenv("PMI_RANK", "1", 1);
  const Outcome second = slipmode_in(folder, ranks_sweep);
  unsetenv("PMI_SIZE");
  unsetenv("PMI_RANK");
  EXPECT_EQ(first.exit_code, 2);
  EXPECT_THAT(first.err, HasSubstr("started as one of 2 processes"));
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_EQ(second.err, "");
  EXPECT_EQ(folder.names(), std::vector<std::string>({"two.toml"}));
}

}  // namespace
