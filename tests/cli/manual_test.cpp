// Manual pages and shell completion are written from the same definitions as the help.

#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace {

using namespace slipmode::tests;
using testing::ElementsAre;
using testing::HasSubstr;
using Words = std::vector<std::string>;

Words lines_of(const std::string& text) {
  std::istringstream in(text);
  Words lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// First words of the entries below a heading of a help text.
Words entries(const std::string& help, const std::string& heading) {
  Words found;
  bool inside = false;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with(' ')) inside = line == heading + ":";
    if (inside && line.starts_with("  ") && line[2] != ' ') found.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return found;
}

class Manual : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(slipmode_in(folder, {"manual", "share"}).exit_code, 0); }

  std::string help(Words verb) const {
    verb.emplace_back("--help");
    return slipmode_in(folder, verb).out;
  }
  /// Every verb's words, the program itself, without any, first.
  std::vector<Words> verbs() const {
    std::vector<Words> all = {{}};
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const std::string& name : entries(help(all[i]), "Subcommands")) {
        all.push_back(all[i]);
        all.back().push_back(name);
      }
    }
    return all;
  }
  std::string written(const std::string& name) const { return bytes_of(folder.path() / "share" / name); }
  /// What bash offers for the last of the words, after "slipmode".
  Words completed(const Words& words) const {
    std::string command = ". share/bash-completion/completions/slipmode; COMP_WORDS=(slipmode";
    for (const std::string& word : words) command += " '" + word + "'";
    command +=
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _slipmode slipmode \"${COMP_WORDS[COMP_CWORD]}\" "
        "\"${COMP_WORDS[COMP_CWORD-1]}\"; printf '%s\\n' \"${COMPREPLY[@]}\" > offered";
    write_file(folder.path() / "script", command);
    const std::string call = "cd '" + folder.path().string() + "' && bash -u script";
    EXPECT_EQ(std::system(call.c_str()), 0);
    return lines_of(bytes_of(folder.path() / "offered"));
  }

  TemporaryFolder folder;
};

TEST_F(Manual, HasAPageForEveryVerbWithEveryOption) {
  EXPECT_GT(verbs().size(), 20U);
  for (const Words& verb : verbs()) {
    std::string name = "slipmode";
    for (const std::string& word : verb) name += "-" + word;
    std::string page = written("man/man1/" + name + ".1");
    std::erase(page, '\\');  // of \-
    const std::string text = help(verb);
    EXPECT_THAT(entries(text, "Options"), testing::Contains("-h,--help")) << name;
    for (const char* heading : {"Subcommands", "Positionals", "Options"}) {
      for (const std::string& entry : entries(text, heading)) EXPECT_THAT(page, HasSubstr("\n.B " + entry)) << name;
    }
    EXPECT_THAT(page, HasSubstr(".SH EXAMPLES\n")) << name;
  }
}

TEST_F(Manual, CompletionOfEachShellKnowsEveryVerbAndOption) {
  const std::string bash = written("bash-completion/completions/slipmode");
  const std::string zsh = written("zsh/vendor-completions/_slipmode");
  const std::string fish = written("fish/vendor_completions.d/slipmode.fish");
  for (const Words& verb : verbs()) {
    if (!verb.empty()) {
      EXPECT_THAT(bash, testing::ContainsRegex("[( ]" + verb.back() + "[ )]"));
      EXPECT_THAT(zsh, HasSubstr(verb.back() + ":"));
      EXPECT_THAT(fish, HasSubstr("-a " + verb.back() + " "));
    }
    for (const std::string& names : entries(help(verb), "Options")) {
      const std::string name = names.substr(names.find("--"));
      EXPECT_THAT(bash, HasSubstr(name));
      EXPECT_THAT(zsh, HasSubstr(name + ":"));
      EXPECT_THAT(fish, HasSubstr("-l " + name.substr(2) + " "));
    }
  }
}

TEST_F(Manual, BashCompletesVerbsOptionsAndChoices) {
  EXPECT_THAT(completed({"swe"}), ElementsAre("sweep"));
  EXPECT_THAT(completed({"orbit", "sp"}), ElementsAre("spectrum"));
  EXPECT_THAT(completed({"orbit", "find", "--by", ""}), ElementsAre("shooting", "balance", "mixed"));
  EXPECT_THAT(completed({"orbit", "find", "--by", "b"}), ElementsAre("balance"));
  EXPECT_THAT(completed({"--json", "sweep", "scene.toml", "--ov"}), ElementsAre("--over"));
  EXPECT_THAT(completed({"modes", "--ov"}), ElementsAre("")) << "an option of other verbs";
  EXPECT_THAT(completed({"sweep", ""}), ElementsAre("")) << "names of files are left to the shell";
}

TEST_F(Manual, HelpFitsIntoEightyColumns) {
  for (const Words& verb : verbs()) {
    for (const std::string& line : lines_of(help(verb))) {
      const bool is_example = line.starts_with("  slipmode ");
      const auto width = std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; });
      EXPECT_TRUE(is_example || width <= 80) << line;
    }
  }
}

TEST(ManualFolder, MustBeWritable) {
  const TemporaryFolder folder;
  write_file(folder.path() / "file", "");
  const Outcome outcome = slipmode_in(folder, {"manual", "file"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("file"));
}

}  // namespace
