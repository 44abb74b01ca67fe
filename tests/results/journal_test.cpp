#include <slipmode/core/errors.hpp>
#include <slipmode/results/journal.hpp>
#include "scene/messages.hpp"
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <bit>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

namespace {

using namespace slipmode;
using slipmode::tests::bytes_of;
using slipmode::tests::TemporaryFolder;

JournalRecord record_number(int i) {
  return {"full", i, {i + 0.1, std::sqrt(2.0) * i, -0.0}, i % 2 == 0 ? "" : "because\nof \\ this"};
}

void expect_same(const JournalRecord& a, const JournalRecord& b) {
  EXPECT_EQ(a.table, b.table);
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.note, b.note);
  ASSERT_EQ(a.values.size(), b.values.size());
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.values[k]), std::bit_cast<std::uint64_t>(b.values[k]));
  }
}

TEST(Journal, GivesBackEveryBit) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "j";
  {
    Journal journal(path, "task");
    EXPECT_FALSE(journal.resumed());
    for (int i = 0; i < 5; ++i) journal.append(record_number(i));
    journal.append({"rom", -1, {5e-324, std::numeric_limits<double>::infinity(), std::nan("")}, ""});
    journal.append({"rom", 2, {}, "no values"});
  }
  const Journal journal(path, "task");
  EXPECT_TRUE(journal.resumed());
  ASSERT_EQ(journal.records().size(), 7U);
  for (int i = 0; i < 5; ++i) expect_same(journal.records()[static_cast<std::size_t>(i)], record_number(i));
  EXPECT_EQ(journal.records()[5].values[0], 5e-324);
  EXPECT_TRUE(std::isinf(journal.records()[5].values[1]));
  EXPECT_TRUE(std::isnan(journal.records()[5].values[2]));
  EXPECT_EQ(journal.records()[6].note, "no values");
}

TEST(Journal, ATearAtAnyByteLosesOnlyTheLastRecord) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "j";
  std::size_t before_last = 0;
  {
    Journal journal(path, "task");
    for (int i = 0; i < 3; ++i) {
      before_last = bytes_of(path).size();
      journal.append(record_number(i));
    }
  }
  const std::string whole = bytes_of(path);
  for (std::size_t length = before_last; length < whole.size(); ++length) {
    std::ofstream(path, std::ios::binary | std::ios::trunc).write(whole.data(), std::streamsize(length));
    {
      Journal journal(path, "task");
      ASSERT_EQ(journal.records().size(), 2U) << length;
      journal.append(record_number(2));
    }
    EXPECT_EQ(bytes_of(path), whole);
  }
}

TEST(Journal, ATornHeaderStartsAnew) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "j";
  { Journal journal(path, "task"); }
  const std::string header = bytes_of(path);
  for (std::size_t length = 0; length < header.size(); ++length) {
    std::ofstream(path, std::ios::binary | std::ios::trunc).write(header.data(), std::streamsize(length));
    { Journal journal(path, "task"); }
    EXPECT_EQ(bytes_of(path), header);
  }
}

TEST(Journal, SurvivesKill) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "j";
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    Journal journal(path, "task");
    for (int i = 0;; ++i) {
      journal.append(record_number(i));
      if (i == 100 && ::write(ready[1], "x", 1) != 1) ::_exit(1);
    }
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(ready[0]);
  ::close(ready[1]);
  const Journal journal(path, "task");
  ASSERT_GE(journal.records().size(), 101U);
  for (std::size_t i = 0; i < journal.records().size(); ++i) {
    expect_same(journal.records()[i], record_number(static_cast<int>(i)));
  }
}

TEST(Journal, RefusesAnotherTaskAnotherProcessAndOtherFiles) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "j";
  const auto refusal = [&](const std::filesystem::path& file, const std::string& task) -> std::string {
    try {
      const Journal journal(file, task);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  {
    Journal journal(path, "task");
    journal.append(record_number(1));
    EXPECT_NE(refusal(path, "task").find("another process"), std::string::npos);
  }
  EXPECT_NE(refusal(path, "other").find("another task"), std::string::npos);
  EXPECT_EQ(refusal(path, "task"), "accepted");
  std::ofstream(folder.path() / "text") << "some other file that is long enough\n";
  EXPECT_NE(refusal(folder.path() / "text", "task").find("not a journal"), std::string::npos);
  EXPECT_NE(refusal(folder.path() / "no" / "j", "task").find("cannot be written"), std::string::npos);
}

TEST(Journal, RemoveLeavesNothing) {
  const TemporaryFolder folder;
  const auto path = Journal::path_for(folder.path() / "sweep.h5");
  Journal journal(path, fingerprint("task"));
  journal.append(record_number(1));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"sweep.h5.journal"}));
  journal.remove();
  EXPECT_TRUE(folder.names().empty());
}

TEST(Journal, FingerprintIsFnv1a) {
  // Published test values of the 64-bit FNV-1a hash (Fowler, Noll, Vo).
  EXPECT_EQ(fingerprint(""), "cbf29ce484222325");
  EXPECT_EQ(fingerprint("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(fingerprint("foobar"), "85944171f73967e8");
}

}  // namespace
