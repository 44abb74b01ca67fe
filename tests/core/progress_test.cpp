#include <slipmode/core/progress.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace slipmode {
namespace {

TEST(Progress, TimeLeftIsTimeSoFarTimesItemsLeftOverItemsDone) {
  // 100 of 500 items in 20 s: 80 s are left.
  EXPECT_EQ(progress_text("sweep", 100, 500, 20.0), "sweep  100/500   20 %  left 1:20");
  // 1 of 1000 in 10 s: 9990 s = 2 h 46 min 30 s.
  EXPECT_EQ(progress_text("sweep", 1, 1000, 10.0), "sweep  1/1000    0 %  left 2:46:30");
}

TEST(Progress, SaysWhatItTookAtTheEndAndNothingOfTimeAtTheStart) {
  EXPECT_EQ(progress_text("runs", 8, 8, 61.2), "runs  8/8  100 %  took 1:02");
  EXPECT_EQ(progress_text("runs", 0, 8, 1.0), "runs  0/8    0 %");
}

TEST(Progress, IsSilentWhenQuietOrNotOnATerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressLine quiet("runs", ProgressMode::kQuiet);
    quiet.update(1, 2);
    ProgressLine automatic("runs");  // captured standard error is a file
    automatic.update(2, 2);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, RewritesOneLineAndSparesTheTerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressLine line("runs", ProgressMode::kAlways);
    for (std::size_t i = 1; i <= 1000; ++i) line.update(i, 1000);
  }
  const std::string text = testing::internal::GetCapturedStderr();
  const auto updates = std::count(text.begin(), text.end(), '\r');
  EXPECT_GE(updates, 2);   // the first and the last
  EXPECT_LE(updates, 20);  // a thousand calls take far less than two seconds
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_NE(text.find("1000/1000"), std::string::npos);
}

}  // namespace
}  // namespace slipmode
