#include <slipmode/results/table.hpp>
#include "cli/folder_tests.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kValues = 101;

/// A sweep that can be stopped in the middle: each value takes milliseconds.
class Sweep : public InFolder {
 protected:
  void SetUp() override { write_file(folder.path() / "free.toml", kFreeEnds); }

  static std::vector<std::string> long_sweep(const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"sweep", "free.toml", "--over", "drive.speed=0.4:0.1:0.003",  "-o",
                                          file,    "--json",    "--set",  "validation.transient=4000.0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Stops a sweep by a signal after a few values, lets the same command finish it, and compares with one not stopped.
  void stop_and_resume(int signal, const std::vector<std::string>& manner, const std::vector<std::string>& threads) {
    ASSERT_EQ(slipmode_in(folder, long_sweep("whole.h5", manner)).exit_code, 0);

    std::vector<std::string> first = manner, second = manner;
    first.insert(first.end(), {"--threads", threads.front()});
    second.insert(second.end(), {"--threads", threads.back()});
    SlipmodeProcess process(long_sweep("stopped.h5", first), folder.path());
    ASSERT_TRUE(process.signal_when([this] { return journalled("stopped.h5") >= 5; }, signal))
        << "the sweep ended before it could be stopped: " << process.wait().err;
    const Outcome stopped = process.wait();
    if (signal == SIGINT) {
      EXPECT_EQ(stopped.exit_code, 130);
      EXPECT_EQ(stopped.json()["status"], "interrupted");
    } else {
      EXPECT_EQ(stopped.signal, signal);
    }
    EXPECT_FALSE(fs::exists(folder.path() / "stopped.h5"));
    const int kept = journalled("stopped.h5");
    ASSERT_LT(kept, kValues);

    const Outcome resumed = slipmode_in(folder, long_sweep("stopped.h5", second));
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(resumed.json()["resumed"], kept) << "every value that was finished is taken over";
    EXPECT_EQ(bytes("stopped.h5"), bytes("whole.h5"));
    EXPECT_FALSE(fs::exists(folder.path() / "stopped.h5.journal"));
  }
};

TEST_F(Sweep, GoesOnAfterAnInterruptAsIfThereHadBeenNone) { stop_and_resume(SIGINT, {}, {"1", "2"}); }

TEST_F(Sweep, GoesOnAfterAKillAsIfThereHadBeenNone) { stop_and_resume(SIGKILL, {}, {"2", "1"}); }

TEST_F(Sweep, GoesOnAfterAKillInChainsThatFollow) {
  stop_and_resume(SIGKILL, {"--follow", "--segments", "3"}, {"2", "1"});
}

TEST_F(Sweep, OfAReducedModelGivesTheSameBytesForAnyNumberOfThreads) {
  ASSERT_EQ(slipmode_in(folder, {"reduce", "free.toml", "lnm", "--modes", "2", "-o", "rom.h5"}).exit_code, 0);
  for (const std::string threads : {"1", "2"}) {
    const Outcome outcome =
        slipmode_in(folder, {"sweep", "free.toml", "--over", "contact.0.mu_s=0.3:0.6:0.02", "--model", "rom:rom.h5",
                             "-o", "t" + threads + ".h5", "--threads", threads, "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["values"], 16);
  }
  EXPECT_EQ(bytes("t1.h5"), bytes("t2.h5"));
}

// With all modes a reduced model is the full one, on an affine basis too; periodic motion has the same mean energy.
TEST_F(Sweep, OfAReducedModelWithAllModesHasTheFullModelsEnergies) {
  ASSERT_EQ(slipmode_in(folder, {"simulate", "free.toml", "-o", "run.h5"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"pod", "run.h5", "-o", "pod.h5"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"reduce", "free.toml", "pod.h5", "--modes", "3", "-o", "rom.h5"}).exit_code, 0);
  const auto energies = [&](const std::string& file, const std::string& model) {
    return slipmode::results::load_table(slipmode::results::StoreReader(folder.path() / file),
                                         "sweep/" + model + "/values");
  };
  const auto expect_same = [&](const slipmode::results::Table& full, const slipmode::results::Table& reduced) {
    ASSERT_EQ(full.rows(), reduced.rows());
    for (std::size_t i = 0; i < full.rows(); ++i) {
      ASSERT_EQ(full.texts("motion")[i], "periodic");
      const double energy = full.numbers("mean_energy")[i];
      EXPECT_NEAR(reduced.numbers("mean_energy")[i], energy, 1e-4 * energy);
    }
  };
  for (const std::string over : {"drive.speed=0.2:0.21:0.01", "contact.0.mu_s=0.3:0.4:0.1",
                                 "contact.0.normal_load=1.5:2:0.5", "structure.stiffness=1:1.2:0.1"}) {
    ASSERT_EQ(slipmode_in(folder, {"sweep", "free.toml", "--over", over, "-o", "full.h5"}).exit_code, 0);
    ASSERT_EQ(slipmode_in(folder, {"sweep", "free.toml", "--over", over, "--model", "rom:rom.h5", "-o", "reduced.h5"})
                  .exit_code,
              0);
    SCOPED_TRACE(over);
    expect_same(energies("full.h5", "full"), energies("reduced.h5", "reduced"));
    ASSERT_EQ(slipmode_in(folder, {"diagnose", "free.toml", "pod.h5", "--modes", "3", "--over", over, "--duration",
                                   "20", "-o", "over.h5"})
                  .exit_code,
              0);
    expect_same(energies("over.h5", "full"), energies("over.h5", "reduced"));
  }
}

TEST_F(Sweep, SimulatesNoLongerAtAValueThanItsOwnLimit) {
  const Outcome outcome =
      slipmode_in(folder, {"sweep", "free.toml", "--over", "drive.speed=0.3:0.2:0.1", "-o", "sweep.h5", "--set",
                           "validation.sweep_limit=50.0", "--set", "validation.limit=5000.0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const slipmode::results::StoreReader store(folder.path() / "sweep.h5");
  const slipmode::results::Table values = slipmode::results::load_table(store, "sweep/full/values");
  EXPECT_THAT(values.numbers("time"), testing::Each(150.0));  // transient 100, then less than a block
  EXPECT_THAT(outcome.out, HasSubstr("after 150 units of time"))
      << "too few slips for a verdict, and what to do about it";
}

TEST_F(Sweep, RefusesTheJournalOfAnotherTaskAndLeavesItAlone) {
  SlipmodeProcess process(long_sweep("sweep.h5", {}), folder.path());
  ASSERT_TRUE(process.signal_when([this] { return journalled("sweep.h5") >= 2; }, SIGKILL));
  process.wait();
  const std::string journal = bytes("sweep.h5.journal");
  const Outcome other = slipmode_in(folder, long_sweep("sweep.h5", {"--set", "structure.damping=0.02"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("sweep.h5.journal"));
  EXPECT_EQ(bytes("sweep.h5.journal"), journal);
}

TEST_F(Sweep, RecordsAValueThatFailsAndGoesOn) {
  // The rate of events changes with the belt speed: a window that holds too many of them at some speeds only.
  const Outcome outcome =
      slipmode_in(folder, {"sweep", "free.toml", "--over", "drive.speed=0.8:0.05:0.05", "-o", "sweep.h5", "--json",
                           "--set", "flow.max_events_per_window=40", "--set", "flow.zeno_window=100.0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto found = outcome.json();
  EXPECT_EQ(found["values"], 16);
  ASSERT_GT(found["failures"].size(), 0U);
  ASSERT_LT(found["failures"].size(), 16U);
  EXPECT_THAT(found["failures"][0]["reason"].get<std::string>(), HasSubstr("Zeno"));
  EXPECT_EQ(found["motions"]["failed"], found["failures"].size());
}

TEST_F(Sweep, AnInterruptedRunKeepsItsFolderAndGoesOn) {
  const std::vector<std::string> whole = {"run",
                                          "free.toml",
                                          "-o",
                                          "whole",
                                          "--json",
                                          "--set",
                                          "validation.speeds={from=0.4, to=0.1, step=0.003}",
                                          "--set",
                                          "validation.transient=4000.0"};
  std::vector<std::string> arguments = whole;
  arguments[3] = "stopped";
  SlipmodeProcess process(arguments, folder.path());
  ASSERT_TRUE(process.signal_when([this] { return journalled("stopped.partial/validation.h5") >= 5; }, SIGINT));
  const Outcome stopped = process.wait();
  EXPECT_EQ(stopped.exit_code, 130);
  EXPECT_FALSE(fs::exists(folder.path() / "stopped"));

  // Another task for the same folder is refused, and what was interrupted survives that.
  std::vector<std::string> other = arguments;
  other.insert(other.end(), {"--set", "structure.damping=0.02"});
  EXPECT_EQ(slipmode_in(folder, other).exit_code, 2);

  const Outcome resumed = slipmode_in(folder, arguments);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  const Outcome uninterrupted = slipmode_in(folder, whole);
  ASSERT_EQ(uninterrupted.exit_code, 0) << uninterrupted.err;
  EXPECT_EQ(resumed.json()["validation"]["sweep"], uninterrupted.json()["validation"]["sweep"]);
  EXPECT_EQ(resumed.json()["validation"]["bifurcation"], uninterrupted.json()["validation"]["bifurcation"]);
}

}  // namespace
