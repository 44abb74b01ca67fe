// Ways to a periodic orbit: their errors against certificates of their own, and what there is for which scene.

#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include <slipmode/trade/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace slipmode::trade {
namespace {

using ::testing::HasSubstr;

scene::Scene dataset(const std::string& name, const std::vector<std::string>& changes = {}) {
  return scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/" + name + "/scene.toml", changes);
}

std::vector<std::string> orbit_axes(const scene::Scene& scene) {
  std::vector<std::string> found;
  for (const Axis axis : axes_of(scene))
    if (!orbit_methods(axis, scene).empty()) found.emplace_back(to_string(axis));
  return found;
}

const OrbitRow& row_named(const OrbitStudy& study, const std::string& name) {
  const auto found = std::ranges::find(study.rows, name, &OrbitRow::name);
  if (found == study.rows.end()) throw InvalidInput("no row " + name);
  return *found;
}

TEST(OrbitMethods, AreThoseThatHoldTheScene) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(orbit_axes(dataset("jenkins_chain")), (Words{"harmonics", "samples", "mixed"}));
  EXPECT_EQ(orbit_axes(dataset("play_oscillator")), (Words{"harmonics", "samples"})) << "it has no rest";
  // A static friction peak is nothing that a balance holds.
  EXPECT_EQ(orbit_axes(dataset("jenkins_chain", {"contact.0.mu_s=0.4"})), Words{"mixed"});
  EXPECT_EQ(orbit_axes(dataset("chain10")), Words{}) << "the period on a belt is not known";
  EXPECT_TRUE(orbit_methods(Axis::kFlow, dataset("jenkins_chain")).empty());
  const std::vector<std::string> held = {"contact.0.mu_s=0.55", "contact.0.normal_load.slope=0"};
  EXPECT_EQ(orbit_axes(dataset("beam_12hz", held)), (Words{"harmonics", "samples"})) << "under a shaker";
  EXPECT_EQ(orbit_axes(dataset("beam_12hz")), Words{});
}

TEST(OrbitMethods, ErrorsAreThoseOfTheirCertificates) {
  const scene::Scene scene = dataset("jenkins_chain");
  const dynamics::HybridSystem system = scene::build_system(scene);
  const OrbitStudy study = study_orbits(scene,
                                        {{.axis = Axis::kHarmonics, .harmonics = 9},
                                         {.axis = Axis::kHarmonics, .harmonics = 25},
                                         {.axis = Axis::kSamples, .harmonics = 25, .samples = 64},
                                         {.axis = Axis::kMixed, .harmonics = 9},
                                         {.axis = Axis::kMixed, .harmonics = 9, .near = 1}},
                                        2);
  ASSERT_TRUE(study.reference.failure.empty()) << study.reference.failure;
  EXPECT_EQ(study.reference.error, 0.0);
  EXPECT_EQ(study.word, "++ +0 +- 0- -- -0 -+ 0+");
  const auto expected = [&](const auto& own) { return 100.0 * orbits::certify(system, own).relative; };
  const auto expect_error = [&](const std::string& name, double error) {
    const OrbitRow& row = row_named(study, name);
    EXPECT_NEAR(row.error, error, 1e-3 * error) << name << row.failure;
    EXPECT_TRUE(row.other.empty());
    EXPECT_GT(row.cpu, 0.0);
    EXPECT_LE(row.cpu_low, row.cpu);
    EXPECT_GE(row.cpu_high, row.cpu);
  };
  expect_error("balance, 9 harmonics", expected(orbits::balance(system, {.harmonics = 9})));
  expect_error("balance, 25 harmonics", expected(orbits::balance(system, {.harmonics = 25})));
  expect_error("balance, 25 harmonics, 64 samples",
               expected(orbits::balance(system, {.harmonics = 25, .samples = 64})));
  expect_error("mixed, 9 harmonics", expected(orbits::mixed_orbit(system, {.harmonics = 9})));
  expect_error("mixed, 9 harmonics, near 1", expected(orbits::mixed_orbit(system, {.harmonics = 9, .reach = 1})));
  EXPECT_EQ(row_named(study, "mixed, 9 harmonics, near 1").options, "--by mixed --harmonics 9 --near 1");
  EXPECT_EQ(row_named(study, "balance, 25 harmonics, 64 samples").options, "--by balance --harmonics 25 --samples 64");
  EXPECT_THROW((void)study_orbits(scene, {}, 0), InvalidInput);
}

TEST(OrbitMethods, OfAFamilyEachIsMeasuredFromTheOrbitBehindIt) {
  // Nothing slides: a linear system of one harmonic, at any mean that the contact springs hold.
  const OrbitStudy study =
      study_orbits(dataset("jenkins_chain", {"drive.amplitude=0.05"}), {{.axis = Axis::kHarmonics, .harmonics = 3}}, 1);
  EXPECT_EQ(study.word, "00");
  EXPECT_LT(study.rows.front().error, 1e-9);
  EXPECT_TRUE(study.rows.front().other.empty());
}

TEST(OrbitMethods, WhatIsNotFoundIsSaid) {
  // One-sided stiff stop well below resonance: no orbit lies behind five harmonics (SaysThatNoOrbitLiesBehind).
  const scene::Scene scene = dataset("backlash_sdof", {"drive.omega=0.4"});
  const OrbitStudy study = study_orbits(scene, {{.axis = Axis::kHarmonics, .harmonics = 5}}, 1);
  EXPECT_FALSE(study.rows.front().failure.empty());
  EXPECT_TRUE(std::isnan(study.rows.front().error));
}

TEST(OrbitMethods, TheFastestWithinTheLimitIsRecommended) {
  OrbitStudy study{.reference = {.name = "shooting", .options = "", .error = 0.0, .cpu = 1.0}, .word = "g", .rows = {}};
  study.rows = {{.name = "a", .options = "--by a", .error = 0.5, .cpu = 0.1},
                {.name = "b", .options = "--by b", .error = 0.9, .cpu = 0.05},
                {.name = "c", .options = "--by c", .error = 0.1, .cpu = 0.01, .other = "g l"},
                {.name = "d", .options = "--by d", .error = kNone, .cpu = 0.001, .failure = "none"}};
  EXPECT_THAT(recommendation(study, 1.0), HasSubstr("use --by b (0.9 %): 20 times faster than shooting"));
  EXPECT_THAT(recommendation(study, 0.6), HasSubstr("use --by a"));
  EXPECT_THAT(recommendation(study, 0.2), HasSubstr("shooting: exact"));
  study.rows[0].cpu = 2.0;
  EXPECT_THAT(recommendation(study, 0.6), HasSubstr("shooting: exact")) << "slower than what is exact";
}

}  // namespace
}  // namespace slipmode::trade
