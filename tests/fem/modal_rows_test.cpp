#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/modes.hpp>
#include "fem/internal/separate_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace slipmode::fem {
namespace {

using std::numbers::pi;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ModalRows, AgreeWithTheShapesOfRandomChains) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&random] { return 0.2 + static_cast<double>(random() >> 11) * 0x1p-53; };
    const int n = 2 + static_cast<int>(random() % 60);
    ChainOptions options{.masses = n, .mass = {}, .stiffness = {}};
    for (int i = 0; i < n; ++i) options.mass.push_back(draw());
    for (int i = 0; i < n; ++i) options.stiffness.push_back(draw());
    options.ground_stiffness = {draw()};
    const Structure s = chain(options);
    Eigen::MatrixXd Y(n, 3);
    for (double& y : Y.reshaped()) y = draw() - 0.7;

    const ModalRows tracked = modal_rows(s, Y);
    const Modes modes = natural_modes(s, 0, EigenMethod::kDense);
    const Eigen::MatrixXd full = Y.transpose() * modes.shapes;
    EXPECT_LT((tracked.omega - modes.omega).cwiseAbs().maxCoeff(), 1e-13);
    for (int k = 0; k < n; ++k) {  // one sign per mode is free
      const Eigen::VectorXd a = tracked.rows.col(k);
      const Eigen::VectorXd b = full.col(k);
      EXPECT_LT(std::min((a - b).norm(), (a + b).norm()), 1e-11) << "mode " << k << " of " << n << ", seed " << seed;
    }
  }
}

TEST(ModalRows, ContactRowOfALongChainHasItsClosedForm) {
  for (const int n : {1000, 10000}) {
    const ModalRows tracked = modal_rows(chain({.masses = n}), Eigen::VectorXd::Unit(n, n - 1));
    double omega_error = 0.0, row_error = 0.0;
    for (int k = 1; k <= n; ++k) {
      omega_error =
          std::max(omega_error, std::abs(tracked.omega(k - 1) - 2.0 * std::sin((2 * k - 1) * pi / (4 * n + 2))));
      // φ_k(N) = ± 2/sqrt(2N+1) sin(Nθ), θ = (2k−1)π/(2N+1); sin(Nθ) = ± cos(θ/2)
      const double exact = 2.0 / std::sqrt(2 * n + 1) * std::cos((2 * k - 1) * pi / (4 * n + 2));
      row_error = std::max(row_error, std::abs(std::abs(tracked.rows(0, k - 1)) - exact));
    }
    EXPECT_LT(omega_error, 1e-12) << n;
    EXPECT_LT(row_error, 1e-11) << n;
  }
}

TEST(ModalRows, OfTenThousandMassesAreFoundOneByOne) {
  const int n = 10000;
  const Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(n, 1.0), coupling = Eigen::VectorXd::Constant(n - 1, -0.5);
  EXPECT_TRUE(detail::separate_modes(diagonal, coupling, Eigen::RowVectorXd::Unit(n, n - 1)).has_value());
}

TEST(ModalRows, SquaresSumToTheInverseMass) {
  // completeness: Φ Φᵀ = M⁻¹
  const Structure s = chain({.masses = 50, .mass = {2.5}, .left_fixed = false});
  const ModalRows tracked = modal_rows(s, Eigen::VectorXd::Unit(50, 20));
  EXPECT_NEAR(tracked.rows.squaredNorm(), 0.4, 1e-14);
  EXPECT_EQ(tracked.omega(0), 0.0);
  EXPECT_GT(tracked.omega(1), 0.0);
}

TEST(ModalRows, SurviveSeparateMassesAndTwins) {
  // no coupling at all, and equal frequencies: 4 masses, each only on its own ground spring
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(4, 4);
  const ModalRows tracked = modal_rows(Structure(I, Rayleigh{}, Eigen::MatrixXd(4.0 * I)), I);
  EXPECT_EQ(tracked.omega, Eigen::VectorXd::Constant(4, 2.0));
  EXPECT_TRUE((tracked.rows * tracked.rows.transpose()).isIdentity(1e-15));
}

TEST(ModalRows, OfManyRandomMassesAgreeWithTheirShapes) {
  // Beyond the size from which pairs are found one by one; what separate_modes gives is compared with dense modes.
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&random] { return 0.8 + 0.4 * static_cast<double>(random() >> 11) * 0x1p-53; };
    const int n = 64 + static_cast<int>(random() % 100);
    const Eigen::VectorXd diagonal = Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return 0.6 * draw(); });
    const Eigen::VectorXd coupling = Eigen::VectorXd::NullaryExpr(n - 1, [&](Eigen::Index) { return -0.25 * draw(); });
    Eigen::MatrixXd rows(2, n);
    for (double& y : rows.reshaped()) y = draw() - 1.0;
    const auto modes = detail::separate_modes(diagonal, coupling, rows);
    ASSERT_TRUE(modes.has_value());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense;
    dense.computeFromTridiagonal(diagonal, coupling);
    EXPECT_LT((modes->values - dense.eigenvalues()).cwiseAbs().maxCoeff(), 1e-13);
    const Eigen::MatrixXd full = rows * dense.eigenvectors();
    for (int k = 0; k < n; ++k) {
      const double sign = full.col(k).dot(modes->rows.col(k)) < 0.0 ? -1.0 : 1.0;
      EXPECT_LT((full.col(k) - sign * modes->rows.col(k)).norm(), 1e-10) << "mode " << k << " of " << n;
    }
  }
}

TEST(ModalRows, OfTwinsAreNotSoughtOneByOne) {
  // Two equal halves, each held to the ground, joined by a spring of 1e-9: pairs of frequencies 1e-9 apart, whose
  // shapes no residual tells apart. Expected: completeness, Φ Φᵀ = M⁻¹ = I, and no separate modes.
  const int n = 80;
  ChainOptions options{.masses = n, .stiffness = std::vector<double>(n, 1.0), .ground_stiffness = {0.5}};
  options.stiffness[0] = 1e-9;
  options.stiffness[n / 2] = 1e-9;
  const Structure s = chain(options);
  Eigen::MatrixXd Y(n, 3);
  Y << Eigen::VectorXd::Unit(n, 3), Eigen::VectorXd::Unit(n, n / 2 + 3), Eigen::VectorXd::Unit(n, n - 1);
  const Eigen::MatrixXd found = modal_rows(s, Y).rows;
  EXPECT_LT((found * found.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  const Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(n, 0.5);
  Eigen::VectorXd coupling = Eigen::VectorXd::Constant(n - 1, -0.2);
  coupling(n / 2 - 1) = 1e-5;
  EXPECT_FALSE(detail::separate_modes(diagonal, coupling, Y.transpose()).has_value());
}

TEST(ModalRows, OneMass) {
  const ModalRows tracked = modal_rows(chain({.masses = 1, .mass = {4.0}}), Eigen::VectorXd::Ones(1));
  EXPECT_DOUBLE_EQ(tracked.omega(0), 0.5);
  EXPECT_DOUBLE_EQ(std::abs(tracked.rows(0, 0)), 0.5);
}

TEST(ModalRows, RejectBadInputSayingWhy) {
  const Structure s = chain({.masses = 4});
  EXPECT_THAT([&] { (void)modal_rows(s, Eigen::VectorXd::Ones(3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("3 rows, expected 4")));
  EXPECT_THAT([&] { (void)modal_rows(s, Eigen::VectorXd::Constant(4, std::nan(""))); },
              ThrowsMessage<InvalidInput>(HasSubstr("not finite")));
  const Eigen::MatrixXd M{{2.0, 0.5}, {0.5, 1.0}};
  EXPECT_THAT([&] { (void)modal_rows(Structure(M, Rayleigh{}, M), Eigen::VectorXd::Ones(2)); },
              ThrowsMessage<InvalidInput>(HasSubstr("tridiagonal")));
}

}  // namespace
}  // namespace slipmode::fem
