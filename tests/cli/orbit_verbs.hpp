#pragma once

#include "cli/slipmode_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace slipmode::tests {

inline const std::string kSdof = SLIPMODE_SOURCE_DIR "/datasets/backlash_sdof/scene.toml";

/// slipmode orbit in a folder of its own.
class OrbitVerbs : public testing::Test {
 protected:
  Outcome call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "orbit");
    return slipmode_in(folder, arguments);
  }
  nlohmann::json json_of(std::vector<std::string> arguments, int exit_code = 0) const {
    arguments.emplace_back("--json");
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    return outcome.json();
  }
  /// The call must be refused as bad input, naming these.
  void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& said) const {
    const Outcome outcome = call(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& part : said) EXPECT_THAT(outcome.err, testing::HasSubstr(part));
  }

  TemporaryFolder folder;
};

}  // namespace slipmode::tests
