#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include "random_model.hpp"

#include <gtest/gtest.h>

namespace slipmode::rom {
namespace {

using dynamics::ContactMode;
using dynamics::HybridSystem;
using dynamics::State;
using tests::normal_matrix;
using tests::random_basis;
using tests::random_system;

TEST(States, RestrictingALiftedStateGivesItBack) {
  Random random(71);
  const HybridSystem full = random_system(random, 9);
  const pod::Basis basis = random_basis(random, 9, 4);
  const State reduced{1.5, normal_matrix(random, 4, 1), normal_matrix(random, 4, 1), {ContactMode::kSlipPositive}};
  const State back = restrict_state(full.structure(), basis, lift(basis, reduced));
  EXPECT_LT((back.q - reduced.q).norm(), 1e-13);
  EXPECT_LT((back.v - reduced.v).norm(), 1e-13);
  EXPECT_EQ(back.time, 1.5);
  EXPECT_EQ(back.modes, reduced.modes);
}

TEST(States, LiftAfterRestrictIsTheMassOrthogonalProjector) {
  Random random(72);
  const HybridSystem full = random_system(random, 9);
  const pod::Basis basis = random_basis(random, 9, 4);
  const State state{0.0, normal_matrix(random, 9, 1), normal_matrix(random, 9, 1), {ContactMode::kStick}};
  const State once = lift(basis, restrict_state(full.structure(), basis, state));
  const State twice = lift(basis, restrict_state(full.structure(), basis, once));
  EXPECT_LT((twice.q - once.q).norm() + (twice.v - once.v).norm(), 1e-12);
  const Eigen::MatrixXd test = basis.vectors.transpose() * fem::to_dense(full.structure().M());
  EXPECT_LT((test * (state.q - once.q)).norm(), 1e-11);
  EXPECT_LT((test * (state.v - once.v)).norm(), 1e-11);
}

TEST(States, ContactVelocityAndDisplacementSurviveLifting) {
  Random random(73);
  const HybridSystem full = random_system(random, 6);
  const pod::Basis basis = random_basis(random, 6, 3);
  const auto& contact = full.contacts()[0];
  const HybridSystem model = reduce(full, basis);
  const auto& seen = model.contacts()[0];
  const State reduced{0.0, normal_matrix(random, 3, 1), normal_matrix(random, 3, 1)};
  const State lifted = lift(basis, reduced);
  EXPECT_NEAR(contact.direction.dot(lifted.q) + contact.offset, seen.direction.dot(reduced.q) + seen.offset, 1e-13);
  EXPECT_NEAR(contact.direction.dot(lifted.v), seen.direction.dot(reduced.v), 1e-13);
}

TEST(States, ModesAreDroppedWhenTheVelocityLeavesTheBasis) {
  Random random(74);
  const HybridSystem full = random_system(random, 5);
  const State state{0.0, normal_matrix(random, 5, 1), normal_matrix(random, 5, 1), {ContactMode::kStick}};
  EXPECT_TRUE(restrict_state(full.structure(), random_basis(random, 5, 2), state).modes.empty());
  EXPECT_EQ(restrict_state(full.structure(), random_basis(random, 5, 5), state).modes, state.modes);
}

TEST(States, RefuseSizesThatDoNotFit) {
  Random random(75);
  const HybridSystem full = random_system(random, 5);
  const pod::Basis basis = random_basis(random, 5, 2);
  const State five{0.0, Eigen::VectorXd::Zero(5), Eigen::VectorXd::Zero(5)};
  EXPECT_THROW((void)lift(basis, five), InvalidInput);
  EXPECT_THROW((void)restrict_state(full.structure(), basis, {0.0, five.q, Eigen::VectorXd::Zero(2)}), InvalidInput);
  EXPECT_THROW((void)restrict_state(full.structure(), random_basis(random, 6, 2), five), InvalidInput);
}

}  // namespace
}  // namespace slipmode::rom
