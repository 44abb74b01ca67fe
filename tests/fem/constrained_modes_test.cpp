#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/modes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>

namespace slipmode::fem {
namespace {

using std::numbers::pi;
using testing::HasSubstr;
using testing::ThrowsMessage;

// 4ᵗʰ-neighbour-free but not diagonal-mass structure: a chain with every mass shared between neighbours.
Structure consistent_chain(int n) {
  const Structure s = chain({.masses = n});
  SparseMatrix M = to_sparse(s.K());
  M *= -1.0 / 6.0;
  for (int i = 0; i < n; ++i) M.coeffRef(i, i) += 1.0;  // 4/6 and 1/6, the masses of linear bar elements
  return {M, Rayleigh{}, s.K()};
}

TEST(ConstrainedModes, HoldingTheLastMassGivesTheFixedFixedChain) {
  for (const int n : {2, 10, 200}) {
    const Modes held = constrained_modes(chain({.masses = n}), Eigen::VectorXd::Unit(n, n - 1));
    ASSERT_EQ(held.omega.size(), n - 1);
    for (int k = 1; k < n; ++k) {
      // closed form for N − 1 unit masses between walls
      EXPECT_NEAR(held.omega(k - 1), 2.0 * std::sin(k * pi / (2 * n)), 1e-13);
    }
    EXPECT_EQ(held.shapes.row(n - 1).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_TRUE((held.shapes.transpose() * held.shapes).isIdentity(1e-12));
  }
}

TEST(ConstrainedModes, HoldingAnInnerMassSplitsTheChain) {
  // 7 unit masses, the 4th held: 3 masses between walls (left), 3 masses hanging on one wall (right)
  const Modes held = constrained_modes(chain({.masses = 7}), 3.0 * Eigen::VectorXd::Unit(7, 3));
  std::vector<double> expected;
  for (int k = 1; k <= 3; ++k) {
    expected.push_back(2.0 * std::sin(k * pi / 8));
    expected.push_back(2.0 * std::sin((2 * k - 1) * pi / 14));
  }
  std::sort(expected.begin(), expected.end());
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(held.omega(k), expected[static_cast<std::size_t>(k)], 1e-14);
}

TEST(ConstrainedModes, FrequenciesInterlaceWithTheFreeOnes) {
  const Structure s = consistent_chain(12);
  Eigen::VectorXd w(12);
  for (int i = 0; i < 12; ++i) w(i) = std::sin(1.7 * i + 0.3);
  const Modes free = natural_modes(s);
  const Modes held = constrained_modes(s, w);
  for (int k = 0; k < 11; ++k) {  // Rayleigh's theorem on one constraint
    EXPECT_LE(free.omega(k), held.omega(k) + 1e-13);
    EXPECT_LE(held.omega(k), free.omega(k + 1) + 1e-13);
  }
}

TEST(ConstrainedModes, ShapesSatisfyTheConstraintAndTheEquations) {
  const Structure s = consistent_chain(30);
  Eigen::MatrixXd W(30, 2);
  for (int i = 0; i < 30; ++i) W.row(i) << std::sin(i + 1.0), std::cos(0.37 * i);
  const Modes held = constrained_modes(s, W);
  ASSERT_EQ(held.omega.size(), 28);
  EXPECT_LT((W.transpose() * held.shapes).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_TRUE((held.shapes.transpose() * multiply(s.M(), held.shapes)).isIdentity(1e-12));
  // what is left of K φ − ω² M φ must be a constraint force: a combination of the columns of W
  const Eigen::MatrixXd rest =
      multiply(s.K(), held.shapes) - multiply(s.M(), held.shapes) * held.omega.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd reaction = W * W.colPivHouseholderQr().solve(rest);
  EXPECT_LT((rest - reaction).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ConstrainedModes, LanczosAgreesWithTheProjectionOnALargeStructure) {
  const int n = 700;
  const Structure s = consistent_chain(n);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, 2);
  W(n - 1, 0) = 1.0;
  W(n - 2, 0) = -1.0;
  for (int i = 0; i < n; ++i) W(i, 1) = std::sin(0.01 * i);
  const Modes lanczos = constrained_modes(s, W, 5);       // large and few: Lanczos
  const Modes projection = constrained_modes(s, W, 200);  // many: Householder null space, dense
  EXPECT_LT((lanczos.omega - projection.omega.head(5)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((lanczos.shapes - projection.shapes.leftCols(5)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((W.transpose() * lanczos.shapes).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ConstrainedModes, WithoutConstraintsTheyAreTheNaturalModes) {
  const Structure s = chain({.masses = 8});
  EXPECT_EQ(constrained_modes(s, Eigen::MatrixXd(8, 0)).omega, natural_modes(s).omega);
}

TEST(ConstrainedModes, ConstraintMagnitudeDoesNotMatter) {
  const Structure s = chain({.masses = 6});
  Eigen::VectorXd w(6);
  w << 1, 2, 0, -1, 0.5, 3;
  const Modes unit = constrained_modes(s, w);
  const Modes tiny = constrained_modes(s, 1e-30 * w);
  EXPECT_LT((unit.omega - tiny.omega).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(ConstrainedModes, RejectsBadInputSayingWhy) {
  const Structure s = chain({.masses = 4});
  const auto fails = [&s](const Eigen::MatrixXd& W, Eigen::Index count, const char* message) {
    EXPECT_THAT([&] { (void)constrained_modes(s, W, count); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(4, 4);
  fails(Eigen::VectorXd::Ones(3), 0, "3 rows, expected 4");
  fails(I, 0, "leave nothing");
  fails(Eigen::VectorXd::Zero(4), 0, "linearly dependent");
  Eigen::MatrixXd twice(4, 2);
  twice << 1, 2, 1, 2, 0, 0, 1, 2;
  fails(twice, 0, "linearly dependent (rank 1)");
  fails(I.leftCols(1), 4, "4 modes asked; expected 0 (all) to 3");
  fails(Eigen::VectorXd::Constant(4, std::numeric_limits<double>::quiet_NaN()), 0, "not finite");
}

}  // namespace
}  // namespace slipmode::fem
