// Harmonic balance with Coulomb friction behind contact springs: its forces against closed forms and against an
// operator that is marched, its solutions against exact orbits.
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/orbits/balance/hill.hpp>
#include <slipmode/orbits/branches/balance_branch.hpp>
#include "fixtures/differences.hpp"
#include "orbits/balance/internal/balanced_law.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
#include <random>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using std::numbers::pi;

friction::Contact jenkins(Eigen::VectorXd direction, double limit, double stiffness) {
  return {std::move(direction), friction::CompliantCoulomb{limit, limit, stiffness}, 1.0};
}

/// A mass on a spring and on a Jenkins element, limit 0.3 and stiffness 1 both of the contact and of the spring.
HybridSystem rubbed_mass(double amplitude, double omega = 0.8, Eigen::VectorXd load = {}) {
  return {fem::masses({.links = {{.stiffness = 1.0, .damping = 0.05}}}),
          {jenkins(Eigen::VectorXd::Ones(1), 0.3, 1.0)},
          friction::Force{omega, {{.amplitude = amplitude}}},
          std::move(load),
          Eigen::MatrixXd::Ones(1, 1)};
}

/// datasets/jenkins_chain.
HybridSystem rubbed_chain(double amplitude = 0.4) {
  return {fem::chain({.masses = 10, .damping = 0.02}),
          {jenkins(Eigen::VectorXd::Unit(10, 4), 0.3, 1.0), jenkins(Eigen::VectorXd::Unit(10, 9), 0.2, 0.5)},
          friction::Force{0.3, {{.amplitude = amplitude}}},
          {},
          Eigen::MatrixXd(Eigen::VectorXd::Unit(10, 9))};
}

TrigonometricPolynomial random_motion(unsigned seed, Eigen::Index H) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  TrigonometricPolynomial out{Eigen::VectorXcd(H + 1)};
  for (Eigen::Index k = 0; k <= H; ++k)
    out.phasors[k] =
        std::complex<double>(normal(random), k == 0 ? 0.0 : normal(random)) / (1.0 + static_cast<double>(k));
  return out;
}

/// Elements that slide to both sides alike, to one side more easily, and not at all.
const std::vector<BalancedJenkins> kElements = {
    {.stiffness = 2.0, .upper = 0.7, .lower = 0.7},
    {.stiffness = 2.0, .upper = 0.7, .lower = 0.3},
    {.stiffness = 2.0, .upper = 20.0, .lower = 20.0},
};

/// Coefficients of a Jenkins element under a cos θ, a > r = limit/K: it sticks from each extreme to acos(1 − 2r/a)
/// behind it. Integrals of the two straight lines by hand; the first order is Masing's, π a s₁ = 4 limit (a − r) the
/// loop's area.
Eigen::VectorXcd under_cosine(double K, double limit, double a, Eigen::Index H) {
  const double r = limit / K, onset = std::acos(1.0 - 2.0 * r / a);
  Eigen::VectorXcd out = Eigen::VectorXcd::Zero(H + 1);
  out[1] = {-K * a / pi * (onset - 0.5 * std::sin(2.0 * onset)), -4.0 * limit * (a - r) / (pi * a)};
  for (Eigen::Index j = 3; j <= H; j += 2) {
    const double k = static_cast<double>(j), up = k + 1.0, down = k - 1.0;
    const double cosine =
        (a - 2.0 * r) * std::sin(k * onset) / k - 0.5 * a * (std::sin(down * onset) / down + std::sin(up * onset) / up);
    const double sine = (a - r) * (1.0 - std::cos(k * onset)) / k + r * (std::cos(k * onset) + 1.0) / k -
                        0.5 * a * ((1.0 - std::cos(up * onset)) / up + (1.0 - std::cos(down * onset)) / down);
    out[j] = 2.0 * K / pi * std::complex<double>(cosine, -sine);
  }
  return out;
}

TrigonometricPolynomial cosine_motion(double a, Eigen::Index H) {
  TrigonometricPolynomial y{Eigen::VectorXcd::Zero(H + 1)};
  y.phasors[1] = a;
  return y;
}

TEST(JenkinsForce, UnderACosineIsTheClosedForm) {
  for (const double a : {0.31, 0.5, 1.7, 40.0}) {
    const BalancedForce own = BalancedJenkins{1.5, 0.45, 0.45}.force(cosine_motion(a, 13), 1.0, kExact, 13);
    EXPECT_LT((own.phasors - under_cosine(1.5, 0.45, a, 13)).cwiseAbs().maxCoeff(), 1e-14 * std::max(1.0, a));
    EXPECT_EQ(own.switches, 4);
    EXPECT_FALSE(own.stuck);
  }
}

TEST(JenkinsForce, BelowItsLimitIsASpring) {
  const BalancedForce own = BalancedJenkins{1.5, 0.45, 0.45}.force(cosine_motion(0.29, 5), 1.0, kExact, 5);
  EXPECT_TRUE(own.stuck);
  EXPECT_LT((own.phasors + 1.5 * cosine_motion(0.29, 5).phasors).norm(), 1e-15);
  EXPECT_LT((own.jacobian + 1.5 * Eigen::MatrixXd::Identity(11, 11)).norm(), 1e-14);
}

TEST(JenkinsForce, ThatNeverSlidesHasItsSliderNearestToZero) {
  // Mean 2, half range 0.1, limit 0.3 at K = 1: sliders from 2.1 − 0.3 to 1.9 + 0.3 hold; 1.8 is taken.
  TrigonometricPolynomial y = cosine_motion(0.1, 3);
  y.phasors[0] = 2.0;
  const BalancedForce own = BalancedJenkins{1.0, 0.3, 0.3}.force(y, 1.0, kExact, 3);
  EXPECT_TRUE(own.stuck);
  EXPECT_NEAR(own.phasors[0].real(), 1.8 - 2.0, 1e-15);
}

TEST(JenkinsForce, WithMinorLoopsIsThatOfAMarchedStopOperator) {
  // Rectangle rule over a million steps, exact to its square but for the two corners of each slide: some 1e-12.
  constexpr int kSteps = 1000000;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const BalancedJenkins& law = kElements[seed % 2];
    const Eigen::Index H = seed < 3 ? 2 : 3 * static_cast<Eigen::Index>(seed);
    const TrigonometricPolynomial y = random_motion(seed, H);
    Eigen::VectorXcd marched = Eigen::VectorXcd::Zero(H + 1);
    double force = 0.0, before = y.at(0.0).y;
    for (int n = 1; n <= 2 * kSteps; ++n) {
      const double theta = 2.0 * pi * (n % kSteps) / kSteps, here = y.at(theta).y;
      force = std::clamp(force - law.stiffness * (here - before), -law.lower, law.upper);
      before = here;
      if (n <= kSteps) continue;
      for (Eigen::Index k = 0; k <= H; ++k)
        marched[k] += (k == 0 ? 1.0 : 2.0) / kSteps * force * std::polar(1.0, -static_cast<double>(k) * theta);
    }
    const BalancedForce own = law.force(y, 1.0, kExact, H);
    EXPECT_LT((own.phasors - marched).norm(), 1e-9 * marched.norm()) << "seed " << seed;
    EXPECT_GE(own.switches, 4);
  }
  const std::vector<JenkinsSpan> spans = kElements[0].spans(random_motion(6, 18));
  const auto slides = std::ranges::count_if(spans, [](const JenkinsSpan& span) { return span.slide != 0; });
  EXPECT_GT(std::ssize(zeros(derivative(random_motion(6, 18)))), slides) << "some turn without a slide: minor loops";
}

TEST(JenkinsForce, JacobianIsExactWithSlidesWithoutAndWithMinorLoops) {
  // Central differences, each coefficient by itself.
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const BalancedJenkins& law : kElements) {
      const Eigen::Index H = 2 * static_cast<Eigen::Index>(seed);
      const TrigonometricPolynomial y = random_motion(seed, H);
      const auto moved = [&](Eigen::Index i, double step) {
        TrigonometricPolynomial there = y;
        if (i <= H)
          there.phasors[i] += step;
        else
          there.phasors[i - H] -= std::complex<double>(0.0, step);
        const Eigen::VectorXcd phasors = law.force(there, 1.0, kExact, H).phasors;
        Eigen::VectorXd out(2 * H + 1);
        out << phasors.real(), -phasors.imag().tail(H);
        return out;
      };
      Eigen::MatrixXd rate(2 * H + 1, 2 * H + 1);
      for (Eigen::Index i = 0; i <= 2 * H; ++i)
        rate.col(i) = fixtures::slope([&](double step) { return moved(i, step); }, 1e-4);
      EXPECT_LT((law.force(y, 1.0, kExact, H).jacobian - rate).norm(), 1e-8 * rate.norm()) << "seed " << seed;
    }
}

TEST(JenkinsForce, IsTheLimitOfManySamples) {
  for (const BalancedJenkins& law : kElements) {
    const TrigonometricPolynomial y = random_motion(3, 9);
    const BalancedForce exact = law.force(y, 1.0, kExact, 9);
    const auto off = [&](int samples) { return (law.force(y, 1.0, samples, 9).phasors - exact.phasors).norm(); };
    EXPECT_LT(off(8000), 1e-5 * exact.phasors.norm());
    if (!exact.stuck) {  // a turning point between samples is missed by the square of their distance
      EXPECT_LT(off(8000), 0.1 * off(1000));
    }
  }
}

TEST(JenkinsForce, OfSeveralElementsIsTheSumOfTheirClosedForms) {
  constexpr double a = 1.0;
  Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(10), closed = sum;
  for (const double limit : {0.1, 0.25, 0.4, 0.9}) {
    sum += BalancedJenkins{1.0, limit, limit}.force(cosine_motion(a, 9), 1.0, kExact, 9).phasors;
    closed += under_cosine(1.0, limit, a, 9);
  }
  EXPECT_LT((sum - closed).norm(), 1e-14);
}

TEST(JenkinsBalance, ConvergesFromNothingWithFewSteps) {
  // It slides from 0.3 |impedance| = 0.408 on, as JenkinsBranch finds.
  for (const double amplitude : {0.1, 0.45, 0.7, 3.0})
    for (const int H : {1, 9, 49}) {
      const Balance own = balance(rubbed_mass(amplitude), {.harmonics = H});
      ASSERT_TRUE(own.converged) << own.message;
      EXPECT_LE(own.iterations, 12);
      EXPECT_EQ(own.switches, amplitude < 0.408 ? 0 : 4);
      EXPECT_EQ(own.stuck, amplitude < 0.408 ? 1 : 0);
      const Balance next = balance(rubbed_mass(1.01 * amplitude), {.harmonics = H, .guess = own.displacement});
      EXPECT_TRUE(next.converged);
      EXPECT_LE(next.iterations, 5);
    }
}

TEST(JenkinsBalance, ErrorFallsWithTheThirdPowerOfTheOrder) {
  // The force is continuous and its slope jumps, y_k ~ k⁻⁴, the sum of what is left out ~ H⁻³: over a factor of 8.
  const auto error = [](int H) {
    const Certificate own = certify(rubbed_mass(0.7), balance(rubbed_mass(0.7), {.harmonics = H}));
    EXPECT_TRUE(own.behind) << own.verdict;
    EXPECT_EQ(own.found.orbit.word, "+ 0 - 0");
    return own.relative;
  };
  EXPECT_NEAR(std::log(error(15) / error(121)) / std::log(121.0 / 15.0), 3.0, 0.5);
}

TEST(JenkinsBalance, OfAChainIsTheOrbitThatShootingFinds) {
  // Shooting from a run of its own, that no balance begins.
  const HybridSystem system = rubbed_chain();
  const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 40.0));
  double before = 1.0;
  for (const auto& [H, error] : {std::pair{9, 2e-3}, std::pair{25, 1e-4}, std::pair{49, 1e-5}}) {
    const Balance own = balance(system, {.harmonics = H});
    ASSERT_TRUE(own.converged) << own.message;
    const std::vector<double> off = true_errors(own, OrbitSeries(system, orbit));
    EXPECT_LT(*std::ranges::max_element(off), error);
    EXPECT_LT(off.back(), before);
    before = off.back();
    EXPECT_EQ(own.switches, orbit.crossings);
    EXPECT_LT((state_of(system, own).internal - orbit.start.internal).norm(), 2.0 * error);
  }
}

TEST(JenkinsBalance, OrderIsChosenByTheTrueError) {
  const CertifiedBalance chosen = balance_to_error(rubbed_mass(0.7), {}, 1e-6);
  ASSERT_TRUE(chosen.met);
  EXPECT_LE(chosen.certificate.relative, 1e-6);
  EXPECT_GT(chosen.trials[chosen.trials.size() - 2].error, 1e-6);
}

TEST(JenkinsBalance, BesideAStopIsAnExactOrbitToo) {
  // Two masses, friction on the first and a stop before the second.
  const friction::Clearance stop{{}, friction::Stop{.stiffness = 3.0, .gap = 0.5}, friction::ContactLoss::kGap};
  const HybridSystem system(fem::masses({.mass = {1.0, 1.0}, .links = {{0, 1, 1.0, 0.05}, {1, 2, 1.0, 0.05}}}),
                            {jenkins(Eigen::Vector2d(1.0, 0.0), 0.2, 2.0), {Eigen::Vector2d(0.0, 1.0), stop}},
                            friction::Force{0.5, {{.amplitude = 0.6}}}, {}, Eigen::Vector2d(0.0, 1.0));
  const Balance own = balance(system, {.harmonics = 61});
  ASSERT_TRUE(own.converged) << own.message;
  const Certificate certificate = certify(system, own);
  EXPECT_TRUE(certificate.behind) << certificate.verdict;
  EXPECT_LT(certificate.relative, 1e-4);
  EXPECT_EQ(own.switches, certificate.found.orbit.crossings);
}

TEST(JenkinsBalance, OfElementsOnOneDegreeOfFreedomIsThatOfTheirSum) {
  const auto on = [](const std::vector<std::pair<double, double>>& elements) {
    std::vector<friction::Contact> contacts;
    for (const auto& [limit, stiffness] : elements)
      contacts.push_back(jenkins(Eigen::VectorXd::Ones(1), limit, stiffness));
    const HybridSystem one = rubbed_mass(0.7);
    return HybridSystem(one.structure(), contacts, one.drive(), {}, one.force_directions());
  };
  const Balance whole = balance(rubbed_mass(0.7), {.harmonics = 25});
  const Balance parts = balance(on({{0.12, 0.4}, {0.18, 0.6}}), {.harmonics = 25});
  ASSERT_TRUE(parts.converged) << parts.message;
  EXPECT_LT((parts.displacement[1].cosine - whole.displacement[0].cosine).norm(), 1e-11);
  EXPECT_LT((parts.force[0].sine + parts.force[1].sine - whole.force[0].sine).norm(), 1e-11);
  const HybridSystem iwan = on({{0.05, 0.3}, {0.1, 0.3}, {0.2, 0.4}});
  const Balance joint = balance(iwan, {.harmonics = 49});
  EXPECT_EQ(balance_equations(iwan, joint).residual.size(), 2 * 49 + 1);  // one displacement is solved for once
  const Certificate certificate = certify(iwan, joint);
  ASSERT_TRUE(certificate.behind) << certificate.verdict;
  EXPECT_LT(certificate.relative, 1e-6);
  EXPECT_EQ(certificate.found.orbit.crossings, 12);
}

TEST(JenkinsBalance, MeetsItsErrorBesideAFamilyOfOrbits) {
  // The last element never slides and may be stretched by any mean, and each order has an orbit of its own behind it.
  const HybridSystem one = rubbed_mass(0.7);
  const HybridSystem joint(one.structure(),
                           {jenkins(Eigen::VectorXd::Ones(1), 0.05, 0.3), jenkins(Eigen::VectorXd::Ones(1), 0.1, 0.3),
                            jenkins(Eigen::VectorXd::Ones(1), 50.0, 0.4)},
                           one.drive(), {}, one.force_directions());
  for (const double error : {1e-4, 1e-6}) {
    const CertifiedBalance found = balance_to_error(joint, {}, error, 400);
    ASSERT_TRUE(found.met) << found.certificate.verdict;
    EXPECT_GT(found.certificate.found.orbit.family.cols(), 0);
    // The least sufficient order, each by itself.
    int least = found.approximation.harmonics;
    for (int H = 3; H < least; ++H)
      if (certify(joint, balance(joint, {.harmonics = H})).relative <= error) least = H;
    EXPECT_LE(found.approximation.harmonics, 1.5 * least);
  }
}

TEST(JenkinsBalance, WhereNothingSlidesIsTheLinearResponseOfTheSpring) {
  const Balance own = balance(rubbed_mass(0.1), {.harmonics = 5});
  const std::complex<double> impedance(2.0 - 0.64, 0.05 * 0.8);
  EXPECT_NEAR(own.displacement[0].amplitude()[1], 0.1 / std::abs(impedance), 1e-14);
  EXPECT_EQ(own.stuck, 1);
  const Certificate certificate = certify(rubbed_mass(0.1), own);
  EXPECT_TRUE(certificate.behind) << certificate.verdict;
  EXPECT_LT(certificate.relative, 1e-9);
}

TEST(JenkinsBalance, SlidesUnderAMeanLoadWithBothLimits) {
  // Sliding both ways the element holds no mean: that of the force is the exact orbit's, and the contact spring's
  // stretch at time 0 too.
  const HybridSystem system = rubbed_mass(0.7, 0.8, Eigen::VectorXd::Constant(1, 0.2));
  const Balance own = balance(system, {.harmonics = 75});
  ASSERT_TRUE(own.converged);
  const Certificate certificate = certify(system, own);
  ASSERT_TRUE(certificate.behind) << certificate.verdict;
  EXPECT_LT(certificate.relative, 1e-5);
}

TEST(JenkinsBalance, OfAFloatingMassIsOneOfAFamily) {
  const HybridSystem system(fem::masses({}), {jenkins(Eigen::VectorXd::Ones(1), 0.3, 1.0)},
                            friction::Force{0.5, {{.amplitude = 1.0}}}, {}, Eigen::MatrixXd::Ones(1, 1));
  const Balance own = balance(system, {.harmonics = 9});
  ASSERT_TRUE(own.converged) << own.message;
  EXPECT_EQ(own.switches, 4);
  EXPECT_TRUE(own.family);
  const Balance held = balance(rubbed_mass(0.7), {.harmonics = 9});
  EXPECT_FALSE(held.family);
}

TEST(JenkinsBranch, BeginsToSlideWhereTheLinearResponseReachesTheLimit) {
  // |y| K = limit with y the response of mass, spring and contact spring: amplitude = 0.3 |impedance|.
  const dynamics::SystemFamily family = [](double amplitude) { return rubbed_mass(amplitude); };
  const Balance first = balance(family(0.2), {.harmonics = 9});
  const Branch branch = continue_balance(family, first, 0.2, {.from = 0.2, .to = 1.0});
  EXPECT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  ASSERT_EQ(branch.special.size(), 1U);
  EXPECT_EQ(branch.special[0].kind, SpecialKind::kStickChange);
  EXPECT_NEAR(branch.special[0].parameter, 0.3 * std::abs(std::complex<double>(2.0 - 0.64, 0.05 * 0.8)), 1e-8);
  for (const BranchPoint& point : branch.points) {
    EXPECT_EQ(point.orbit.stability, Stability::kUnknown);
    EXPECT_EQ(point.orbit.multipliers.size(), 0);
  }
  Branch certified = branch;
  const BranchCertificate certificate = certify_branch(family, certified, 5);
  EXPECT_EQ(certificate.behind, certificate.certified);
  EXPECT_LT(certificate.worst, 1e-2);
}

TEST(JenkinsBranch, PassesTheResonanceThatFrictionShapes) {
  // The branch over the frequency ends on the balance found there from nothing.
  const dynamics::SystemFamily family = [](double omega) { return rubbed_mass(0.5, omega); };
  const Balance first = balance(family(0.5), {.harmonics = 15});
  const Branch branch = continue_balance(family, first, 0.5, {.from = 0.5, .to = 2.0});
  ASSERT_EQ(branch.end, BranchEnd::kRange) << branch.reason;
  const Balance last = balance(family(2.0), {.harmonics = 15});
  const Balance& reached = *branch.points.back().balance;
  EXPECT_LT((reached.displacement[0].cosine - last.displacement[0].cosine).norm(), 1e-9);
  EXPECT_LT((reached.displacement[0].sine - last.displacement[0].sine).norm(), 1e-9);
}

TEST(JenkinsBalance, RefusesWhatItCannotHold) {
  const HybridSystem system = rubbed_mass(0.7);
  const auto with = [&](friction::CompliantCoulomb law, friction::NormalLoad load) {
    friction::Contact contact = system.contacts()[0];
    contact.law = law;
    contact.normal_load = load;
    return system.with_laws({contact});
  };
  const auto refusal = [](const HybridSystem& refused) -> std::string {
    try {
      (void)balance(refused);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(with({0.4, 0.3, 1.0}, 1.0)), testing::HasSubstr("contact.0.mu_s"));
  EXPECT_THAT(refusal(with({0.3, 0.3, 1.0}, {1.0, 0.1})), testing::HasSubstr("contact.0.normal_load"));
  EXPECT_THAT(refusal(system.with_drive(friction::Belt::constant(0.1))), testing::HasSubstr("drive.kind"));
  EXPECT_THROW((void)hill_multipliers(system, balance(system)), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
