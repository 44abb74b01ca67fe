// slipmode diagnose SCENE, through the executable, on scenes of milliseconds.

#include <slipmode/results/store.hpp>
#include <slipmode/results/table.hpp>
#include "cli/folder_tests.hpp"

#include <gtest/gtest.h>
#include <csignal>
#include <string>
#include <vector>

namespace {

using namespace slipmode;
using namespace slipmode::tests;

class DiagnoseModel : public QuietStudies {};

TEST_F(DiagnoseModel, FileFiguresAndJsonSayTheSameExponents) {
  const Outcome outcome = call({"diagnose", "two.toml", "--duration", "200", "-o", "two.h5", "--figures", "drawn"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto model = outcome.json()["exponents"][0];
  EXPECT_EQ(model["directions"], 8);
  const results::StoreReader store(folder.path() / "two.h5");
  const results::Table values = results::load_table(store, "exponents/0/values");
  ASSERT_EQ(values.rows(), 8U);
  EXPECT_EQ(values.numbers("nats")[0], model["nats"][0].get<double>());
  EXPECT_EQ(store.integer("exponents/0/lost"), model["lost"].get<std::int64_t>());
  // The sum by tangents and by forces and speeds along the motion: independent of one another.
  EXPECT_NEAR(model["balance"]["sum"].get<double>(), model["balance"]["expected"].get<double>(), 1e-3);
  EXPECT_EQ(store.matrix("exponents/0/running").cols(), 8);
  for (const std::string name : {"exponents", "convergence", "expansion"}) {
    EXPECT_TRUE(is_figure(folder.path() / "drawn" / (name + ".svg"))) << name;
    EXPECT_TRUE(is_figure(folder.path() / "drawn" / (name + ".png"))) << name;
  }
  EXPECT_EQ(slipmode_in(folder, {"plot", "two.h5", "--figure", "convergence", "-o", "again.svg"}).exit_code, 0);
  EXPECT_TRUE(is_figure(folder.path() / "again.svg"));
}

TEST_F(DiagnoseModel, VerdictPutsFullAndReducedSideBySide) {
  ASSERT_EQ(slipmode_in(folder, {"simulate", "free.toml", "-o", "run.h5", "--quiet"}).exit_code, 0);
  ASSERT_EQ(slipmode_in(folder, {"pod", "run.h5", "-o", "pod.h5", "--quiet"}).exit_code, 0);
  const Outcome outcome =
      call({"diagnose", "free.toml", "pod.h5", "--modes", "2", "--verdict", "--duration", "300", "-o", "v.h5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto models = outcome.json()["verdict"]["models"];
  ASSERT_EQ(models.size(), 3U);
  EXPECT_EQ(models[0]["model"], "full");
  EXPECT_EQ(models[1]["model"], "2 POMs");
  EXPECT_EQ(models[1]["degrees_of_freedom"], 2);
  const auto sticks = models[0]["figures"]["sticks"];
  EXPECT_NEAR(sticks["value"].get<double>(),
              0.5 * (sticks["halves"][0].get<double>() + sticks["halves"][1].get<double>()), 1e-9);
  const results::Table table = results::load_table(results::StoreReader(folder.path() / "v.h5"), "verdict");
  EXPECT_EQ(table.rows() % 3, 0U);

  const Outcome validated = slipmode_in(
      folder, {"validate", "free.toml", "pod.h5", "--no-sweep", "--verdict", "-o", "w.h5", "--json", "--quiet"});
  ASSERT_EQ(validated.exit_code, 0) << validated.err;
  EXPECT_EQ(validated.json()["validation"]["verdict"]["models"].size(), 3U);
  EXPECT_TRUE(results::StoreReader(folder.path() / "w.h5").has("verdict"));
}

TEST_F(DiagnoseModel, OverAKeyIsTheSpectrumAtEveryValueAndGoesOnAfterAnInterruption) {
  const std::vector<std::string> over = {"diagnose",   "free.toml", "--over", "drive.speed=0.4:0.2:0.05",
                                         "--duration", "200",       "-o",     "over.h5",
                                         "--json",     "--quiet"};
  ASSERT_EQ(slipmode_in(folder, over).exit_code, 0);
  const results::StoreReader whole(folder.path() / "over.h5");
  const Eigen::MatrixXd exponents = whole.columns("exponents/full/nats");
  EXPECT_EQ(exponents.rows(), 4);
  EXPECT_EQ(exponents.cols(), 5);
  EXPECT_EQ(results::load_table(whole, "sweep/full/values").rows(), 5U);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "over.h5.journal"));

  // Killed as soon as something has been kept; whether the end came before is no matter.
  std::vector<std::string> again = over;
  again[7] = "again.h5";
  {
    SlipmodeProcess process(again, folder.path());
    process.signal_when([&] { return std::filesystem::exists(folder.path() / "again.h5.journal"); }, SIGKILL);
    static_cast<void>(process.wait());
  }
  ASSERT_EQ(slipmode_in(folder, again).exit_code, 0);
  EXPECT_EQ(results::StoreReader(folder.path() / "again.h5").columns("exponents/full/nats"), exponents);
}

TEST_F(DiagnoseModel, RefusesWhatMakesNoSense) {
  refused({"diagnose", "two.toml", "--exponents", "9"}, "8 directions");
  refused({"diagnose", "two.toml", "--over", "drive.speed=0.1:0.2:0.1"}, "-o");
  refused({"diagnose", "two.toml", "--over", "drive.speed=0.1:0.2:0.1", "--verdict", "-o", "x.h5"},
          "--verdict and --over");
  refused({"diagnose", "two.toml", "missing.h5"}, "missing.h5");
  refused({"diagnose", "two.toml", "--renormalise", "300", "--duration", "200"}, "duration >= interval");
}

}  // namespace
