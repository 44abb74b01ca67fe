#include <slipmode/fem/modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include "fem/arpack_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace slipmode::fem {
namespace {

using std::numbers::pi;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Closed forms for unit masses and springs (ω² = 2 − 2 cos θ with the θ that the ends allow), mode k = 1..N.
double fixed_free_omega(int k, int n) { return 2.0 * std::sin((2 * k - 1) * pi / (4 * n + 2)); }
double fixed_fixed_omega(int k, int n) { return 2.0 * std::sin(k * pi / (2 * (n + 1))); }
double free_free_omega(int k, int n) { return 2.0 * std::sin((k - 1) * pi / (2 * n)); }

ChainOptions random_chain(int n, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto draw = [&random] { return 0.5 + 2.0 * static_cast<double>(random() >> 11) * 0x1p-53; };
  ChainOptions options{.masses = n};
  options.mass.clear();
  options.stiffness.clear();
  for (int i = 0; i < n; ++i) {
    options.mass.push_back(draw());
    options.stiffness.push_back(draw());
  }
  return options;
}

Structure dense_copy(const Structure& s) { return {to_dense(s.M()), Rayleigh{}, to_dense(s.K())}; }

// A structure that is no chain: consistent masses, springs to the second neighbour.
Structure lattice(int n) {
  std::vector<Eigen::Triplet<double>> mass;
  std::vector<Eigen::Triplet<double>> stiffness;
  const auto spring = [&](int i, int j, double k) {
    stiffness.emplace_back(i, i, k);
    if (j >= n) return;  // its other end is held by the wall
    stiffness.emplace_back(j, j, k);
    stiffness.emplace_back(i, j, -k);
    stiffness.emplace_back(j, i, -k);
  };
  for (int i = 0; i < n; ++i) {
    mass.emplace_back(i, i, 1.0 + 0.3 * std::sin(i));
    if (i + 1 < n) mass.emplace_back(i, i + 1, 0.2);
    if (i + 1 < n) mass.emplace_back(i + 1, i, 0.2);
    spring(i, i + 1, 1.0);
    spring(i, i + 2, 0.5 + 0.1 * std::cos(i));
  }
  SparseMatrix M(n, n);
  SparseMatrix K(n, n);
  M.setFromTriplets(mass.begin(), mass.end());
  K.setFromTriplets(stiffness.begin(), stiffness.end());
  return {M, Rayleigh{}, K};
}

double mass_orthonormality_error(const Structure& s, const Modes& modes) {
  const Eigen::Index k = modes.shapes.cols();
  return (modes.shapes.transpose() * multiply(s.M(), modes.shapes) - Eigen::MatrixXd::Identity(k, k))
      .cwiseAbs()
      .maxCoeff();
}

double residual(const Structure& s, const Modes& modes) {
  return (multiply(s.K(), modes.shapes) - multiply(s.M(), modes.shapes) * modes.omega.cwiseAbs2().asDiagonal())
      .cwiseAbs()
      .maxCoeff();
}

TEST(NaturalModes, FixedFreeChainHasClosedFormFrequenciesAndShapes) {
  for (const int n : {1, 2, 10, 100}) {
    const Modes modes = natural_modes(chain({.masses = n}));
    ASSERT_EQ(modes.omega.size(), n);
    for (int k = 1; k <= n; ++k) {
      EXPECT_NEAR(modes.omega(k - 1), fixed_free_omega(k, n), 1e-13) << "mode " << k << " of " << n;
      // φ_k(i) = A sin(i θ_k), θ_k = (2k−1)π/(2n+1), A = 2/sqrt(2n+1)
      for (int i = 1; i <= n; ++i) {
        const double shape = 2.0 / std::sqrt(2 * n + 1) * std::sin(i * (2 * k - 1) * pi / (2 * n + 1));
        EXPECT_NEAR(std::abs(modes.shapes(i - 1, k - 1)), std::abs(shape), 2e-12);
      }
    }
  }
}

TEST(NaturalModes, FixedFixedChainHasClosedFormFrequencies) {
  for (const int n : {1, 2, 10, 100}) {
    const Modes modes = natural_modes(chain({.masses = n, .right_fixed = true}));
    for (int k = 1; k <= n; ++k) EXPECT_NEAR(modes.omega(k - 1), fixed_fixed_omega(k, n), 1e-13);
  }
}

TEST(NaturalModes, FreeChainHasOneRigidModeAtExactlyZero) {
  using Solver = std::function<Modes(const Structure&, int)>;
  const auto by = [](EigenMethod method) -> Solver {
    return [method](const Structure& s, int count) { return natural_modes(s, count, method); };
  };
  const auto lowest = [](const Solver& lanczos) -> Solver {
    return [lanczos](const Structure& s, int count) { return lanczos(s, std::min(count - 1, 6)); };
  };
  for (const Solver& solve : {by(EigenMethod::kDense), by(EigenMethod::kTridiagonal), lowest(by(EigenMethod::kSpectra)),
                              lowest(arpack_modes)}) {
    for (const int n : {2, 10, 300}) {
      const Modes modes = solve(chain({.masses = n, .left_fixed = false}), n);
      const auto count = static_cast<int>(modes.omega.size());
      EXPECT_EQ(modes.omega(0), 0.0);
      EXPECT_NEAR((modes.shapes.col(0).array() - 1.0 / std::sqrt(n)).abs().maxCoeff(), 0.0, 1e-11);
      for (int k = 2; k <= count; ++k) EXPECT_NEAR(modes.omega(k - 1), free_free_omega(k, n), 2e-13);
    }
  }
}

TEST(NaturalModes, OfRandomFreeChainsSolveTheirEquations) {
  // The least singular value of such a chain's factor is rounding. Of 20,000 two had modes of another structure,
  // without a word (Eigen's BDCSVD): these two, and some that had not. Expected: K φ = ω² M φ to rounding.
  for (const auto& [n, seed] : {std::pair(34, 1457U), {33, 11236U}, {17, 1U}, {50, 2U}, {64, 3U}}) {
    ChainOptions options = random_chain(n, seed);
    options.left_fixed = options.right_fixed = false;
    options.stiffness.pop_back();
    const Structure s = chain(options);
    const Modes modes = natural_modes(s);
    const Eigen::MatrixXd M = to_dense(s.M()), K = to_dense(s.K());
    EXPECT_LT((K * modes.shapes - M * modes.shapes * modes.omega.cwiseAbs2().asDiagonal()).cwiseAbs().maxCoeff(),
              1e-13 * n)
        << n << " masses, seed " << seed;
    EXPECT_LT((modes.shapes.transpose() * M * modes.shapes - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(),
              1e-13);
  }
}

TEST(NaturalModes, OfRandomMassesAndSpringsSolveTheirEquations) {
  // 2 to 90 masses on a random tree of springs and a few more between any two, held or not, springs to 1e6 times one
  // another. Expected: K φ = ω² M φ and φᵀMφ = 1 to rounding of the largest terms.
  std::mt19937_64 random(7);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int trial = 0; trial < 300; ++trial) {
    const auto n = static_cast<Eigen::Index>(2 + random() % 89);
    const double spread = trial % 3 == 0 ? 1e6 : 10.0;
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n), K = M;
    const auto join = [&](Eigen::Index i, Eigen::Index j) {
      if (i == j) return;
      const double k = std::pow(spread, uniform());
      K(i, i) += k;
      K(j, j) += k;
      K(i, j) -= k;
      K(j, i) -= k;
    };
    const auto any = [&](Eigen::Index below) {
      return static_cast<Eigen::Index>(random() % static_cast<unsigned>(below));
    };
    for (Eigen::Index i = 0; i < n; ++i) {
      M(i, i) = 0.3 + uniform();
      if (i > 0) join(i, any(i));
    }
    for (int more = 0; more < 3; ++more) join(any(n), any(n));
    if (trial % 2 == 0) K(0, 0) += uniform();
    const Modes modes = natural_modes({Matrix(M), Rayleigh{}, Matrix(K)});
    const double scale = K.cwiseAbs().rowwise().sum().maxCoeff() * modes.shapes.cwiseAbs().maxCoeff();
    const Eigen::MatrixXd residual = K * modes.shapes - M * modes.shapes * modes.omega.cwiseAbs2().asDiagonal();
    EXPECT_LT(residual.cwiseAbs().maxCoeff(), 1e-12 * scale) << "trial " << trial << ", " << n << " masses";
    EXPECT_LT((modes.shapes.transpose() * M * modes.shapes - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(),
              1e-12)
        << "trial " << trial << ", " << n << " masses";
  }
}

TEST(NaturalModes, OneFreeMassIsARigidMode) {
  const Modes modes = natural_modes(chain({.masses = 1, .mass = {4.0}, .left_fixed = false}));
  EXPECT_EQ(modes.omega(0), 0.0);
  EXPECT_DOUBLE_EQ(modes.shapes(0, 0), 0.5);  // φ²·4 = 1
}

TEST(NaturalModes, AStiffnessFarBelowTheOthersIsNotTakenForARigidMode) {
  const Modes modes = natural_modes(chain({.masses = 10, .stiffness = {1e-10, 1, 1, 1, 1, 1, 1, 1, 1, 1}}));
  // the chain moves as one on its soft spring: ω² = 1e-10/10, up to 1e-10 relative for its own give
  EXPECT_NEAR(modes.omega(0) / std::sqrt(1e-11), 1.0, 1e-4);  // ω² is known to about 1e-16/1e-11
}

TEST(NaturalModes, LanczosFindsTheLowestOfTenThousandMasses) {
  const int n = 10000;
  const Structure s = chain({.masses = n});
  const Modes spectra = natural_modes(s, 6, EigenMethod::kSpectra);
  const Modes arpack = arpack_modes(s, 6);
  const Modes tridiagonal = natural_modes(s, 6);
  for (int k = 1; k <= 6; ++k) {
    const double exact = fixed_free_omega(k, n);
    // a rounding error of 1e-16 in K is 4e-9 of the lowest ω² = 2.5e-8; polished Lanczos does better than it must
    EXPECT_NEAR(spectra.omega(k - 1) / exact, 1.0, 1e-11);
    EXPECT_NEAR(tridiagonal.omega(k - 1) / exact, 1.0, 1e-9);
    EXPECT_NEAR(arpack.omega(k - 1) / exact, 1.0, 1e-8);
  }
  EXPECT_LT((spectra.shapes - tridiagonal.shapes).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(NaturalModes, AllMethodsAgreeOnRandomChains) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Structure s = chain(random_chain(60, seed));
    const Modes dense = natural_modes(s, 0, EigenMethod::kDense);
    const Modes tridiagonal = natural_modes(s, 0, EigenMethod::kTridiagonal);
    const Modes spectra = natural_modes(s, 8, EigenMethod::kSpectra);
    const Modes arpack = arpack_modes(s, 8);
    EXPECT_LT((dense.omega - tridiagonal.omega).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((dense.omega.head(8) - spectra.omega).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((dense.omega.head(8) - arpack.omega).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((dense.shapes.leftCols(8) - spectra.shapes).cwiseAbs().maxCoeff(), 1e-10);
    EXPECT_LT((dense.shapes.leftCols(8) - arpack.shapes).cwiseAbs().maxCoeff(), 1e-10);
    for (const Modes& modes : {dense, tridiagonal, spectra, arpack}) {
      EXPECT_LT(mass_orthonormality_error(s, modes), 1e-12);
      EXPECT_LT(residual(s, modes), 1e-11);
    }
  }
}

TEST(NaturalModes, LightMassesBetweenHeavyOnesHaveModesThatAllButCoincide) {
  // Twenty of 80 masses of 1e-4: LAPACK's dstemr gives up on their frequencies (info = 22). Expected: K φ = ω² M φ to
  // rounding of the largest ω², where masses are one, and φᵀ M φ = 1.
  ChainOptions options{.masses = 80, .mass = std::vector<double>(80, 1.0)};
  options.right_fixed = true;
  for (const std::size_t light :
       {0U, 5U, 10U, 15U, 16U, 20U, 25U, 30U, 32U, 35U, 36U, 46U, 48U, 51U, 53U, 57U, 59U, 66U, 67U, 79U})
    options.mass[light] = 1e-4;
  const Structure s = chain(options);
  const Modes modes = natural_modes(s, 0, EigenMethod::kTridiagonal);
  const Eigen::MatrixXd M = to_dense(s.M()), K = to_dense(s.K());
  const Eigen::VectorXd lambda = modes.omega.cwiseAbs2(), over_root = M.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd left = over_root.asDiagonal() * (K * modes.shapes - M * modes.shapes * lambda.asDiagonal());
  EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-14 * lambda.maxCoeff());
  EXPECT_LT(mass_orthonormality_error(s, modes), 1e-13);
  const Modes dense = natural_modes(s, 0, EigenMethod::kDense);
  EXPECT_LT((dense.omega - modes.omega).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(NaturalModes, LanczosServesStructuresThatAreNoChains) {
  const Structure s = lattice(600);
  ASSERT_FALSE(s.is_chain_like());
  const Modes automatic = natural_modes(s, 7);
  const Modes dense = natural_modes(s, 7, EigenMethod::kDense);
  const Modes arpack = arpack_modes(s, 7);
  EXPECT_LT((automatic.omega - dense.omega).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((automatic.omega - arpack.omega).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((automatic.shapes - arpack.shapes).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(mass_orthonormality_error(s, automatic), 1e-12);
  EXPECT_LT(residual(s, automatic), 1e-11);
}

TEST(NaturalModes, DenseAndSparseStorageGiveTheSameModes) {
  const Structure s = chain(random_chain(20, 7));
  const Modes sparse = natural_modes(s);
  const Modes dense = natural_modes(dense_copy(s));
  EXPECT_EQ(sparse.omega, dense.omega);
  EXPECT_EQ(sparse.shapes, dense.shapes);
}

TEST(NaturalModes, LargestComponentIsPositiveAndTiesGoToTheFirst) {
  // two equal masses between walls: the second shape is (1, −1)/√2, both components equal in magnitude
  const Modes modes = natural_modes(chain({.masses = 2, .right_fixed = true}));
  EXPECT_NEAR(modes.shapes(0, 1), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(modes.shapes(1, 1), -std::sqrt(0.5), 1e-15);
  const Modes many = natural_modes(chain(random_chain(30, 3)));
  for (const auto shape : many.shapes.colwise()) EXPECT_EQ(shape.maxCoeff(), shape.cwiseAbs().maxCoeff());
}

TEST(NaturalModes, RejectsBadInputSayingWhy) {
  const Structure s = chain({.masses = 5});
  EXPECT_THAT([&] { (void)natural_modes(s, 6); }, ThrowsMessage<InvalidInput>(HasSubstr("6 modes asked; expected 0")));
  EXPECT_THAT([&] { (void)natural_modes(s, -1); }, ThrowsMessage<InvalidInput>(HasSubstr("-1 modes asked")));
  EXPECT_THAT([&] { (void)natural_modes(s, 5, EigenMethod::kSpectra); },
              ThrowsMessage<InvalidInput>(HasSubstr("at most 4 of 5 modes")));
  EXPECT_THAT([&] { (void)natural_modes(lattice(5), 2, EigenMethod::kTridiagonal); },
              ThrowsMessage<InvalidInput>(HasSubstr("diagonal M and a tridiagonal K")));
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::MatrixXd indefinite{{1.0, 2.0}, {2.0, 1.0}};
  EXPECT_THAT([&] { (void)natural_modes(Structure(I, Rayleigh{}, indefinite)); },
              ThrowsMessage<InvalidInput>(HasSubstr("K is not positive semi-definite")));
}

}  // namespace
}  // namespace slipmode::fem
