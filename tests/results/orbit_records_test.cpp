// Stored periodic orbits come back to the last bit; damaged ones are refused.

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/scene/scene.hpp>
#include "scene/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <filesystem>

namespace {

using namespace slipmode;
using orbits::PeriodicOrbit;
using tests::TemporaryFolder;

StoreReader stored(const TemporaryFolder& folder, const PeriodicOrbit& orbit) {
  StoreWriter out(folder.path() / "orbit.h5", FileKind::kOrbit);
  save(out, kOrbitGroup, orbit);
  out.commit();
  return StoreReader(folder.path() / "orbit.h5");
}

void expect_same(const PeriodicOrbit& a, const PeriodicOrbit& b) {
  EXPECT_EQ(a.start.time, b.start.time);
  EXPECT_EQ(a.start.q, b.start.q);
  EXPECT_EQ(a.start.v, b.start.v);
  EXPECT_EQ(a.start.modes, b.start.modes);
  EXPECT_EQ(a.period, b.period);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.repeats, b.repeats);
  EXPECT_EQ(a.monodromy, b.monodromy);
  EXPECT_EQ(a.multipliers, b.multipliers);
  EXPECT_EQ(a.half_multipliers, b.half_multipliers);
  EXPECT_EQ(a.trivial_multipliers, b.trivial_multipliers);
  EXPECT_EQ(a.leading_modulus, b.leading_modulus);
  EXPECT_EQ(a.stability, b.stability);
  EXPECT_EQ(a.zero_multipliers, b.zero_multipliers);
  EXPECT_EQ(a.superstable, b.superstable);
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t k = 0; k < a.events.size(); ++k) {
    EXPECT_EQ(a.events[k].time, b.events[k].time);
    EXPECT_EQ(a.events[k].kind, b.events[k].kind);
    EXPECT_EQ(a.events[k].after, b.events[k].after);
  }
  ASSERT_EQ(a.regimes.size(), b.regimes.size());
  for (std::size_t k = 0; k < a.regimes.size(); ++k) {
    EXPECT_EQ(a.regimes[k].time, b.regimes[k].time);
    EXPECT_EQ(a.regimes[k].modes, b.regimes[k].modes);
  }
  EXPECT_EQ(a.word, b.word);
  EXPECT_EQ(a.crossings, b.crossings);
  EXPECT_EQ(a.symmetric, b.symmetric);
  EXPECT_EQ(a.asymmetry, b.asymmetry);
  EXPECT_EQ(a.grazing, b.grazing);
  EXPECT_EQ(a.has_grazing, b.has_grazing);
  EXPECT_EQ(a.family, b.family);
  EXPECT_EQ(a.family_note, b.family_note);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.residuals, b.residuals);
}

PeriodicOrbit orbit_of(const char* dataset, const std::vector<std::string>& overrides = {}) {
  const auto path = std::filesystem::path(SLIPMODE_SOURCE_DIR) / "datasets" / dataset / "scene.toml";
  const scene::Scene scene = scene::load_scene(path, overrides);
  const dynamics::HybridSystem system = build_system(scene);
  const dynamics::State start = initial_state(scene, system);
  return orbits::find_orbit(system, orbits::settle_guess(system, start, 300.0));
}

TEST(OrbitRecords, OrbitsReadBackToTheSameBits) {
  const TemporaryFolder folder;
  for (const PeriodicOrbit& orbit : {orbit_of("backlash_sdof"),                            // one of a family in the gap
                                     orbit_of("backlash_sdof", {"drive.omega=0.4"}),       // symmetric, eight crossings
                                     orbit_of("clearance_3mass", {"drive.omega=0.6"})}) {  // two contacts
    expect_same(orbit, load_orbit(stored(folder, orbit)));
  }
}

TEST(OrbitRecords, OneOfWrongSizeIsRefused) {
  const TemporaryFolder folder;
  PeriodicOrbit orbit = orbit_of("backlash_sdof");
  orbit.monodromy = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_THAT([&] { (void)load_orbit(stored(folder, orbit)); },
              testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("orbit/monodromy")));
  orbit.monodromy = Eigen::MatrixXd::Constant(2, 2, std::nan(""));
  EXPECT_THAT([&] { (void)load_orbit(stored(folder, orbit)); },
              testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("NaN")));
}

}  // namespace
