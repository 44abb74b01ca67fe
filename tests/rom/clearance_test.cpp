// Reduced models of structures with clearances and forces.
#include <slipmode/rom/reduce.hpp>

#include <slipmode/dynamics/simulate.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "random_model.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using dynamics::State;

pod::Basis random_basis(Eigen::Index n, Eigen::Index L) {
  Random random(7);
  return tests::random_basis(random, n, L);
}

TEST(ReduceClearance, AllVectorsKeptIsTheFullModelInOtherCoordinates) {
  const HybridSystem full = fixtures::backlash_train(0.9);
  pod::Basis basis = random_basis(4, 4);
  basis.mean.resize(0);
  const HybridSystem reduced = reduce(full, basis);
  const Eigen::MatrixXd inverse = basis.vectors.inverse();
  State start = full.rest();
  start.q << 0.3, -0.2, 0.5, 0.4;
  const State reduced_start{0.0, inverse * start.q, inverse * start.v, {}, {}};
  const dynamics::TangentResult a = dynamics::tangent_flow(full, start, 40.0);
  const dynamics::TangentResult b = dynamics::tangent_flow(reduced, reduced_start, 40.0);
  ASSERT_GE(a.events.size(), 6U);
  ASSERT_EQ(a.events.size(), b.events.size());
  for (std::size_t k = 0; k < a.events.size(); ++k) EXPECT_NEAR(a.events[k].time, b.events[k].time, 1e-10);
  EXPECT_LT((a.end.q - basis.vectors * b.end.q).norm(), 1e-10);
  // Fundamental matrices are similar.
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(8, 8);
  T.topLeftCorner(4, 4) = T.bottomRightCorner(4, 4) = basis.vectors;
  EXPECT_LT((a.monodromy - T * b.monodromy * T.inverse()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ReduceClearance, ForcesAreProjectedLikeLoads) {
  const HybridSystem full = fixtures::random_clearances(11);
  const Eigen::Index n = full.size();
  ASSERT_GE(n, 2);
  pod::Basis basis = random_basis(n, n - 1);
  basis.mean.resize(0);
  const HybridSystem reduced = reduce(full, basis);
  EXPECT_EQ(reduced.force_directions(), basis.vectors.transpose() * full.force_directions());
}

}  // namespace
}  // namespace slipmode::rom
