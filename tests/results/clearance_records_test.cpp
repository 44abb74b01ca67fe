// Stored systems with clearances under forces: every number comes back to the last bit.

#include <slipmode/core/decompositions.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <filesystem>
#include <tuple>

namespace {

using namespace slipmode;
using tests::TemporaryFolder;

dynamics::HybridSystem read_back(const dynamics::HybridSystem& system) {
  const TemporaryFolder folder;
  StoreWriter out(folder.path() / "record.h5", FileKind::kTrajectory);
  save(out, "system", system);
  out.commit();
  return load_system(StoreReader(folder.path() / "record.h5"));
}

auto numbers(const friction::Stop& stop) { return std::tuple(stop.stiffness, stop.damping, stop.gap); }

auto numbers(const friction::ForceHarmonic& own) {
  return std::tuple(own.amplitude, own.phase, own.order, own.direction);
}

void expect_same_stop(const std::optional<friction::Stop>& a, const std::optional<friction::Stop>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) {
    EXPECT_EQ(numbers(*a), numbers(*b));
  }
}

void expect_same_system(const dynamics::HybridSystem& a, const dynamics::HybridSystem& b) {
  EXPECT_EQ(fem::to_dense(a.structure().M()), fem::to_dense(b.structure().M()));
  EXPECT_EQ(fem::to_dense(a.structure().C()), fem::to_dense(b.structure().C()));
  EXPECT_EQ(fem::to_dense(a.structure().K()), fem::to_dense(b.structure().K()));
  EXPECT_EQ(a.structure().has_symmetric_damping(), b.structure().has_symmetric_damping());
  EXPECT_EQ(a.load(), b.load());
  EXPECT_EQ(a.force_directions(), b.force_directions());
  ASSERT_EQ(a.contacts().size(), b.contacts().size());
  for (std::size_t c = 0; c < a.contacts().size(); ++c) {
    EXPECT_EQ(a.contacts()[c].direction, b.contacts()[c].direction);
    EXPECT_EQ(a.contacts()[c].offset, b.contacts()[c].offset);
    const auto& one = std::get<friction::Clearance>(a.contacts()[c].law);
    const auto& other = std::get<friction::Clearance>(b.contacts()[c].law);
    EXPECT_EQ(one.loss, other.loss);
    expect_same_stop(one.left, other.left);
    expect_same_stop(one.right, other.right);
  }
  ASSERT_NE(b.drive().force(), nullptr);
  EXPECT_EQ(a.drive().force()->omega, b.drive().force()->omega);
  ASSERT_EQ(a.drive().force()->harmonics.size(), b.drive().force()->harmonics.size());
  for (std::size_t k = 0; k < a.drive().force()->harmonics.size(); ++k) {
    EXPECT_EQ(numbers(a.drive().force()->harmonics[k]), numbers(b.drive().force()->harmonics[k]));
  }
}

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
