// What is shown on a terminal of few columns that knows no control characters.

#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <sstream>

namespace {

using namespace slipmode::tests;

/// All that the executable shows on a terminal of so many columns.
std::string shown_on_terminal(const TemporaryFolder& folder, std::vector<std::string> arguments,
                              unsigned short columns) {
  arguments.insert(arguments.begin(), executable());
  std::vector<char*> argv;
  for (std::string& word : arguments) argv.push_back(word.data());
  argv.push_back(nullptr);
  const winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    if (chdir(folder.path().c_str()) == 0) execv(argv[0], argv.data());
    _exit(1);
  }
  EXPECT_GT(child, 0);
  std::string shown;
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = read(terminal, buffer.data(), buffer.size())) > 0;)
    shown.append(buffer.data(), static_cast<std::size_t>(got));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << shown;
  return shown;
}

/// Lines, and what carriage returns part: a row that is written again.
std::vector<std::string> rows_of(std::string text) {
  std::ranges::replace(text, '\r', '\n');
  std::istringstream in(text);
  std::vector<std::string> rows;
  for (std::string row; std::getline(in, row);) rows.push_back(row);
  return rows;
}

auto width(const std::string& row) {
  return std::ranges::count_if(row, [](char c) { return (c & 0xC0) != 0x80; });
}

/// Rules below the headers of tables.
std::vector<std::string> rules(const std::string& text) {
  std::vector<std::string> found = rows_of(text);
  std::erase_if(found, [](const std::string& row) {
    return !row.starts_with("  -") || row.find_first_not_of('-', 2) != std::string::npos;
  });
  return found;
}

std::set<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::set<std::string> found;
  for (std::string word; in >> word;) {
    word.erase(0, word.find_first_not_of('-'));  // titles of groups are lengthened by dashes
    word.erase(word.find_last_not_of('-') + 1);
    found.insert(word);
  }
  return found;
}

class Terminal : public testing::TestWithParam<unsigned short> {};

TEST_P(Terminal, RowsFitAndNothingOfATableIsLost) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  const std::string shown = shown_on_terminal(folder, {"run", "free.toml", "-o", "out"}, GetParam());
  EXPECT_EQ(shown.find('\x1b'), std::string::npos) << "no control characters, so no colours either";
  for (const std::string& row : rows_of(shown)) {
    const bool is_indented_prose = row.starts_with("  ") && row.find("  ", 2) == std::string::npos;
    EXPECT_TRUE(is_indented_prose || width(row) <= GetParam()) << row;
  }
  const std::string whole = bytes_of(folder.path() / "out/summary.txt");
  const auto widest = std::ranges::max(rules(whole), {}, &std::string::size).size();
  ASSERT_GT(widest, 80U) << "a table has to be folded";
  EXPECT_GT(rules(shown).size(), rules(whole).size());
  EXPECT_THAT(words(shown), testing::IsSupersetOf(words(whole)));
}

INSTANTIATE_TEST_SUITE_P(Columns, Terminal, testing::Values(60, 80));

TEST(TerminalOutput, ToAFileIsNotFolded) {
  const TemporaryFolder folder;
  write_file(folder.path() / "free.toml", kFreeEnds);
  const Outcome outcome = slipmode_in(folder, {"run", "free.toml", "-o", "out"});
  EXPECT_TRUE(outcome.out.starts_with(bytes_of(folder.path() / "out/summary.txt")));
}

}  // namespace
