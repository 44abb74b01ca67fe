// Parts of a study: what they say of themselves, and what does not belong together.

#include <slipmode/core/errors.hpp>
#include <slipmode/results/part.hpp>
#include <slipmode/results/provenance.hpp>
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::results {
namespace {

using testing::HasSubstr;

PartHead head(std::size_t number, std::size_t count) {
  return {.shard = {.number = number, .count = count},
          .version = version(),
          .rounding = rounding(),
          .command = "slipmode sweep",
          .words = {"sweep", "it's a scene.toml", "--over=drive.speed=1:2:1"},
          .scene = {.path = "it's a scene.toml", .text = "title = \"é\"\n", .overrides = {"drive.speed=0.25"}}};
}

Part part(const PartHead& head) {
  return {.path = "p" + std::to_string(head.shard.number), .fingerprint = "abc", .head = head, .records = {}};
}

std::string refusal(const std::vector<Part>& parts) {
  return tests::message_of([&] { check_parts(parts); });
}

// 21 pieces among 4 shards: each once, shares of five or six, neighbours with different shards.
TEST(Shard, HasEveryPieceOnceAndSharesAreEven) {
  std::vector<int> sizes(4, 0);
  for (std::size_t piece = 0; piece < 21; ++piece) {
    int owners = 0;
    for (std::size_t number = 1; number <= 4; ++number) {
      const bool has = parse_shard(std::to_string(number) + "/4").has(piece);
      owners += has ? 1 : 0;
      sizes[number - 1] += has ? 1 : 0;
    }
    EXPECT_EQ(owners, 1);
  }
  EXPECT_THAT(sizes, testing::ElementsAre(6, 5, 5, 5));
}

TEST(Part, SaysWhatItsJournalWasToldAndHowItIsMade) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "2.part";
  {
    Journal journal(Journal::path_for(path), shard_fingerprint("abc", head(2, 3).shard));
    journal.append(to_record(head(2, 3)));
    journal.append({"sweep-0", 4, {0.1, -0.0}, "two\nlines"});
    journal.append({"sweep-0", 1, {5e-324}, ""});
    EXPECT_EQ(read_part(path).records.size(), 2U) << "of the journal, as there is no part yet";
    journal.publish(path);
  }
  EXPECT_THAT(folder.names(), testing::ElementsAre("2.part"));
  const Part found = read_part(path);
  EXPECT_EQ(found.fingerprint, "abc");
  EXPECT_EQ(found.head.words, head(2, 3).words);
  EXPECT_EQ(found.head.scene.text, head(2, 3).scene.text);
  EXPECT_EQ(found.head.scene.overrides, head(2, 3).scene.overrides);
  ASSERT_EQ(found.records.size(), 2U);
  EXPECT_EQ(found.records[0].values, std::vector{5e-324}) << "in the order of their numbers";
  EXPECT_EQ(found.records[1].note, "two\nlines");
  EXPECT_EQ(command_line(found),
            "slipmode sweep 'it'\\''s a scene.toml' --over=drive.speed=1:2:1 --shard 2/3 -o " + path.string());
}

// Heads that no shard writes, and what a kill leaves before there is one.
TEST(Part, WithoutAHeadThatCanBeIsRefused) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "1.part";
  const auto refused = [&](const std::vector<JournalRecord>& records) {
    {
      Journal journal(Journal::path_for(path), "abc-1/3");
      for (const JournalRecord& record : records) journal.append(record);
      journal.publish(path);
    }
    return tests::message_of([&] { (void)read_part(path); });
  };
  EXPECT_THAT(refused({}), HasSubstr("is no part of a study"));
  EXPECT_THAT(refused({{"sweep-0", 0, {1.0}, ""}}), HasSubstr("is no part of a study"));
  EXPECT_THAT(refused({to_record(head(0, 0))}), HasSubstr("its head says shard 0/0"));
  EXPECT_THAT(refused({to_record(head(4, 3))}), HasSubstr("its head says shard 4/3"));
  EXPECT_THAT(refused({to_record(head(1, 1'000'000'000'000))}), HasSubstr("its head says shard 1/1000000000000"));
  JournalRecord broken = to_record(head(1, 3));
  broken.note.pop_back();
  EXPECT_THAT(refused({broken}), HasSubstr("its head cannot be read"));
  std::filesystem::remove(path);
  { const Journal killed(Journal::path_for(path), "abc-1/3"); }
  EXPECT_THAT(tests::message_of([&] { (void)read_part(path); }), HasSubstr("run its shard again"));
}

TEST(Parts, OfAnotherVersionOrRoundingAreNamed) {
  check_parts({part(head(2, 2)), part(head(1, 2))});
  PartHead older = head(2, 2);
  older.version = "0.0.9";
  EXPECT_THAT(refusal({part(older)}), HasSubstr("p2: made by slipmode 0.0.9, this is " + version()));
  Part foreign = part(older);
  foreign.fingerprint = "def";
  EXPECT_THAT(refusal({part(head(1, 2)), foreign}),
              HasSubstr("p2: is of another study than p1: made by slipmode 0.0.9, the other by " + version()));
  // First of all: where bases are made anew, other kernels make another study of it.
  PartHead strange = head(2, 2);
  strange.rounding = rounding() == "fused" ? "generic" : "fused";
  Part other = part(strange);
  other.fingerprint = "def";
  EXPECT_THAT(refusal({part(head(1, 2)), other}), HasSubstr("p2: computed with " + strange.rounding + " kernels"));
  EXPECT_THAT(refusal({other}), HasSubstr("from the " + rounding() + " ones here"));
  EXPECT_THAT(refusal({part(head(1, 2)), part(head(0, 2))}), HasSubstr("p0: has no share of the values"));
}

}  // namespace
}  // namespace slipmode::results
