#include <slipmode/dynamics/simulate.hpp>

#include <slipmode/core/random.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "random_model.hpp"

#include <gtest/gtest.h>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using dynamics::State;
using dynamics::Trajectory;

/// S4 chapter 3 with the identified numbers of datasets/chain10.
HybridSystem chain10(friction::Law law) {
  return {fem::chain({.masses = 10, .damping = 0.006}),
          {{Eigen::VectorXd::Unit(10, 9), std::move(law), 3.0}},
          friction::Belt::constant(0.2)};
}

pod::Basis pom_basis_of(const HybridSystem& system, double duration, Eigen::Index modes) {
  const Trajectory run = simulate(system, system.rest(), {.duration = duration, .sample = 0.5});
  return pod::pod({.snapshots = run.q}, {.choice = {.modes = modes}}).basis;
}

/// Several slips long from a start near rest, where the belt first winds the chain up for about 60 units; short enough
/// that rounding (growing e-fold in 75 units) stays far below the bounds.
constexpr double kHorizon = 200.0;

/// Full and reduced with all modes, from one start.
void expect_same_flow(const HybridSystem& full, const pod::Basis& basis, const State& start, double duration) {
  const dynamics::SimulateOptions options{.duration = duration, .sample = 1.0, .flow = {.tolerance = 1e-12}};
  const Trajectory a = simulate(full, start, options);
  const Trajectory b = simulate(reduce(full, basis), restrict_state(full.structure(), basis, start), options);
  ASSERT_GT(a.events.size(), 4u);
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t i = 0; i < a.events.size(); ++i) {
    EXPECT_EQ(a.events[i].kind, b.events[i].kind);
    EXPECT_NEAR(a.events[i].time, b.events[i].time, 1e-8);
    EXPECT_NEAR(a.events[i].displacement, b.events[i].displacement, 1e-8);  // the offset wᵀq̄ is in it
  }
  const Eigen::MatrixXd lifted = (basis.vectors * b.q).colwise() + basis.mean;
  EXPECT_LT((lifted - a.q).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((b.lambda - a.lambda).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(ReducedFlow, WithAllPomsIsTheFullFlow) {
  Random random(81);
  for (const friction::Law& law :
       {friction::Law(friction::Coulomb{0.4, 0.2}), friction::Law(friction::Stribeck{0.4, 0.2, 8.0})}) {
    const HybridSystem full = chain10(law);
    const pod::Basis basis = pom_basis_of(full, 2000.0, 10);
    EXPECT_GT(basis.mean.norm(), 1.0);  // the affine part is not idle
    const State start{0.0, 0.3 * tests::normal_matrix(random, 10, 1), 0.1 * tests::normal_matrix(random, 10, 1)};
    expect_same_flow(full, basis, start, kHorizon);
  }
}

TEST(ReducedFlow, WithAllVectorsOfAnyBasisIsTheFullFlow) {
  Random random(82);
  for (int trial = 0; trial < 3; ++trial) {
    const HybridSystem full = chain10(friction::Stribeck{0.4, 0.2, 8.0});
    Eigen::MatrixXd vectors = tests::normal_matrix(random, 10, 10);
    vectors += 3.0 * Eigen::MatrixXd::Identity(10, 10);
    const pod::Basis basis = user_basis(vectors, tests::normal_matrix(random, 10, 1));
    const State start{0.0, 0.3 * tests::normal_matrix(random, 10, 1), 0.1 * tests::normal_matrix(random, 10, 1)};
    expect_same_flow(full, basis, start, kHorizon);
  }
}

TEST(ReducedFlow, OnAnInvariantSubspaceIsTheFullFlow) {
  // Five masses between two walls, friction at the middle: symmetric motion stays symmetric, in 3 of 5 dimensions. POD
  // finds those three, and the reduced model must follow the full one exactly.
  const HybridSystem full(fem::chain({.masses = 5, .damping = 0.002, .right_fixed = true}),
                          {{Eigen::VectorXd::Unit(5, 2), friction::Stribeck{0.4, 0.2, 8.0}, 3.0}},
                          friction::Belt::constant(0.2));
  const Trajectory run = simulate(full, full.rest(), {.duration = 500.0, .sample = 0.25});
  const pod::PodResult modes = pod::pod({.snapshots = run.q}, {.rank_tolerance = 1e-10});
  ASSERT_EQ(modes.rank, 3);
  State start = full.rest();
  start.q << 0.5, -0.3, 0.2, -0.3, 0.5;
  expect_same_flow(full, modes.basis, start, kHorizon);
}

TEST(ReducedFlow, MeanOfALongRunIsTheStaticDeflectionUnderTheMeanForce) {
  // Averaging the equation of motion over a bounded run: K q̄ = w λ̄ + O(1/duration).
  const HybridSystem full = chain10(friction::Stribeck{0.4, 0.2, 8.0});
  const Trajectory run = simulate(full, full.rest(), {.duration = 6000.0, .transient = 1000.0, .sample = 0.05});
  const Eigen::VectorXd force = fem::multiply(full.structure().K(), run.q.rowwise().mean());
  EXPECT_NEAR(force[9], run.lambda.mean(), 5e-3);
  EXPECT_LT(force.head(9).cwiseAbs().maxCoeff(), 5e-3);
}

}  // namespace
}  // namespace slipmode::rom
