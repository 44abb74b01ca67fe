#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_modes.hpp>
#include <slipmode/fem/chain.hpp>
#include "fixtures/cantilever_beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace slipmode::fem {
namespace {

using fixtures::source_beam;
using testing::HasSubstr;
using testing::ThrowsMessage;

Beam extended_beam(int elements) {
  BeamOptions options = source_beam(elements);
  options.tip.extension = 0.076;
  return Beam(options);
}

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(CompliantModes, OfAChainAreThoseOfTheChainWithThatSpring) {
  // a spring at the last mass is the right wall's spring: 2 sin(kπ/2(N+1)), closed form for unit masses between walls
  for (const int n : {3, 40, 600}) {
    const Modes modes = compliant_modes(chain({.masses = n}), Eigen::VectorXd::Unit(n, n - 1), one(1.0), 3);
    for (int k = 1; k <= 3; ++k) {
      EXPECT_NEAR(modes.omega(k - 1), 2.0 * std::sin(k * std::numbers::pi / (2 * n + 2)), 1e-13);
    }
  }
}

TEST(CompliantModes, OfAFreeChainAreHeldByTheSpringAlone) {
  // two unit masses, no walls, a spring of 1 at one: λ² − 3λ + 1 = 0
  const Structure free = chain({.masses = 2, .left_fixed = false});
  const Modes modes = compliant_modes(free, Eigen::VectorXd::Unit(2, 0), one(1.0));
  EXPECT_NEAR(modes.omega(0), (std::sqrt(5.0) - 1.0) / 2.0, 1e-15);
  EXPECT_NEAR(modes.omega(1), (std::sqrt(5.0) + 1.0) / 2.0, 1e-15);
}

TEST(CompliantModes, SatisfyTheEquationsWithSeveralContacts) {
  for (const int elements : {20, 300}) {  // dense factors; Lanczos
    const Beam beam = extended_beam(elements);
    const Structure& s = beam.structure();
    Eigen::MatrixXd W(s.size(), 2);
    W << beam.displacement_row(beam.reach()), beam.displacement_row(0.2);
    const Eigen::Vector2d k(2e4, 50.0);
    const Modes modes = compliant_modes(s, W, k, 6);
    EXPECT_TRUE((modes.shapes.transpose() * multiply(s.M(), modes.shapes)).isIdentity(1e-10));
    const Eigen::MatrixXd stiffness = modes.shapes.transpose() * multiply(s.K(), modes.shapes) +
                                      modes.shapes.transpose() * W * k.asDiagonal() * W.transpose() * modes.shapes;
    const Eigen::VectorXd scale = modes.omega.cwiseInverse();
    EXPECT_TRUE((scale.asDiagonal() * stiffness * scale.asDiagonal()).isIdentity(1e-6)) << elements;
  }
}

TEST(CompliantModes, OfTheBeamTendToTheRigidlyStuckOnesWithTheFirstPowerOfTheCompliance) {
  const Beam beam = extended_beam(40);
  const Eigen::VectorXd w = beam.displacement_row(beam.reach());
  const Modes rigid = constrained_modes(beam.structure(), w, 6);
  const auto drop = [&](double k) {
    return Eigen::VectorXd(1.0 - compliant_modes(beam.structure(), w, one(k), 6).omega.array() / rigid.omega.array());
  };
  // λ_rigid − λ = R²/k to first order, R = wᵀ-direction reaction of the mass-normalised rigid mode (perturbation of a
  // constraint into a spring), so the relative change of ω is R²/(2 k λ)
  const Eigen::MatrixXd force = multiply(beam.structure().K(), rigid.shapes) -
                                multiply(beam.structure().M(), rigid.shapes) * rigid.omega.cwiseAbs2().asDiagonal();
  const Eigen::ArrayXd reaction = (w.transpose() * force).transpose().array() / w.squaredNorm();
  const Eigen::ArrayXd slope = reaction.square() / (2.0 * rigid.omega.array().square());
  for (const double k : {1e6, 1e7, 1e8}) {
    const Eigen::ArrayXd expected = slope / k;
    EXPECT_LT((drop(k).array() / expected - 1.0).abs().maxCoeff(), k < 5e6 ? 2e-3 : 2e-4) << k;
  }
  EXPECT_LT(drop(1e12).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(CompliantModes, FrequenciesRiseWithTheContactStiffnessFromFreeToStuck) {
  const Beam beam = extended_beam(20);
  const Eigen::VectorXd w = beam.displacement_row(beam.reach());
  const Eigen::VectorXd free = natural_modes(beam.structure(), 6).omega;
  const Eigen::VectorXd stuck = constrained_modes(beam.structure(), w, 6).omega;
  Eigen::VectorXd last = free;
  for (const double k : {1.0, 1e2, 1e4, 1e6}) {
    const Eigen::VectorXd omega = compliant_modes(beam.structure(), w, one(k), 6).omega;
    EXPECT_GT((omega - last).minCoeff(), 0.0);
    EXPECT_GT((stuck - omega).minCoeff(), 0.0);
    last = omega;
  }
}

TEST(CompliantModes, OfLanczosAndOfDenseFactorsAgree) {
  const Beam beam = extended_beam(255);  // 510 dofs: few modes by Lanczos, a fifth of them by dense factors
  const Eigen::VectorXd w = beam.displacement_row(beam.reach());
  for (const double k : {1e2, 2e4, 1e8}) {
    const Modes few = compliant_modes(beam.structure(), w, one(k), 6);
    const Modes many = compliant_modes(beam.structure(), w, one(k), 110);
    EXPECT_LT((few.omega.array() / many.omega.head(6).array() - 1.0).abs().maxCoeff(), 1e-7) << k;
  }
}

TEST(CompliantModes, RejectBadInputSayingWhy) {
  const Structure s = chain({.masses = 3});
  const auto fails = [&s](const Eigen::MatrixXd& W, const Eigen::VectorXd& k, Eigen::Index count, const char* message) {
    EXPECT_THAT([&] { (void)compliant_modes(s, W, k, count); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  const Eigen::VectorXd w = Eigen::VectorXd::Unit(3, 0);
  fails(Eigen::VectorXd::Ones(2), one(1.0), 0, "2 rows, expected 3");
  fails(w, Eigen::Vector2d(1.0, 2.0), 0, "2 stiffnesses for 1 directions");
  fails(w, one(0.0), 0, "contact stiffness = 0; expected a finite value > 0");
  fails(w, one(std::numeric_limits<double>::infinity()), 0, "expected a finite value > 0");
  fails(std::numeric_limits<double>::quiet_NaN() * w, one(1.0), 0, "not finite");
  fails(w, one(1.0), 4, "4 modes asked; expected 0 (all) to 3");
}

}  // namespace
}  // namespace slipmode::fem
