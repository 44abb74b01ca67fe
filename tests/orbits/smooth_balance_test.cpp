// Harmonic balance with the smooth law: closed forms, exact orbits and their multipliers, derivatives by differences.
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/balance/hill.hpp>
#include <slipmode/orbits/branches/balance_branch.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "balance_checks.hpp"
#include "special_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <complex>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using friction::TanhRegularised;

friction::Drive pushed(double omega) { return friction::Force{omega, {{.amplitude = 1.0}}}; }

/// Three masses, the last one rubbed, the first one under the drive.
HybridSystem smoothly_rubbed(const friction::Law& law, const friction::Drive& drive, bool to_ground = true) {
  std::vector<fem::Link> links{{1, 2, 1.5, 0.02}, {2, 3, 0.7, 0.02}};
  if (to_ground) links.push_back({0, 1, 1.0, 0.02});
  return {fem::masses({.mass = {1.0, 0.8, 1.2}, .links = links}),
          {{Eigen::Vector3d::Unit(2), law, 1.0}},
          drive,
          {},
          Eigen::Vector3d::Unit(0)};
}

const TanhRegularised kSmoothLaw{.mu_s = 0.5, .mu_k = 0.3, .alpha = 2.0, .epsilon = 0.05};

TEST(SmoothBalance, FarWithinItsRegularisationIsADamper) {
  // λ = μ_s N v/ε up to (v/ε)² of itself, 1e-12: the linear response with that damper.
  const double epsilon = 1e6, omega = 0.5, c = 0.5 / epsilon;
  const HybridSystem system =
      smoothly_rubbed(TanhRegularised{.mu_s = 0.5, .mu_k = 0.5, .alpha = 0.0, .epsilon = epsilon}, pushed(omega));
  const Balance found = balance(system, {.harmonics = 3});
  ASSERT_TRUE(found.converged) << found.message;
  const fem::Structure& own = system.structure();
  Eigen::MatrixXcd A = (fem::to_dense(own.K()) - omega * omega * fem::to_dense(own.M())).cast<std::complex<double>>() +
                       std::complex<double>(0.0, omega) * fem::to_dense(own.C()).cast<std::complex<double>>();
  A(2, 2) += std::complex<double>(0.0, omega * c);
  const std::complex<double> y =
      A.lu().solve(Eigen::Vector3cd::Unit(0) * std::complex<double>(0.0, -1.0))[2];  // sin ωt
  EXPECT_NEAR(found.displacement[0].cosine[1], y.real(), 1e-11 * std::abs(y));
  EXPECT_NEAR(found.displacement[0].sine[1], -y.imag(), 1e-11 * std::abs(y));
}

TEST(SmoothBalance, JacobianIsExact) {
  for (const bool shaken : {false, true}) {
    const friction::Drive drive =
        shaken ? friction::Drive(friction::Shaker{.amplitude = 2.0, .frequency_hz = 0.08}) : pushed(0.5);
    const HybridSystem system = smoothly_rubbed(kSmoothLaw, drive);
    const Balance at = balance(system, {.harmonics = 9});
    ASSERT_TRUE(at.converged) << at.message;
    expect_exact_jacobian(system, at, 1e-5, 1e-8);
  }
}

TEST(SmoothBalance, ErrorFallsWithoutAnOrder) {
  // An analytic force: each ten harmonics gain a factor, where stops and Jenkins elements gain powers of H. Measured
  // 4.3e-4, 4.7e-6, 3.0e-7, 1.4e-8 at H = 9, 19, 25, 35.
  const HybridSystem system = smoothly_rubbed(kSmoothLaw, pushed(0.5));
  double before = 1.0;
  for (const int H : {9, 19, 29, 39}) {
    const Balance found = balance(system, {.harmonics = H});
    ASSERT_TRUE(found.converged) << found.message;
    const Certificate certificate = certify(system, found);
    ASSERT_TRUE(certificate.behind);
    EXPECT_LT(certificate.relative, before / 10.0) << H;
    before = certificate.relative;
  }
  EXPECT_LT(before, 1e-8);
}

TEST(SmoothBalance, PointsWithoutStaticFrictionAreOfFourthOrder) {
  // The force's second derivative jumps where the speed passes a point, or zero: its coefficients fall as H⁻³, those of
  // the motion as H⁻⁵, and what is left out as H⁻⁴. Measured 1.0e-5, 6.2e-7, 3.8e-8.
  const friction::Measured points{.mu_s = 0.0, .speeds = {0.0, 0.3, 1.0, 2.0}, .coefficients = {0.0, 0.5, 0.3, 0.4}};
  const HybridSystem system = smoothly_rubbed(points, pushed(0.5));
  const auto error = [&](int H) {
    const Balance found = balance(system, {.harmonics = H});
    EXPECT_TRUE(found.converged) << found.message;
    const Certificate certificate = certify(system, found);
    EXPECT_TRUE(certificate.behind);
    return certificate.relative;
  };
  const double coarse = error(15), middle = error(31), fine = error(63);
  EXPECT_NEAR(std::log2(coarse / middle), 4.0 * std::log2(31.0 / 15.0), 0.4);
  EXPECT_NEAR(std::log2(middle / fine), 4.0 * std::log2(63.0 / 31.0), 0.4);
  EXPECT_LT(fine, 1e-7);
}

TEST(SmoothBalance, HillsMultipliersAreTheOrbits) {
  const HybridSystem system = smoothly_rubbed(kSmoothLaw, pushed(0.5));
  const Balance found = balance(system, {.harmonics = 25});
  const PeriodicOrbit orbit = certify(system, found).found.orbit;
  const Eigen::VectorXcd own = hill_multipliers(system, found);
  ASSERT_EQ(own.size(), orbit.multipliers.size());
  EXPECT_LT((own - orbit.multipliers).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(SmoothBalance, BySamplesTendsToAsManyAsItTakes) {
  const HybridSystem system = smoothly_rubbed(kSmoothLaw, pushed(0.5));
  const Balance exact = balance(system, {.harmonics = 9});
  const auto apart = [&](int samples) {
    const Balance own = balance(system, {.harmonics = 9, .samples = samples});
    return (own.displacement[0].cosine - exact.displacement[0].cosine).norm() +
           (own.displacement[0].sine - exact.displacement[0].sine).norm();
  };
  const double few = apart(20), more = apart(40);
  EXPECT_GT(few, 1e-5);
  EXPECT_LT(more, few / 10.0);
  EXPECT_LT(apart(1024), 1e-12);
}

TEST(SmoothBalance, HoldsALawAThousandTimesSharper) {
  // ε is a thousandth of the speeds: nearly Coulomb's law. Shooting finds the orbit behind it.
  const HybridSystem system =
      smoothly_rubbed(TanhRegularised{.mu_s = 0.5, .mu_k = 0.3, .alpha = 2.0, .epsilon = 1e-3}, pushed(0.5));
  const Balance found = balance(system, {.harmonics = 25});
  ASSERT_TRUE(found.converged) << found.message;
  const Certificate certificate = certify(system, found);
  ASSERT_TRUE(certificate.behind);
  EXPECT_LT(certificate.relative, 1e-5);
}

TEST(SmoothBalance, OfAFloatingChainIsOneOfAFamily) {
  const HybridSystem system = smoothly_rubbed(kSmoothLaw, pushed(0.5), false);
  const Balance found = balance(system, {.harmonics = 15});
  ASSERT_TRUE(found.converged) << found.message;
  EXPECT_TRUE(found.family);
  const Certificate certificate = certify(system, found);
  ASSERT_TRUE(certificate.behind);
  EXPECT_LT(certificate.relative, 0.05);
}

TEST(SmoothBalance, SpecialPointsTendToThoseOfShooting) {
  const HybridSystem base = smoothly_rubbed(kSmoothLaw, pushed(0.6));
  const ContinuationOptions options{.from = 0.6, .to = 0.9};
  const PeriodicOrbit first = settled(base, 0.0);
  const std::vector<SpecialPoint> exact =
      of_kind(continue_orbit(over_frequency(base), first, 0.6, options), SpecialKind::kNeimarkSacker);
  ASSERT_EQ(exact.size(), 2U);
  double before = 1.0;
  for (const int H : {9, 21}) {
    const std::vector<SpecialPoint> own =
        of_kind(continue_balance(over_frequency(base), balance(base, {.harmonics = H}), 0.6, options),
                SpecialKind::kNeimarkSacker);
    ASSERT_EQ(own.size(), 2U);
    double worst = 0.0;
    for (std::size_t k = 0; k < 2; ++k) worst = std::max(worst, std::abs(own[k].parameter - exact[k].parameter));
    EXPECT_LT(worst, before / 5.0);
    before = worst;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(SmoothBalance, BristlesAndSticksAreRefused) {
  const HybridSystem base = smoothly_rubbed(kSmoothLaw, pushed(0.5));
  const HybridSystem stribeck(base.structure(), {{Eigen::Vector3d::Unit(2), friction::Stribeck{0.5, 0.3, 2.0}, 1.0}},
                              base.drive(), {}, Eigen::Vector3d::Unit(0));
  try {
    static_cast<void>(balance(stribeck));
    FAIL();
  } catch (const InvalidInput& refused) {
    EXPECT_THAT(refused.what(), testing::AllOf(testing::HasSubstr("tanh"), testing::HasSubstr("shooting")));
  }
}

}  // namespace
}  // namespace slipmode::orbits
