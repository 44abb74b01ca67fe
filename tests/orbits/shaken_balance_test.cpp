// Harmonic balance under a shaker: against the same motion seen from the counterpart, against exact orbits of shooting
// and closed forms.
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/branches/balance_branch.hpp>
#include "balance_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using std::numbers::pi;

constexpr double kStiffness = 1.0, kDamping = 0.05, kOmega = 0.8, kLimit = 0.3, kSpring = 1.0, kPhase = 0.3;

friction::Contact element(Eigen::VectorXd direction, double limit, double stiffness) {
  return {std::move(direction), friction::CompliantCoulomb{limit, limit, stiffness}, 1.0};
}

friction::Shaker shaker(double amplitude, double omega = kOmega, double phase = kPhase) {
  return {amplitude, omega / (2.0 * pi), phase};
}

HybridSystem one_mass(friction::Drive drive) {
  return {fem::masses({.links = {{.stiffness = kStiffness, .damping = kDamping}}}),
          {element(Eigen::VectorXd::Ones(1), kLimit, kSpring)},
          std::move(drive),
          {},
          Eigen::MatrixXd::Ones(1, 1)};
}
HybridSystem shaken_mass(double amplitude, double omega = kOmega) { return one_mass(shaker(amplitude, omega)); }

/// Seen from the counterpart, z = y − d, the mass obeys m z̈ + c ż + k z = λ(z) − (m d̈ + c ḋ + k d): a force.
HybridSystem forced_mass(double amplitude) {
  const double in_phase = kOmega * kOmega - kStiffness, quadrature = -kDamping * kOmega;
  return one_mass(friction::Force{kOmega,
                                  {{.amplitude = amplitude * std::hypot(in_phase, quadrature),
                                    .phase = kPhase + std::atan2(quadrature, in_phase)}}});
}

/// Three masses, two elements on the last, one on the first; a stop, which stands still, beside that one.
HybridSystem shaken_chain(bool with_stop, double omega = 0.9) {
  const Eigen::Vector3d first = Eigen::Vector3d::UnitX(), last = Eigen::Vector3d::UnitZ();
  std::vector<friction::Contact> contacts = {element(last, 0.1, 0.6), element(last, 0.2, 0.5),
                                             element(first, 0.1, 1.0)};
  if (with_stop)
    contacts.push_back({first, friction::Clearance{{}, friction::Stop{.stiffness = 2.0, .damping = 0.1, .gap = 0.1}}});
  return {fem::masses({.mass = {1.0, 0.7, 1.2}, .links = {{0, 1, 1.0, 0.05}, {1, 2, 1.5, 0.03}, {2, 3, 1.0, 0.04}}}),
          std::move(contacts), shaker(0.6, omega)};
}

std::complex<double> phasor(const Harmonics& y, Eigen::Index k) { return {y.cosine[k], -y.sine[k]}; }
/// Of d = A sin(Ωt + φ).
std::complex<double> shaken_by(double amplitude) {
  return amplitude * std::complex<double>(std::sin(kPhase), -std::cos(kPhase));
}

TEST(ShakenBalance, OfAMassIsThatUnderTheForceSeenFromTheCounterpart) {
  // It slides from 1.127 on, as ShakenBranch finds.
  for (const double amplitude : {0.2, 1.2, 1.6, 9.0})
    for (const int H : {1, 9, 49}) {
      SCOPED_TRACE(testing::Message() << amplitude << ", " << H);
      const Balance shaken = balance(shaken_mass(amplitude), {.harmonics = H});
      const Balance forced = balance(forced_mass(amplitude), {.harmonics = H});
      ASSERT_TRUE(shaken.converged && forced.converged) << shaken.message << forced.message;
      for (Eigen::Index k = 0; k <= H; ++k) {
        const std::complex<double> d = k == 1 ? shaken_by(amplitude) : 0.0;
        EXPECT_LT(std::abs(phasor(shaken.displacement[0], k) - d - phasor(forced.displacement[0], k)),
                  1e-11 * amplitude);
        EXPECT_LT(std::abs(phasor(shaken.force[0], k) - phasor(forced.force[0], k)), 1e-11 * amplitude);
      }
      EXPECT_EQ(shaken.switches, forced.switches);
      EXPECT_EQ(shaken.switches, amplitude == 0.2 ? 0 : 4);
      EXPECT_EQ(shaken.stuck, forced.stuck);
    }
}

TEST(ShakenBalance, BySamplesTendsToTheExactForces) {
  const Balance exact = balance(shaken_mass(1.6), {.harmonics = 9});
  const auto off = [&](int samples) {
    const Balance sampled = balance(shaken_mass(1.6), {.harmonics = 9, .samples = samples});
    EXPECT_TRUE(sampled.converged) << sampled.message;
    return std::abs(phasor(sampled.displacement[0], 1) - phasor(exact.displacement[0], 1));
  };
  EXPECT_LT(off(8192), 1e-6);
  EXPECT_LT(off(8192), 0.1 * off(512));
}

TEST(ShakenBalance, JacobianIsExactBesideAStop) {
  // Where elements slide and the stop presses; two of the three contacts are one place.
  const HybridSystem system = shaken_chain(true);
  const Balance at = balance(system, {.harmonics = 9});
  ASSERT_TRUE(at.converged) << at.message;
  ASSERT_EQ(balance_equations(system, at).jacobian.cols(), 2 * (2 * at.harmonics + 1)) << "two places";
  expect_exact_jacobian(system, at, 1e-5, 1e-9);
}

TEST(ShakenBalance, ErrorFallsWithTheThirdPowerOfTheOrder) {
  // Of friction alone, as under a force; against an orbit that shooting finds from a run of its own.
  const HybridSystem system = shaken_chain(false);
  const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 60.0));
  const auto error = [&](int H) {
    const Balance own = balance(system, {.harmonics = H});
    EXPECT_TRUE(own.converged) << own.message;
    EXPECT_EQ(own.stuck, 0);
    EXPECT_EQ(own.switches, orbit.crossings);
    EXPECT_LT((state_of(system, own).internal - orbit.start.internal).norm(), 0.1 / H);
    const std::vector<double> off = true_errors(own, OrbitSeries(system, orbit));
    return *std::ranges::max_element(off);
  };
  EXPECT_NEAR(std::log(error(15) / error(121)) / std::log(121.0 / 15.0), 3.0, 0.5);
}

TEST(ShakenBalance, MeetsItsErrorBesideAStop) {
  // At 0.45 one element never slides: each order has an orbit of its own behind, of a family that curves.
  for (const double omega : {0.9, 0.45}) {
    const HybridSystem system = shaken_chain(true, omega);
    const CertifiedBalance chosen = balance_to_error(system, {}, 2e-5);
    ASSERT_TRUE(chosen.met) << chosen.certificate.verdict;
    EXPECT_LE(chosen.certificate.relative, 2e-5);
    EXPECT_EQ(chosen.approximation.stuck, omega == 0.45 ? 1 : 0);
    EXPECT_EQ(chosen.approximation.switches, chosen.certificate.found.orbit.crossings);
  }
}

TEST(ShakenBalance, OfThreePeriodsIsThatOfOne) {
  const HybridSystem system = shaken_mass(1.6);
  const Balance once = balance(system, {.harmonics = 7});
  const Balance thrice = balance(system, {.order = 3, .harmonics = 23});
  ASSERT_TRUE(thrice.converged) << thrice.message;
  for (Eigen::Index k = 0; k <= 23; ++k) {
    const std::complex<double> same = k % 3 == 0 ? phasor(once.displacement[0], k / 3) : 0.0;
    EXPECT_LT(std::abs(phasor(thrice.displacement[0], k) - same), 1e-11);
  }
}

TEST(ShakenBranch, BeginsToSlideWhereTheLinearResponseReachesTheLimit) {
  // |z| K = limit with z the relative motion of mass, spring and contact spring under the force seen from there.
  const dynamics::SystemFamily family = [](double amplitude) { return shaken_mass(amplitude); };
  const Balance first = balance(family(0.2), {.harmonics = 9});
  Branch branch = continue_balance(family, first, 0.2, {.from = 0.2, .to = 3.0});
  EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  ASSERT_EQ(branch.special.size(), 1U);
  EXPECT_EQ(branch.special[0].kind, SpecialKind::kStickChange);
  const std::complex<double> structure(kStiffness - kOmega * kOmega, kDamping * kOmega);
  EXPECT_NEAR(branch.special[0].parameter, kLimit / kSpring * std::abs(structure + kSpring) / std::abs(structure),
              1e-8);
  const BranchCertificate certificate = certify_branch(family, branch, 5);
  EXPECT_EQ(certificate.behind, certificate.certified);
  EXPECT_LT(certificate.worst, 1e-2);
}

TEST(ShakenBranch, OverTheFrequencyEndsOnTheBalanceFoundThere) {
  const dynamics::SystemFamily family = [](double omega) { return shaken_mass(0.9, omega); };
  const Balance first = balance(family(0.6), {.harmonics = 15});
  const Branch branch = continue_balance(family, first, 0.6, {.from = 0.6, .to = 2.0});
  ASSERT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  const Balance last = balance(family(2.0), {.harmonics = 15});
  EXPECT_LT((branch.points.back().balance->displacement[0].cosine - last.displacement[0].cosine).norm(), 1e-9);
  EXPECT_LT((branch.points.back().balance->displacement[0].sine - last.displacement[0].sine).norm(), 1e-9);
}

TEST(ShakenBalance, RefusesWhatItCannotHold) {
  const HybridSystem system = shaken_mass(1.6);
  const auto refusal = [&](friction::CompliantCoulomb law, friction::NormalLoad load,
                           BalanceOptions options) -> std::string {
    friction::Contact contact = system.contacts()[0];
    contact.law = law;
    contact.normal_load = load;
    try {
      (void)balance(system.with_laws({contact}), options);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({0.4, 0.3, 1.0}, 1.0, {}), testing::HasSubstr("contact.0.mu_s"));
  EXPECT_THAT(refusal({0.3, 0.3, 1.0}, {1.0, 0.1}, {}), testing::HasSubstr("contact.0.normal_load"));
  EXPECT_THAT(refusal({0.3, 0.3, 1.0}, 1.0, {.order = 3, .harmonics = 2}), testing::HasSubstr("harmonics: 2"));
}

}  // namespace
}  // namespace slipmode::orbits
