#include <slipmode/core/parallel.hpp>
#include <slipmode/studies/simulation.hpp>

#include <gtest/gtest.h>
#include <chrono>

namespace slipmode::studies {
namespace {

// Two thirds of chain10's run are a transient, of which nothing is kept; made a hundred times as long it takes 20 s.
TEST(Simulation, EndsAndTellsItsProgressWithinTheTransientToo) {
  const scene::Scene scene = scene::load_scene(std::string(SLIPMODE_SOURCE_DIR) + "/datasets/chain10/scene.toml",
                                               {"time.duration=3000000.0", "time.transient=2000000.0"});
  StopFlag stop = false;
  std::size_t furthest = 0;
  const RunOptions run{.stop = &stop, .progress = [&](const std::string&) {
                         return [&](std::size_t done, std::size_t total) {
                           EXPECT_EQ(total, 1000U);
                           furthest = std::max(furthest, done);
                           if (done > 0) stop = true;
                         };
                       }};
  EXPECT_THROW((void)simulate(Family(scene), run), Interrupted);
  EXPECT_EQ(furthest, 1U);
}

}  // namespace
}  // namespace slipmode::studies
