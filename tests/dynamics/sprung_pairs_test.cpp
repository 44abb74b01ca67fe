// Pairs of a structure with supports: beside its equations of motion and beside a decomposition of the state matrix.
#include "dynamics/internal/sprung_pairs.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace slipmode::dynamics {
namespace {

struct Supported {
  Eigen::VectorXd omega, damping;
  std::vector<Support> supports;

  /// Of the balanced state (ω η, η̇).
  [[nodiscard]] Eigen::MatrixXd state_matrix() const {
    const Eigen::Index n = omega.size();
    Eigen::MatrixXd K = omega.cwiseAbs2().asDiagonal(), C = damping.asDiagonal();
    for (const Support& support : supports) {
      K += support.stiffness * support.w * support.w.transpose();
      C += support.damping * support.w * support.w.transpose();
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).diagonal() = omega;
    A.bottomLeftCorner(n, n) = -K * omega.cwiseInverse().asDiagonal();
    A.bottomRightCorner(n, n) = -C;
    return A;
  }
};

/// @param decades  between the slowest and the fastest mode
Supported random_structure(unsigned seed, int n, int supports, double decades) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> normal;
  Supported out{Eigen::VectorXd(n), Eigen::VectorXd(n), {}};
  for (int i = 0; i < n; ++i) {
    out.omega(i) = std::pow(10.0, decades * share(random));
    out.damping(i) = 0.1 * share(random) * out.omega(i);
  }
  for (int k = 0; k < supports; ++k) {
    Support support{Eigen::VectorXd(n), std::pow(10.0, 6.0 * share(random) - 2.0), 0.0};
    for (int i = 0; i < n; ++i) support.w(i) = normal(random);
    if (k % 2 == 1) support.damping = 0.02 * share(random);
    out.supports.push_back(support);
  }
  return out;
}

Eigen::MatrixXd blocks(const PairForm& form) {
  const Eigen::Index n = form.g11.size();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  G.topLeftCorner(n, n).diagonal() = form.g11;
  G.topRightCorner(n, n).diagonal() = form.g12;
  G.bottomLeftCorner(n, n).diagonal() = form.g21;
  G.bottomRightCorner(n, n).diagonal() = form.g22;
  return G;
}

double largest(const Eigen::MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

/// Eigenvectors of length 1, so A T = T G holds to the rounding of A; T and its inverse, to what a product of the two
/// rounds by.
void expect_pairs(const Supported& structure) {
  const auto form = sprung_pairs(structure.omega, structure.damping, structure.supports);
  ASSERT_TRUE(form);
  const Eigen::MatrixXd A = structure.state_matrix();
  const auto n = static_cast<double>(structure.omega.size());
  EXPECT_LT(largest(A * form->T - form->T * blocks(*form)), 1e-15 * n * largest(A));
  EXPECT_LT(largest(form->T * form->T_inverse - Eigen::MatrixXd::Identity(A.rows(), A.rows())),
            1e-15 * n * largest(form->T_inverse));
}

TEST(SprungPairs, SolveTheEquationsOfMotion) {
  for (const double decades : {0.5, 2.0, 5.0}) {
    unsigned seed = 0;
    int found = 0, asked = 0;
    for (const int n : {1, 2, 3, 8, 30, 100})
      for (const int supports : {1, 2, 3}) {
        SCOPED_TRACE(testing::Message() << decades << " decades, " << n << " modes, " << supports << " supports");
        const Supported structure = random_structure(++seed, n, supports, decades);
        ++asked;
        if (!sprung_pairs(structure.omega, structure.damping, structure.supports)) continue;
        ++found;
        expect_pairs(structure);
      }
    // A damper may overdamp a mode. Nothing else stands in the way.
    EXPECT_GE(found, asked - 2) << decades;
  }
}

TEST(SprungPairs, ReachModesThatHardlyMoveThere) {
  // What couples such a mode to the others is linear in w, what shifts it by itself is of second order.
  for (const double least : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    SCOPED_TRACE(least);
    Supported structure = random_structure(5, 6, 2, 1.0);
    for (Support& support : structure.supports) {
      support.w(2) *= least;
      support.w(4) *= least;
    }
    expect_pairs(structure);
  }
}

TEST(SprungPairs, OfStiffSupportsSideBySideAreThoseOfTheirSum) {
  for (const double k : {1e4, 1e6, 1e8}) {
    SCOPED_TRACE(k);
    Supported structure = random_structure(7, 8, 1, 1.0);
    structure.supports.front().stiffness = k;
    structure.supports.push_back({-2.0 * structure.supports.front().w, 0.3 * k, 0.0});
    expect_pairs(structure);
  }
}

TEST(SprungPairs, AreThoseOfTheStateMatrix) {
  int found = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Supported structure = random_structure(seed, 12, 1 + static_cast<int>(seed % 3), 1.0);
    const auto form = sprung_pairs(structure.omega, structure.damping, structure.supports);
    if (!form) continue;
    ++found;
    const PairForm other = pair_form(structure.state_matrix());
    const auto sorted = [](const PairForm& f) {
      std::vector<std::pair<double, double>> values;
      for (Eigen::Index i = 0; i < f.g11.size(); ++i) values.emplace_back(std::abs(f.g12(i)), f.g11(i));
      std::sort(values.begin(), values.end());
      return values;
    };
    const auto ours = sorted(*form), theirs = sorted(other);
    const double size = largest(structure.state_matrix());
    for (std::size_t i = 0; i < ours.size(); ++i) {
      EXPECT_NEAR(ours[i].first, theirs[i].first, 1e-12 * size);
      EXPECT_NEAR(ours[i].second, theirs[i].second, 1e-12 * size);
    }
  }
  EXPECT_GE(found, 18);
}

TEST(SprungPairs, KeepTheDigitsOfSlowModes) {
  // Two modes, the slow one 1e6 times slower and hardly held: λ² + c λ + ω² + k w² (1 − what the fast one gives way) =
  // 0 to first order in k / ω_fast²; what is left out is of the order of its square.
  const double slow = 1.0, fast = 1e6, c = 0.02, k = 3.0;
  const Supported structure{
      Eigen::Vector2d(slow, fast), Eigen::Vector2d(c, 0.02 * fast), {{Eigen::Vector2d(1.0, 1.0), k, 0.0}}};
  const auto form = sprung_pairs(structure.omega, structure.damping, structure.supports);
  ASSERT_TRUE(form);
  const double square = slow * slow + k * (1.0 - k / (fast * fast));
  const Eigen::Index at = std::abs(form->g12(0)) < std::abs(form->g12(1)) ? 0 : 1;
  EXPECT_NEAR(form->g12(at), std::sqrt(square - c * c / 4.0), 1e-14);
  EXPECT_NEAR(form->g11(at), -c / 2.0, 1e-14);
}

TEST(SprungPairs, LeaveModesAloneThatNothingReaches) {
  Supported structure = random_structure(5, 6, 2, 1.0);
  for (Support& support : structure.supports) support.w(2) = support.w(4) = 0.0;
  structure.omega(4) = structure.omega(1);  // one eigenvalue twice, of which one mode is reached
  structure.damping(4) = structure.damping(1);
  expect_pairs(structure);
}

TEST(SprungPairs, LeaveToOthersWhatIsNotTheirs) {
  Supported structure = random_structure(6, 5, 1, 1.0);
  const auto none = [&] { return !sprung_pairs(structure.omega, structure.damping, structure.supports); };
  EXPECT_FALSE(none());
  const Supported as_it_was = structure;
  structure.omega(3) = structure.omega(1);
  structure.damping(3) = structure.damping(1);
  EXPECT_TRUE(none());  // two modes that coincide
  structure = as_it_was;
  structure.damping(2) = 2.0 * structure.omega(2);
  EXPECT_TRUE(none());  // critical damping
  structure = as_it_was;
  structure.omega(0) = structure.damping(0) = 0.0;
  EXPECT_TRUE(none());  // a rigid-body motion
  structure = as_it_was;
  structure.supports.front().damping = 1e3;
  EXPECT_TRUE(none());  // a damper that holds one mode
}

}  // namespace
}  // namespace slipmode::dynamics
