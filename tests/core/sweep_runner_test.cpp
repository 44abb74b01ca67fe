// A sweep that leaves values to other processes: shares that are cut where values do not depend on each other.

#include <slipmode/core/sweep_runner.hpp>

#include <gtest/gtest.h>
#include <map>

namespace slipmode {
namespace {

constexpr std::size_t kValues = 11, kSegments = 4;

/// x ← x/2 + value, the whole sweep or the pieces of one of `shares` processes.
struct Swept {
  std::vector<SweptValue<double>> points;
  std::size_t progress = 0;           ///< the total told
  std::map<std::size_t, int> pieces;  ///< by value, of those asked about
};

Swept sweep(SweepMode mode, std::size_t share, std::size_t shares) {
  Swept out;
  std::vector<double> values;
  for (std::size_t i = 0; i < kValues; ++i) values.push_back(1.0 + static_cast<double>(i));
  SinkOf<double> sink;
  sink.first_piece = 100;
  sink.leave = [&](std::size_t piece, std::size_t index, int, double) {
    out.pieces[index] = static_cast<int>(piece);
    return piece % shares != share;
  };
  const auto progress = [&](std::size_t, std::size_t total) { out.progress = total; };
  SweepRunner<double, double> runner(
      {.settle = [&](std::size_t i, int, const double& start) { return 0.5 * start + values[i]; },
       .carry = [](const double& end) { return end; }},
      values, 0.0, mode, kSegments, {.threads = 2, .progress = progress}, sink);
  const SweepOf<double> found = runner.run_alone();
  EXPECT_FALSE(found.interrupted);
  out.points = found.points;
  return out;
}

TEST(SweepRunner, SharesGiveTogetherWhatOneProcessGives) {
  for (const SweepMode mode : {SweepMode::kIndependent, SweepMode::kFollow}) {
    const Swept whole = sweep(mode, 0, 1);
    ASSERT_EQ(whole.points.size(), kValues);
    std::map<std::size_t, double> joined;
    for (const std::size_t share : {0, 1, 2}) {
      const Swept part = sweep(mode, share, 3);
      EXPECT_EQ(part.progress, part.points.size()) << "of its share";
      for (const auto& point : part.points) EXPECT_TRUE(joined.emplace(point.index, point.settled).second);
    }
    ASSERT_EQ(joined.size(), kValues);
    for (const auto& point : whole.points) EXPECT_EQ(joined[point.index], point.settled);
  }
}

// Chains of 11 values among 4: floor(s 11/4) = 0, 2, 5, 8 begin one.
TEST(SweepRunner, AChainIsOnePiece) {
  const std::vector<int> chains = {0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};
  const Swept followed = sweep(SweepMode::kFollow, 0, 1), apart = sweep(SweepMode::kIndependent, 0, 1);
  for (std::size_t i = 0; i < kValues; ++i) {
    EXPECT_EQ(followed.pieces.at(i), 100 + chains[i]);
    EXPECT_EQ(apart.pieces.at(i), 100 + static_cast<int>(i));
  }
  EXPECT_EQ(sweep_pieces(kValues, SweepMode::kFollow, kSegments), 4U);
  EXPECT_EQ(sweep_pieces(kValues, SweepMode::kIndependent, kSegments), kValues);
}

}  // namespace
}  // namespace slipmode
