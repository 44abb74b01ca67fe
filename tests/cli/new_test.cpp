#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

class NewScenes : public testing::TestWithParam<const char*> {
 protected:
  TemporaryFolder folder;
};

TEST_P(NewScenes, RunAtOnceWithFiguresAndAReport) {
  const Outcome made = slipmode_in(folder, {"new", GetParam(), "-o", "scene.toml"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("slipmode run scene.toml -o out"));
  const Outcome run = slipmode_in(folder, {"run", "scene.toml", "-o", "out", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto said = run.json();
  EXPECT_GE(said["figures"].size(), 4U);
  for (const std::string name : said["figures"]) EXPECT_TRUE(is_figure(folder.path() / "out" / name)) << name;
  EXPECT_EQ(said["report"], "out/report.html");
  EXPECT_TRUE(fs::exists(folder.path() / "out/report.html"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, NewScenes, testing::Values("chain", "beam", "matrices", "clearance"));

TEST(New, GoesToStandardOutputOrToAFileThatIsNotThere) {
  const TemporaryFolder folder;
  const Outcome shown = slipmode_in(folder, {"new", "chain"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  ASSERT_EQ(slipmode_in(folder, {"new", "chain", "-o", "scene.toml"}).exit_code, 0);
  EXPECT_EQ(bytes_of(folder.path() / "scene.toml"), shown.out);
  const Outcome again = slipmode_in(folder, {"new", "beam", "-o", "scene.toml"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("scene.toml: is there already; choose another name"));
  EXPECT_EQ(bytes_of(folder.path() / "scene.toml"), shown.out);
  const Outcome other = slipmode_in(folder, {"new", "plate"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("plate: no such kind of scene; valid: chain, beam, matrices, clearance"));
}

TEST(Schema, GoesToStandardOutputOrToAFile) {
  const TemporaryFolder folder;
  const Outcome shown = slipmode_in(folder, {"schema"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(shown.json()["title"], "A scene of slipmode");
  const Outcome written = slipmode_in(folder, {"schema", "-o", "s.json"});
  EXPECT_THAT(written.out, HasSubstr("#:schema s.json"));
  EXPECT_EQ(bytes_of(folder.path() / "s.json"), shown.out);
}

// Slowest period of two masses of 1 kg on springs of 1e6 N/m, one end held: 2π/(2 · 1000 sin(π/10)) = 0.01017 s.
TEST(Times, ThatASceneDoesNotGiveAreChosenAndSaid) {
  const TemporaryFolder folder;
  write_file(folder.path() / "s.toml",
             "units = \"SI\"\n[structure]\nkind = \"chain\"\nmasses = 2\nstiffness = 1e6\ndamping = 1e-4\n[[contact]]\n"
             "at = 2\nlaw = \"coulomb\"\nmu_s = 0.4\nmu_k = 0.3\nnormal_load = 10.0\n[drive]\nkind = \"belt\"\n"
             "speed = 0.1\n");
  const Outcome run = slipmode_in(folder, {"simulate", "s.toml", "-o", "run.h5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("slowest natural period, 0.01017 s: time.duration 2.2"));
  EXPECT_THAT(run.out, HasSubstr("time.sample 0.0001"));
  const Outcome given =
      slipmode_in(folder, {"simulate", "s.toml", "-o", "run.h5", "--set", "time={duration=1.0, sample=0.01}"});
  EXPECT_EQ(given.out.find("Chosen"), std::string::npos) << given.out;
}

}  // namespace
