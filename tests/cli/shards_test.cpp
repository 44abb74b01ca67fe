// A study divided among processes: the parts of any number of shards join to the bytes of one process, as ranks give
// them, and what does not belong together is named.

#include <slipmode/results/table.hpp>
#include "cli/folder_tests.hpp"
#include "cli/mpirun.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>

namespace {

using namespace slipmode::tests;
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const std::string kSharedBeam = SLIPMODE_SOURCE_DIR "/datasets/beam_12hz/scene.toml";
const Words kFewCycles = {"--set", "structure.elements=6", "--set", "validation.cycles=40.0",
                          "--set", "validation.kept=25.0"};

struct Divided {
  std::string name;
  Words arguments;                ///< output and threads are added
  std::vector<int> shards;        ///< numbers of processes tried
  std::vector<Words> first = {};  ///< what makes the files it reads
};

void PrintTo(const Divided& study, std::ostream* out) { *out << study.name; }

class Shards : public OnSmallScenes, public testing::WithParamInterface<Divided> {
 protected:
  void run(const Words& words) const {
    const Outcome outcome = slipmode_in(folder, words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  /// The parts of N processes; given to merge from the last to the first.
  Words parts(const Words& study, int count) const {
    Words names;
    for (int k = 1; k <= count; ++k) {
      names.insert(names.begin(), fmt::format("{}of{}.part", k, count));
      run(study + Words{"--shard", fmt::format("{}/{}", k, count), "-o", names.front(), "--threads",
                        k % 2 == 0 ? "4" : "1", "--quiet"});
    }
    return names;
  }
};

TEST_P(Shards, OfAnyNumberGiveTheBytesOfOneProcess) {
  const Words& study = GetParam().arguments;
  for (const Words& before : GetParam().first) run(before);
  run(study + Words{"-o", "one.h5", "--threads", "1", "--quiet"});
  run(study + Words{"-o", "threads.h5", "--threads", "4", "--quiet"});
  const std::string one = bytes("one.h5");
  ASSERT_FALSE(one.empty());
  EXPECT_EQ(bytes("threads.h5") == one, true);
  for (const int count : GetParam().shards) {
    SCOPED_TRACE(count);
    run(Words{"merge"} + parts(study, count) + Words{"-o", "merged.h5"});
    EXPECT_EQ(bytes("merged.h5") == one, true);
    EXPECT_FALSE(fs::exists(folder.path() / "merged.h5.journal"));
  }
  // A part is the same bytes too, whichever value was finished first.
  const int most = GetParam().shards.back();
  run(study + Words{"--shard", fmt::format("2/{}", most), "-o", "again.part", "--threads", "3", "--quiet"});
  EXPECT_EQ(bytes("again.part") == bytes(fmt::format("2of{}.part", most)), true);
}

TEST_P(Shards, OfRanksGiveTheBytesOfOneProcess) {
  SLIPMODE_NEEDS_MPIRUN();
  const Words& study = GetParam().arguments;
  for (const Words& before : GetParam().first) run(before);
  run(study + Words{"-o", "one.h5", "--threads", "1", "--quiet"});
  const std::string one = bytes("one.h5");
  for (const auto& [ranks, threads] : {std::pair{2, "2"}, {3, "1"}}) {
    SCOPED_TRACE(ranks);
    const Outcome outcome = mpirun(ranks, study + Words{"-o", "ranks.h5", "--threads", threads}, folder.path()).wait();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(bytes("ranks.h5") == one, true);
    EXPECT_FALSE(fs::exists(folder.path() / "ranks.h5.journal"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Studies, Shards,
    testing::Values(
        Divided{"Ensemble",
                {"simulate", "free.toml", "--set", "ensemble.speeds=[0.3, 0.2, 0.1]", "--set", "time.duration=150"},
                {3, 7}},
        Divided{
            "EnsembleAtFrequencies",
            Words{"simulate", kSharedBeam, "--set", "ensemble.frequencies=[10.0, 14.0]", "--set", "ensemble.members=4",
                  "--set", "ensemble.spread=1e-4", "--set", "time.cycles=30", "--set", "time.transient_cycles=20"} +
                kFewCycles,
            {3, 7}},
        Divided{"Sweep",
                {"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.02", "--set", "contact.0.mu_s=0.45"},
                {3, 7}},
        Divided{"SweepInChains",
                {"sweep", "free.toml", "--over", "drive.speed=0.4:0.1:0.02", "--follow", "--segments", "7"},
                {3, 7}},
        Divided{"SweepOfAReducedModel",
                {"sweep", "free.toml", "--over", "drive.speed=0.4:0.2:0.02", "--model", "rom:rom.h5", "--seed", "3"},
                {3, 7},
                {{"simulate", "free.toml", "-o", "ensemble.h5"},
                 {"pod", "ensemble.h5", "-o", "pod.h5"},
                 {"reduce", "free.toml", "pod.h5", "--modes", "2", "-o", "rom.h5"}}},
        Divided{
            "ShakenUpAndDown",
            Words{"sweep", kSharedBeam, "--over", "drive.frequency=8:20:1", "--follow", "--both", "--segments", "4"} +
                kFewCycles,
            {3, 7}},
        Divided{"ShakenUpAndDownEachOneChain",
                Words{"sweep", kSharedBeam, "--over", "drive.frequency=8:20:1", "--follow", "--both"} + kFewCycles,
                {2}},
        Divided{"EnsembleAtOmegas",
                {"simulate", kBacklash, "--set", "ensemble.omegas=[0.6, 1.0, 1.4]", "--set", "ensemble.members=2",
                 "--set", "ensemble.spread=0.1", "--set", "time.cycles=40", "--set", "time.transient_cycles=20"},
                {3, 5}},
        Divided{"ForcedUpAndDown",
                {"sweep", kBacklash, "--over", "drive.omega=0.6:1.4:0.1", "--follow", "--both", "--segments", "3",
                 "--set", "validation.cycles=60", "--set", "validation.kept=30"},
                {3, 5}},
        Divided{"OrbitMap",
                {"orbit", "map", kBacklash, "--over", "drive.omega=0.4:1.8:0.2", "--over",
                 "drive.amplitude=0.6:1.4:0.2", "--start", "both"},
                {3, 7}},
        Divided{"Stroboscope",
                {"orbit", "map", kBacklash, "--over", "drive.omega=0.4:1.8:0.2", "--periods", "200"},
                {3, 7}},
        Divided{"StroboscopeThatFollows",
                {"orbit", "map", kBacklash, "--over", "drive.omega=0.4:1.8:0.2", "--periods", "200", "--follow",
                 "--start", "both"},
                {2}},
        Divided{"Basins",
                {"orbit", "basins", kBacklash, "--over", "initial.displacement.0=-3:3:0.5", "--over",
                 "initial.velocity.0=-3:3:0.5", "--along", "drive.omega=0.9:1.1:0.1", "--sample", "4"},
                {3, 7}},
        Divided{"Exponents",
                {"diagnose", "free.toml", "pod.h5", "--over", "drive.speed=0.3:0.1:0.02", "--modes", "2", "--duration",
                 "20"},
                {3, 7},
                {{"simulate", "free.toml", "-o", "ensemble.h5"}, {"pod", "ensemble.h5", "-o", "pod.h5"}}}),
    [](const auto& tested) { return tested.param.name; });

// Times are measured where the result is made, all else is the same bytes.
class DividedTrade : public Shards {
 protected:
  void same_but_times(const char* file) const {
    const slipmode::results::StoreReader one(folder.path() / "one.h5"), other(folder.path() / file);
    const auto expected = load_table(one, "trade/candidates"), found = load_table(other, "trade/candidates");
    EXPECT_EQ(found.texts("name"), expected.texts("name"));
    EXPECT_EQ(found.texts("failure"), expected.texts("failure"));
    for (const char* measure : {"dX", "dE", "points", "energy", "dX_noise", "energy_noise"})
      EXPECT_THAT(found.numbers(measure),
                  testing::Pointwise(testing::NanSensitiveDoubleEq(), expected.numbers(measure)))
          << measure;
  }

  const std::vector<Words> studies = {{"trade", "free.toml", "--axes", "modes,flow"}, {"advise", "free.toml"}};
};

TEST_F(DividedTrade, AmongShardsGivesTheErrorsOfOneProcess) {
  for (const Words& study : studies) {
    SCOPED_TRACE(study[0]);
    run(study + Words{"-o", "one.h5", "--quiet"});
    run(Words{"merge"} + parts(study, 3) + Words{"-o", "merged.h5", "--quiet"});
    same_but_times("merged.h5");
    fs::remove(folder.path() / "merged.h5");
    for (const char* part : {"1of3.part", "2of3.part", "3of3.part"}) fs::remove(folder.path() / part);
  }
}

TEST_F(DividedTrade, AmongRanksGivesTheErrorsOfOneProcess) {
  SLIPMODE_NEEDS_MPIRUN();
  for (const Words& study : studies) {
    SCOPED_TRACE(study[0]);
    run(study + Words{"-o", "one.h5", "--quiet"});
    const Outcome outcome = mpirun(3, study + Words{"-o", "ranks.h5"}, folder.path()).wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    same_but_times("ranks.h5");
  }
}

// What a comparison sweeps is divided; its other numbers are found where the result is made.
class DividedValidation : public Shards {
 protected:
  struct Study {
    Words words;
    std::vector<Words> first;
    const char* tables[3];
  };
  const std::vector<Study> studies = {
      {{"validate", "free.toml", "pod.h5", "--set", "validation.segments=3"},
       {{"simulate", "free.toml", "-o", "ensemble.h5"}, {"pod", "ensemble.h5", "-o", "pod.h5"}},
       {"sweep/full/values", "sweep/reduced/values", "validation/orbits"}},
      {Words{"validate", kSharedBeam, "beam.h5", "--set", "validation.frequencies={from=10.0, to=14.0, step=2.0}",
             "--set", "validation.modes=[1, 2]", "--set", "validation.bases=[\"lnm\"]"} +
           kFewCycles,
       {Words{"simulate", kSharedBeam, "-o", "motion.h5", "--single", "--set", "time.cycles=30", "--set",
              "time.transient_cycles=20"} +
            kFewCycles,
        Words{"pod", "motion.h5", "-o", "beam.h5"}},
       {"shaken_validation/agreement", "shaken_validation/full/values", "shaken_validation/again/values"}}};

  void same(const char* file, const Study& study) const {
    const slipmode::results::StoreReader expected(folder.path() / "one.h5"), found(folder.path() / file);
    for (const char* name : study.tables) {
      SCOPED_TRACE(name);
      const auto whole = load_table(expected, name), joined = load_table(found, name);
      ASSERT_EQ(joined.columns.size(), whole.columns.size());
      for (const auto& column : whole.columns) {
        if (column.name == "wall" || column.name == "cpu" || column.name == "setup") continue;
        const auto* numbers = std::get_if<std::vector<double>>(&column.values);
        if (numbers == nullptr) continue;
        EXPECT_THAT(joined.numbers(column.name), testing::Pointwise(testing::NanSensitiveDoubleEq(), *numbers))
            << column.name;
      }
    }
  }
};

TEST_F(DividedValidation, AmongShardsGivesTheNumbersOfOneProcess) {
  for (const Study& study : studies) {
    SCOPED_TRACE(study.words[1]);
    for (const Words& before : study.first) run(before);
    run(study.words + Words{"-o", "one.h5", "--quiet"});
    run(Words{"merge"} + parts(study.words, 3) + Words{"-o", "merged.h5", "--quiet"});
    same("merged.h5", study);
    for (const char* part : {"1of3.part", "2of3.part", "3of3.part"}) fs::remove(folder.path() / part);
  }
}

TEST_F(DividedValidation, AmongRanksGivesTheNumbersOfOneProcess) {
  SLIPMODE_NEEDS_MPIRUN();
  for (const Study& study : studies) {
    SCOPED_TRACE(study.words[1]);
    for (const Words& before : study.first) run(before);
    run(study.words + Words{"-o", "one.h5", "--quiet"});
    const Outcome outcome = mpirun(2, study.words + Words{"-o", "ranks.h5"}, folder.path()).wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    same("ranks.h5", study);
  }
}

/// Parts 1 to 3 of a sweep of 11 values, and what is to be refused beside them.
class BadParts : public Shards {
 protected:
  void SetUp() override {
    Shards::SetUp();
    (void)parts(sweep, 3);
  }
  /// Exit code 2, a message with the words, and nothing written.
  void refused(const Words& words, const testing::Matcher<const std::string&>& said) const {
    const auto before = folder.names();
    const Outcome outcome = slipmode_in(folder, words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, said);
    EXPECT_EQ(folder.names(), before);
  }
  void refuses_to_merge(const Words& names, const testing::Matcher<const std::string&>& said) const {
    refused(Words{"merge"} + names + Words{"-o", "merged.h5"}, said);
  }

  const Words sweep = {"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.02"};
};

TEST_F(BadParts, ShardsThatCannotBeAreRefusedBeforeAnythingIsWritten) {
  for (const char* shard : {"0/4", "8/7", "1/0", "1/4x", "2of4", "-1/4", "/", "1"})
    refused(sweep + Words{"--shard=" + std::string(shard), "-o", "b.part"}, HasSubstr("expected I/N with I = 1 ... N"));
  refused(sweep + Words{"--shard", "1/12", "-o", "b.part"}, HasSubstr("at most 11 shards, the number of values"));
  refused(sweep + Words{"--follow", "--shard", "1/2", "-o", "b.part"},
          AllOf(HasSubstr("at most 1 shards"), HasSubstr("more with --segments, or without --follow")));
  refused({"diagnose", "two.toml", "--over", "drive.speed=0.3:0.1:0.02", "--follow", "--shard", "1/2", "-o", "b.part"},
          HasSubstr("without --follow"));
  refused(sweep + Words{"--shard", "1/3"}, HasSubstr("--output is required"));
  refused({"trade", "two.toml", "--shard", "1/3"}, HasSubstr("give one with -o"));
  refused({"diagnose", "two.toml", "--shard", "1/3", "-o", "b.part"}, HasSubstr("give one with --over"));
  run({"simulate", "free.toml", "-o", "ensemble.h5", "--quiet"});
  run({"pod", "ensemble.h5", "-o", "pod.h5", "--quiet"});
  refused({"validate", "free.toml", "pod.h5", "--shard", "1/3", "-o", "b.part"},
          AllOf(HasSubstr("--shard 1/3: expected at most 1 shards"), HasSubstr("more with validation.segments")));
  refused({"simulate", "two.toml", "--shard", "1/3", "-o", "b.part"}, HasSubstr("one trajectory is one piece"));
  refused({"run", "two.toml", "--shard", "1/3", "-o", "b.part"}, HasSubstr("--shard"));
  refused(sweep + Words{"--shard", "1/3", "-o", "two.toml"}, HasSubstr("two.toml: is neither a journal nor a part"));
  const std::string first = bytes("1of3.part");
  refused(sweep + Words{"--shard", "2/3", "-o", "1of3.part"},
          HasSubstr("1of3.part: is a finished part of another shard"));
  EXPECT_EQ(bytes("1of3.part"), first);
}

TEST_F(BadParts, MissingAndDoubledOnesAreNamed) {
  refuses_to_merge({"1of3.part", "3of3.part"}, AllOf(HasSubstr("1 of 3 parts are missing"),
                                                     HasSubstr("--over=drive.speed=0.3:0.1:0.02 --shard 2/3")));
  write_file(folder.path() / "copy.part", bytes("2of3.part"));
  refuses_to_merge({"1of3.part", "2of3.part", "3of3.part", "copy.part"},
                   HasSubstr("copy.part: is shard 2/3, as 2of3.part is; give each once"));
  refused({"merge", "1of3.part", "2of3.part", "3of3.part", "-o", "./2of3.part"}, HasSubstr("is one of the parts"));
  refuses_to_merge({"1of3.part", "none.part"}, HasSubstr("none.part: there is no such part"));
  refuses_to_merge({"1of3.part", "two.toml"}, HasSubstr("two.toml: is neither a journal nor a part"));
}

TEST_F(BadParts, ThoseOfAnotherStudyAreNamedWithWhatDiffers) {
  const auto other = [&](const Words& study, const std::string& shard) {
    run(study + Words{"--shard", shard, "-o", "other.part", "--quiet"});
  };
  other(sweep + Words{"--set", "contact.0.mu_s=0.55"}, "3/3");
  refuses_to_merge({"1of3.part", "2of3.part", "other.part"},
                   HasSubstr("other.part: is of another study than 1of3.part: its scene has 'mu_s = 0.55' where the "
                             "other has 'mu_s = 0.5'"));
  fs::remove(folder.path() / "other.part");
  other({"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.04"}, "3/3");
  refuses_to_merge({"1of3.part", "2of3.part", "other.part"}, HasSubstr("made by 'slipmode sweep --over "
                                                                       "drive.speed=0.3:0.1:0.04"));
  fs::remove(folder.path() / "other.part");
  other(sweep, "3/4");
  refuses_to_merge({"1of3.part", "2of3.part", "other.part"},
                   HasSubstr("other.part: is shard 3/4, 1of3.part is shard 1/3"));
  refuses_to_merge({"1of3.part", "2of3.part", "3of3.part", "--set", "time.sample=1"},
                   HasSubstr("parts hold their scene"));
}

TEST_F(BadParts, AFileThatTheCommandReadsMustBeTheSame) {
  run({"simulate", "free.toml", "-o", "ensemble.h5", "--quiet"});
  run({"pod", "ensemble.h5", "-o", "pod.h5", "--quiet"});
  run({"reduce", "free.toml", "pod.h5", "--modes", "2", "-o", "rom.h5", "--quiet"});
  run({"sweep", "free.toml", "--over", "drive.speed=0.4:0.3:0.05", "--model", "rom:rom.h5", "--shard", "1/1", "-o",
       "rom.part", "--quiet"});
  run({"reduce", "free.toml", "pod.h5", "--modes", "1", "-o", "rom.h5", "--quiet"});
  refuses_to_merge({"rom.part"}, AllOf(HasSubstr("rom.part: the files that"), HasSubstr("rom:rom.h5")));
}

TEST_F(BadParts, DamageIsFoundWhereverItIs) {
  const std::string whole = bytes("2of3.part");
  for (const std::size_t at : {whole.size() / 8, whole.size() / 3, whole.size() / 2, whole.size() - 3}) {
    SCOPED_TRACE(at);
    std::string altered = whole;
    altered[at] = altered[at] == '7' ? '8' : '7';
    write_file(folder.path() / "2of3.part", altered);
    refuses_to_merge({"1of3.part", "2of3.part", "3of3.part"}, HasSubstr("2of3.part: damaged at byte"));
    write_file(folder.path() / "2of3.part", whole.substr(0, at));
    refuses_to_merge({"1of3.part", "2of3.part", "3of3.part"}, HasSubstr("2of3.part: damaged at byte"));
  }
}

// What it says to finish the part with is what finishes it.
TEST_F(BadParts, AnUnfinishedOneIsToldWithItsValuesAndTheCommandThatFinishesIt) {
  const std::string whole = bytes("2of3.part");
  std::size_t lines = 0, kept = 0;
  while (lines < 3) lines += whole[kept++] == '\n' ? 1 : 0;  // the fingerprint, the head, one value
  fs::remove(folder.path() / "2of3.part");
  write_file(folder.path() / "2of3.part.journal", whole.substr(0, kept + 20));
  // Of 0.3, 0.28, ... 0.1 the shard has those numbered 1, 4, 7, 10 from 0; the first is there.
  const auto said =
      AllOf(HasSubstr("2of3.part: unfinished, 3 values are missing (sweep 0.22, sweep 0.16, sweep 0.1)"),
            HasSubstr("slipmode sweep two.toml --over=drive.speed=0.3:0.1:0.02 --shard 2/3 -o 2of3.part"));
  refuses_to_merge({"1of3.part", "2of3.part", "3of3.part"}, said);
  refuses_to_merge({"1of3.part", "2of3.part.journal", "3of3.part"}, said);
  const Outcome finished = slipmode_in(
      folder, {"sweep", "two.toml", "--over=drive.speed=0.3:0.1:0.02", "--shard", "2/3", "-o", "2of3.part", "--json"});
  EXPECT_EQ(finished.json()["resumed"], 1);
  EXPECT_EQ(bytes("2of3.part") == whole, true);
  run({"merge", "1of3.part", "2of3.part", "3of3.part", "-o", "merged.h5"});
  run({"merge", "1of3.part", "2of3.part", "3of3.part", "-o", "merged.h5"});  // replaces it, as any verb does
}

TEST_F(BadParts, AShardThatRunsIsNotStartedTwice) {
  const Words shard = {"sweep", "two.toml", "--over", "drive.speed=0.3:0.1:0.0001", "--shard", "1/2", "-o", "run.part"};
  SlipmodeProcess first(shard, folder.path());
  const fs::path journal = folder.path() / "run.part.journal";
  ASSERT_TRUE(first.signal_when([&] { return fs::exists(journal) && fs::file_size(journal) > 3000; }, SIGSTOP));
  ASSERT_TRUE(fs::exists(journal)) << "over before it was stopped";
  const Outcome second = slipmode_in(folder, shard);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.err, HasSubstr("another process is writing it"));
  ASSERT_TRUE(first.signal_when([] { return true; }, SIGTERM));
  ASSERT_TRUE(first.signal_when([] { return true; }, SIGCONT));
  const Outcome stopped = first.wait();
  EXPECT_EQ(stopped.exit_code, 130);
  const Outcome rest = slipmode_in(folder, shard + Words{"--json"});
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_GT(rest.json()["resumed"], 0);
}

}  // namespace
