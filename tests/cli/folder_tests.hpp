#pragma once

#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>
#include <string>

namespace slipmode::tests {

/// Finished values in a journal: its lines but the first one, which names the task, a part's head, and a torn last one.
inline int finished_in(const std::filesystem::path& journal) {
  if (!std::filesystem::exists(journal)) return 0;
  const std::string text = bytes_of(journal);
  const std::size_t head = text.find(" #part ");
  const bool has_head = head != std::string::npos && text.find('\n', head) != std::string::npos;
  return std::max(0, static_cast<int>(std::ranges::count(text, '\n')) - (has_head ? 2 : 1));
}

/// The executable in a folder of its own, and what it leaves there.
class InFolder : public testing::Test {
 protected:
  [[nodiscard]] std::string bytes(const std::string& file) const { return bytes_of(folder.path() / file); }
  /// Finished values in the journal of a result.
  [[nodiscard]] int journalled(const std::string& file) const {
    return finished_in(folder.path() / (file + ".journal"));
  }

  TemporaryFolder folder;
};

/// A folder with two scenes of milliseconds in it.
class OnSmallScenes : public InFolder {
 protected:
  void SetUp() override {
    write_file(folder.path() / "free.toml", kFreeEnds);
    write_file(folder.path() / "two.toml", kTwoContacts);
  }
};

/// Studies of these scenes, said in JSON and without progress.
class QuietStudies : public OnSmallScenes {
 protected:
  [[nodiscard]] Outcome call(const Words& arguments) const {
    return slipmode_in(folder, arguments + Words{"--json", "--quiet"});
  }
  /// Exit code 2 and a message that holds the words.
  void refused(const Words& arguments, const std::string& words) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
};

}  // namespace slipmode::tests
