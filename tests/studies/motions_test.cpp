#include <slipmode/rom/reduce.hpp>
#include <slipmode/studies/motions.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using namespace slipmode;

scene::Scene four_masses() {
  return scene::parse_scene(R"(
title = "four"
units = "dimensionless"
[structure]
kind = "chain"
masses = 4
damping = 0.05
[[contact]]
at = 4
law = "stribeck"
mu_s = 0.4
mu_k = 0.2
alpha = 2.0
normal_load = 3.0
[drive]
kind = "belt"
speed = 0.5
[time]
duration = 400.0
[initial]
at = "static"
[validation]
transient = 200.0
block = 400.0
limit = 4000.0
sweep_limit = 2000.0
)");
}

studies::MotionsRequest at_one_speed(Eigen::Index n) {
  return {.values = {0.5}, .recorded = {true}, .modes = {n}, .readings = Eigen::MatrixXd::Identity(n, n)};
}

pod::NamedBasis all_modes(const scene::Scene& scene) {
  const auto system = scene::build_system(scene);
  pod::NamedBasis basis;
  basis.name = "LNM";
  basis.basis = rom::lnm_basis(system.structure(), system.size());
  return basis;
}

// Projection on all natural modes is a change of coordinates: the settled periodic motion is the same, from the same
// slip.
TEST(Motions, OfAReducedModelWithAllModesAreThoseOfTheFullOne) {
  const scene::Scene scene = four_masses();
  const auto found = studies::motions(scene, all_modes(scene), at_one_speed(4), {});
  ASSERT_EQ(found.size(), 2U);
  const studies::Motion &full = found[0].motions[0].value(), &reduced = found[1].motions[0].value();
  ASSERT_THAT(found[0].points[0].said, testing::StartsWith("period"));
  ASSERT_EQ(full.q.cols(), 1500);
  const double size = full.q.maxCoeff() - full.q.minCoeff();
  // Settled to [validation] period_tolerance 1e-5 of the slip states.
  EXPECT_LT((full.q - reduced.q).cwiseAbs().maxCoeff(), 1e-3 * size);
  EXPECT_LT((full.shape - reduced.shape).cwiseAbs().maxCoeff(), 1e-3 * size);
  EXPECT_EQ(full.modes, reduced.modes);
}

// It begins with a slip from stick: there the contact still moves with the belt.
TEST(Motions, BeginWithASlip) {
  const scene::Scene scene = four_masses();
  const auto found = studies::motions(scene, all_modes(scene), at_one_speed(4), {});
  EXPECT_NEAR(found[0].motions[0]->v(0, 0), 0.5, 1e-9);
}

TEST(Motions, AreTheSameForAnyNumberOfThreads) {
  const scene::Scene scene = four_masses();
  const auto one = studies::motions(scene, all_modes(scene), at_one_speed(4), {.threads = 1});
  const auto two = studies::motions(scene, all_modes(scene), at_one_speed(4), {.threads = 2});
  for (std::size_t m = 0; m < one.size(); ++m) EXPECT_EQ(one[m].motions[0]->q, two[m].motions[0]->q);
}

}  // namespace
