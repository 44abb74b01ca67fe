// Stored systems with clearances under forces: every number comes back to the last bit.

#include <slipmode/core/decompositions.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/scene.hpp>
#include "results/stored_systems.hpp"

#include <gtest/gtest.h>
#include <filesystem>

namespace {

using namespace slipmode;
using tests::expect_same_system;
using tests::read_back;

TEST(ClearanceRecords, ShippedSystemsReadBackToTheSameBits) {
  for (const char* dataset : {"backlash_sdof", "backlash_4mass", "clearance_3mass", "play_oscillator"}) {
    SCOPED_TRACE(dataset);
    const auto path = std::filesystem::path(SLIPMODE_SOURCE_DIR) / "datasets" / dataset / "scene.toml";
    const dynamics::HybridSystem system = scene::build_system(scene::load_scene(path));
    expect_same_system(system, read_back(system));
  }
}

TEST(ClearanceRecords, OneSidedStopsAndHarmonicsReadBackWhenReduced) {
  const friction::Clearance left{friction::Stop{1.0 / 3.0, 0.1, -0.7}, std::nullopt, friction::ContactLoss::kGap};
  const friction::Clearance right{std::nullopt, friction::Stop{4.0, 0.0, 1.0 / 7.0}};
  const friction::Force force{0.1, {{1.0 / 3.0, 0.2, 1, 0}, {2.0, -1.0 / 9.0, 5, 1}}};
  const dynamics::HybridSystem system(fem::masses({.mass = {1.0, 2.0, 3.0}}),
                                      {{.direction = Eigen::Vector3d(-1.0, 1.0, 0.0), .law = left, .offset = 0.3},
                                       {.direction = Eigen::Vector3d(0.0, 0.0, 1.0), .law = right}},
                                      force, Eigen::Vector3d(0.1, 0.0, -1.0 / 3.0),
                                      (Eigen::MatrixXd(3, 2) << 1.0, 0.0, 0.0, 1.0 / 3.0, 0.0, 1.0).finished());
  expect_same_system(system, read_back(system));
  const pod::Basis basis = rom::user_basis(Eigen::MatrixXd{{1.0, 0.0}, {0.5, 1.0}, {1.0, -1.0}});
  expect_same_system(rom::reduce(system, basis), read_back(rom::reduce(system, basis)));
}

}  // namespace
