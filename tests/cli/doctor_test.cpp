// What a build has, and what a machine lacks.

#include <slipmode/core/kernels/kernels.hpp>
#include <slipmode/report/report.hpp>
#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace {

using namespace slipmode::tests;
using testing::HasSubstr;

/// Sets an environment variable for the processes started while it lives.
class WithVariable {
 public:
  WithVariable(const char* name, const std::string& value) : name_(name), before_(std::getenv(name)) {
    setenv(name, value.c_str(), 1);
  }
  ~WithVariable() { setenv(name_, before_.c_str(), 1); }
  WithVariable(const WithVariable&) = delete;
  WithVariable& operator=(const WithVariable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

nlohmann::json check_of(const nlohmann::json& said, const std::string& name) {
  for (const auto& check : said["checks"])
    if (check["name"] == name) return check;
  ADD_FAILURE() << "no check " << name;
  return {};
}

TEST(Version, TellsWhatIsBuiltIn) {
  const TemporaryFolder folder;
  const std::string said = slipmode_in(folder, {"--version"}).out;
  for (const auto* set : slipmode::kernels::available()) EXPECT_THAT(said, HasSubstr(set->name));
  EXPECT_THAT(said, HasSubstr(slipmode::report::is_available() ? "report     D3" : "report     none"));
  EXPECT_THAT(said, HasSubstr("processor  "));
  EXPECT_THAT(said, HasSubstr("fourier    "));
  EXPECT_THAT(said, HasSubstr("python     "));
  EXPECT_THAT(said, HasSubstr("mpi        "));
}

TEST(Doctor, FindsNothingNeededMissingWhereTestsRun) {
  const TemporaryFolder folder;
  const Outcome text = slipmode_in(folder, {"doctor"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("nothing that is needed is missing"));
  const Outcome outcome = slipmode_in(folder, {"doctor", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto said = outcome.json();
  EXPECT_EQ(said["status"], "done");
  EXPECT_EQ(check_of(said, "gnuplot")["ok"], true);
  EXPECT_EQ(check_of(said, "report")["ok"], slipmode::report::is_available());
  EXPECT_THAT(slipmode_in(folder, {"--version"}).out, HasSubstr(said["features"]["fourier"].get<std::string>()));
  EXPECT_TRUE(folder.names().empty()) << "looking leaves nothing behind";
}

TEST(Doctor, NamesTheProgramThatIsMissingWhatItServesAndItsPackage) {
  const TemporaryFolder folder;
  const WithVariable path("PATH", folder.path().string());
  const Outcome text = slipmode_in(folder, {"doctor"});
  EXPECT_EQ(text.exit_code, 2);
  for (const char* part : {"missing: gnuplot", "figures", "apt-get install gnuplot-nox", "python3-slipmode"})
    EXPECT_THAT(text.err, HasSubstr(part));
  std::istringstream lines(text.err);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
  const auto said = slipmode_in(folder, {"doctor", "--json"}).json();
  EXPECT_EQ(said["status"], "failed");
  EXPECT_EQ(said["message"], "missing: gnuplot");
  EXPECT_EQ(check_of(said, "gnuplot")["needed"], true);
  EXPECT_EQ(check_of(said, "python")["ok"], false);
  EXPECT_EQ(check_of(said, "python")["needed"], false) << "the executable needs no Python";
  EXPECT_EQ(check_of(said, "mpi")["needed"], false);
  EXPECT_THAT(check_of(said, "mpi")["problem"].get<std::string>(), HasSubstr("apt-get install openmpi-bin"));
}

TEST(Doctor, TellsAFolderThatIsNotThere) {
  const TemporaryFolder folder;
  const Outcome outcome = slipmode_in(folder, {"doctor", "none/here"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("missing: folder"));
  EXPECT_THAT(outcome.err, HasSubstr("none/here"));
  EXPECT_THAT(outcome.err, HasSubstr("mkdir -p"));
}

// A gnuplot without cairo draws no PNG: better said at the start than after the run.
TEST(Doctor, TellsAGnuplotThatCannotDraw) {
  const TemporaryFolder folder;
  write_file(folder.path() / "gnuplot", "#!/bin/sh\necho 'unknown terminal type: pngcairo'\nexit 1\n");
  std::filesystem::permissions(folder.path() / "gnuplot", std::filesystem::perms::owner_all);
  const WithVariable path("PATH", folder.path().string());
  const auto said = slipmode_in(folder, {"doctor", "--json"}).json();
  EXPECT_THAT(check_of(said, "gnuplot")["problem"].get<std::string>(), HasSubstr("pngcairo"));
}

}  // namespace
