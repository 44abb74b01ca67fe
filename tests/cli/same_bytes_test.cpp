// The same scene, version and seed give the same bytes on every vector width and for any number of threads: the
// executable under each kernel set that has fused multiply-add.

#include <slipmode/core/kernels/kernels.hpp>
#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstdlib>
#include <optional>

namespace {

using namespace slipmode::tests;
using testing::HasSubstr;

/// Sets SLIPMODE_KERNELS for the processes started while it lives.
class WithKernels {
 public:
  explicit WithKernels(const std::string& name) {
    if (const char* before = std::getenv(kName)) before_ = before;
    setenv(kName, name.c_str(), 1);
  }
  ~WithKernels() { before_ ? setenv(kName, before_->c_str(), 1) : unsetenv(kName); }
  WithKernels(const WithKernels&) = delete;
  WithKernels& operator=(const WithKernels&) = delete;

 private:
  static constexpr const char* kName = "SLIPMODE_KERNELS";
  std::optional<std::string> before_;
};

std::vector<std::string> fused_sets() {
  std::vector<std::string> names;
  for (const auto* set : slipmode::kernels::available())
    if (std::string(set->name) != "generic") names.emplace_back(set->name);
  return names;
}

struct Command {
  std::string name, scene;
  std::vector<std::string> arguments;  ///< output file `out.h5` and threads are added
};

void PrintTo(const Command& command, std::ostream* out) { *out << command.name; }

class SameBytes : public testing::TestWithParam<Command> {};

TEST_P(SameBytes, OnEveryVectorWidthAndForAnyNumberOfThreads) {
  const std::vector<std::string> sets = fused_sets();
  if (sets.empty()) GTEST_SKIP() << "no kernel set with fused multiply-add runs here";
  slipmode::tests::TemporaryFolder folder;
  write_file(folder.path() / "scene.toml", GetParam().scene);
  std::string first;
  for (const std::string& set : sets)
    for (const char* threads : {"1", "4"}) {
      const WithKernels forced(set);
      std::vector<std::string> arguments = GetParam().arguments;
      const std::string file = set + threads + ".h5";
      arguments.insert(arguments.end(), {"-o", file, "--threads", threads, "--quiet"});
      const Outcome run = slipmode_in(folder, arguments);
      ASSERT_EQ(run.exit_code, 0) << run.err;
      const std::string bytes = bytes_of(folder.path() / file);
      ASSERT_FALSE(bytes.empty());
      if (first.empty()) first = bytes;
      EXPECT_EQ(bytes == first, true) << "kernels " << set << ", " << threads << " threads";
    }
}

const std::string kStribeck100 = R"(
title = "a hundred masses"
units = "dimensionless"
[structure]
kind = "chain"
masses = 100
stiffness = 1.0
ground_stiffness = 0.25
damping = 0.006
[[contact]]
at = 100
law = "stribeck"
mu_s = 0.4
mu_k = 0.2
alpha = 8.0
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.2
[time]
duration = 300.0
transient = 0.0
sample = 0.5
)";

/// Six attractors over a plane of starts: one in the gap, orbits of periods 3, 4 and 7.
const std::string kBetweenStops = R"(
title = "two masses, one between stops"
units = "dimensionless"
[structure]
kind = "masses"
mass = [1.0, 1.0]
[[structure.link]]
at = 1
stiffness = 1.0
damping = 0.02
[[structure.link]]
between = [1, 2]
stiffness = 1.0
damping = 0.02
[[contact]]
at = 2
law = "clearance"
loss = "zero-force"
stop = { stiffness = 30.0, damping = 0.1, gap = 0.5 }
[drive]
kind = "force"
omega = 2.0
amplitude = 0.6
at = 1
[time]
cycles = 10
)";

INSTANTIATE_TEST_SUITE_P(
    Commands, SameBytes,
    testing::Values(Command{"Stribeck", kStribeck100, {"simulate", "scene.toml"}},
                    Command{"TwoCoulombContacts", kTwoContacts, {"simulate", "scene.toml"}},
                    Command{"StribeckSweep", kFreeEnds, {"sweep", "scene.toml", "--over", "drive.speed=0.1:0.4:0.02"}},
                    Command{"Basins",
                            kBetweenStops,
                            {"orbit", "basins", "scene.toml", "--over", "initial.displacement.1=-2:2:0.8", "--over",
                             "initial.velocity.1=-2:2:0.8"}}),
    [](const auto& one) { return one.param.name; });

TEST(KernelChoice, NamesTheSetsThereAreWhenAskedForAnother) {
  slipmode::tests::TemporaryFolder folder;
  write_file(folder.path() / "scene.toml", kFreeEnds);
  const WithKernels forced("avx1024");
  const Outcome run = slipmode_in(folder, {"simulate", "scene.toml", "-o", "run.h5"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("SLIPMODE_KERNELS is 'avx1024'"));
  EXPECT_THAT(run.err, HasSubstr("generic"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "run.h5"));
  EXPECT_EQ(slipmode_in(folder, {"--version"}).exit_code, 2);
}

TEST(KernelChoice, VersionNamesTheSetInUse) {
  slipmode::tests::TemporaryFolder folder;
  for (const auto* set : slipmode::kernels::available()) {
    const WithKernels forced(set->name);
    EXPECT_THAT(slipmode_in(folder, {"--version"}).out, HasSubstr(std::string("kernels ") + set->name));
  }
}

}  // namespace
