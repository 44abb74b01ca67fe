// The scripts for Slurm, run by a stand-in for sbatch that starts tasks one after the other and sends one of them
// Slurm's warning.

#include "cli/folder_tests.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstdlib>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::HasSubstr;

// Task 2's first run is warned as soon as its journal has a value.
constexpr const char* kSbatch = R"sh(#!/bin/bash
for word; do
  case $word in
    --parsable) ;;
    --dependency=*) echo "$word" >> dependencies ;;
    *) script=$word ;;
  esac
done
tasks=$(sed -n 's/^#SBATCH --array=1-//p' "$script")
for task in $(seq "${tasks:-1}"); do
  for run in 1 2 3; do
    rm -f requeue
    SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=1 bash "$script" > said 2>&1 &
    if [ "$task$run" = 21 ]; then
      until [ "$(grep -c sweep-0 "jo bs/2.part.journal" 2> /dev/null)" -ge 1 ] 2> /dev/null || ! kill -0 $!; do
        sleep 0.001
      done
      kill -USR1 $!
    fi
    wait $!
    code=$?
    [ -e requeue ] || break
    cat requeue >> requeued
  done
  [ "$code" -eq 0 ] || { cat said >&2; exit 1; }
done
echo 7
)sh";

class Slurm : public InFolder {
 protected:
  void SetUp() override {
    write_file(folder.path() / "scene.toml", kTwoContacts);
    fs::create_directory(folder.path() / "bin");
    write_executable("sbatch", kSbatch);
    write_executable("scontrol", "#!/bin/bash\necho \"$@\" > requeue\n");
  }
  void write_executable(const std::string& name, const std::string& text) const {
    write_file(folder.path() / "bin" / name, text);
    fs::permissions(folder.path() / "bin" / name, fs::perms::owner_all);
  }
  std::vector<std::string> sweep(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"sweep", "scene.toml",          "--over", "drive.speed=0.3:0.1:0.0005",
                                      "--set", "title=\"it's $HOME\""};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  void refused(const std::vector<std::string>& more, const std::string& said) const {
    const Outcome outcome = slipmode_in(folder, sweep(more));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(said));
    EXPECT_FALSE(fs::exists(folder.path() / "jobs/array.sh"));
  }
};

TEST_F(Slurm, TheScriptsGiveTheBytesOfOneProcessAlsoWhenATaskIsWarned) {
  ASSERT_EQ(slipmode_in(folder, sweep({"-o", "one.h5", "--quiet"})).exit_code, 0);
  const Outcome written = slipmode_in(folder, sweep({"-o", "all.h5", "--slurm", "jo bs", "--shards", "3", "--json"}));
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const auto said = written.json();
  EXPECT_EQ(said["pieces"], 401);  // 0.3 to 0.1 by 0.0005
  EXPECT_GT(said["piece_s"], 0.0);
  EXPECT_GT(said["memory_mb"], 1.0);
  EXPECT_FALSE(fs::exists(folder.path() / "all.h5.journal"));
  const std::string at = folder.path().string();
  const std::string command =
      fmt::format("cd '{0}' && PATH='{0}/bin':\"$PATH\" bash 'jo bs/submit.sh' > submitted 2>&1", at);
  ASSERT_EQ(std::system(command.c_str()), 0) << bytes("submitted");
  EXPECT_EQ(bytes("all.h5") == bytes("one.h5"), true);
  EXPECT_EQ(bytes("dependencies"), "--dependency=afterok:7\n");
  EXPECT_EQ(bytes("requeued"), "requeue 7_2\n");
}

TEST_F(Slurm, WhatCannotBeDividedIsRefused) {
  refused({"--slurm", "jobs"}, "--output is required");
  refused({"-o", "all.h5", "--slurm", "jobs", "--shard", "1/2"}, "expected one of them");
  refused({"-o", "all.h5", "--slurm", "jobs", "--shards", "500"}, "--shards 500: expected at most 401");
  refused({"-o", "all.h5", "--slurm", "jobs", "--follow"}, "one piece");
  EXPECT_TRUE(fs::is_empty(folder.path() / "jobs"));
  refused({"-o", "all.h5", "--shards", "4"}, "--shards 4: goes with --slurm");
  refused({"-o", "all.h5", "--slurm", "scene.toml/jobs"}, "scene.toml/jobs");
}

}  // namespace
