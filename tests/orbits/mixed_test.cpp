// The mixed method: its Jacobian against differences, Den Hartog's closed form through a structure that nothing moves,
// and exact orbits by shooting on the whole structure.
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/orbits/mixed/certificate.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/scene/scene.hpp>
#include "fixtures/cantilever_beam.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/stopping_oscillator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using fixtures::StoppingOscillator;
using ::testing::HasSubstr;

friction::Contact at_mass(int n, int mass, friction::Law law) {
  return {Eigen::VectorXd::Unit(n, mass), std::move(law)};
}

/// A chain that is pushed at its first mass.
HybridSystem pushed_chain(int n, std::vector<friction::Contact> contacts, double omega = 0.6, double damping = 0.05,
                          double amplitude = 1.0) {
  return {fem::chain({.masses = n, .damping = damping}),
          std::move(contacts),
          friction::Force{omega, {{.amplitude = amplitude, .phase = 0.3}}},
          {},
          Eigen::MatrixXd(Eigen::VectorXd::Unit(n, 0))};
}

/// Rigid friction that sticks and slips, in the middle of ten masses.
HybridSystem rubbed_ten() { return pushed_chain(10, {at_mass(10, 5, friction::Coulomb{0.3, 0.24})}); }

PeriodicOrbit exact_orbit(const HybridSystem& system) {
  return find_orbit(system, settle_guess(system, system.rest(), 200.0));
}

/// sup |y_mixed − y_exact| over all contacts on 4,000 points of the period.
double contact_error(const MixedOrbit& mixed, const HybridSystem& system, const PeriodicOrbit& exact) {
  constexpr int kLooks = 4000;
  const OrbitSeries own(*mixed.near_system, mixed.near_orbit), other(system, exact);
  double error = 0.0;
  for (int k = 0; k < kLooks; ++k) {
    const double t = own.start() + own.period() * k / kLooks;
    error = std::max(error, (own.at(t) - other.at(t)).head(own.contacts()).lpNorm<Eigen::Infinity>());
  }
  return error;
}

void expect_jacobian(const HybridSystem& system, const MixedOptions& options) {
  const MixedOrbit mixed = mixed_orbit(system, options);
  ASSERT_TRUE(mixed.converged) << mixed.message;
  // Beside the orbit, where nothing is zero.
  fixtures::Draws random(7);
  dynamics::State start = mixed.near_orbit.start;
  start.modes.clear();
  const double size = start.q.lpNorm<Eigen::Infinity>();
  start.internal *= 0.5;  // off the limit
  for (double& q : start.q) q += 0.02 * size * random.uniform(-1.0, 1.0);
  for (double& v : start.v) v += 0.02 * size * random.uniform(-1.0, 1.0);
  const Eigen::Index block = 2 * options.harmonics + 1;
  Eigen::VectorXd coupling(mixed.coupled * block);
  for (double& value : coupling) value = 0.1 * size * random.uniform(-1.0, 1.0);
  for (Eigen::Index b = 0; b < mixed.coupled; ++b) coupling[b * block + 1] += 0.5 * size;
  const MixedEquations at = mixed_equations(system, options, start, coupling);
  const Eigen::Index N = at.point.size() - coupling.size(), n = start.q.size();
  const auto residual_at = [&](Eigen::Index i, double step) -> Eigen::VectorXd {
    const Eigen::VectorXd x = at.point + step * at.scale[i] * Eigen::VectorXd::Unit(at.point.size(), i);
    dynamics::State moved = start;
    moved.q = x.head(n);
    moved.v = x.segment(n, n);
    moved.internal = x.segment(2 * n, N - 2 * n);
    const MixedEquations there = mixed_equations(system, options, moved, x.tail(coupling.size()));
    return there.residual.cwiseProduct(there.scale).cwiseQuotient(at.scale);
  };
  constexpr double kStep = 1e-4;
  for (Eigen::Index i = 0; i < at.point.size(); ++i) {
    const Eigen::VectorXd column = (8.0 * (residual_at(i, kStep) - residual_at(i, -kStep)) -
                                    (residual_at(i, 2.0 * kStep) - residual_at(i, -2.0 * kStep))) /
                                   (12.0 * kStep);
    EXPECT_LT((column - at.jacobian.col(i)).lpNorm<Eigen::Infinity>(),
              1e-7 * std::max(1.0, at.jacobian.col(i).lpNorm<Eigen::Infinity>()))
        << i;
  }
}

TEST(Mixed, JacobianIsTheResidualsDerivative) {
  const friction::Clearance stops{.left = friction::Stop{8.0, 0.3, 0.2}, .right = friction::Stop{5.0, 0.0, 0.3}};
  {
    SCOPED_TRACE("rigid friction");
    expect_jacobian(rubbed_ten(), {.harmonics = 3});
  }
  {
    SCOPED_TRACE("rigid friction, neighbours in the time domain");
    expect_jacobian(rubbed_ten(), {.harmonics = 3, .reach = 1});
  }
  {
    SCOPED_TRACE("a contact spring beside a stop");
    expect_jacobian(pushed_chain(6, {at_mass(6, 1, friction::CompliantCoulomb{0.2, 0.2, 4.0}), at_mass(6, 4, stops)}),
                    {.harmonics = 4});
  }
  {
    SCOPED_TRACE("two stops, a subharmonic's base");
    expect_jacobian(pushed_chain(5, {at_mass(5, 2, stops)}), {.order = 2, .harmonics = 6});
  }
}

/// Den Hartog's mass hangs by a spring on one of 1e12 times its own, which the force moves as if alone: X cos ωt. Then
/// the spring pushes with k_c X cos ωt, all of it through the harmonics.
HybridSystem pushed_through_a_rest(const StoppingOscillator& o) {
  constexpr double kHeavy = 1e12, kCoupling = 1.1;
  const double way = o.push / kCoupling, omega = o.omega();
  const Eigen::MatrixXd M = Eigen::Vector2d(o.mass, kHeavy).asDiagonal();
  Eigen::MatrixXd K{{o.stiffness, -kCoupling}, {-kCoupling, kCoupling}};
  return {fem::Structure(M, Eigen::MatrixXd(Eigen::MatrixXd::Zero(2, 2)), K),
          {{Eigen::Vector2d::UnitX(), friction::Coulomb{0.5, 0.5}, o.limit() / 0.5}},
          friction::Force{omega,
                          {{.amplitude = way * (kCoupling - kHeavy * omega * omega), .phase = 0.5 * std::numbers::pi}}},
          {},
          Eigen::MatrixXd(Eigen::Vector2d::UnitY())};
}

TEST(Mixed, DenHartogsClosedFormThroughTheRest) {
  for (const auto& [friction, ratio, stops] :
       {std::tuple{0.5, 0.45, 1U}, std::tuple{0.2, 0.17, 1U}, std::tuple{0.3, 0.22, 2U}, std::tuple{0.5, 0.07, 4U}}) {
    SCOPED_TRACE(friction);
    const StoppingOscillator o{.friction = friction, .ratio = ratio};
    const MixedOrbit mixed = mixed_orbit(pushed_through_a_rest(o), {.harmonics = 3});
    ASSERT_TRUE(mixed.converged) << mixed.message;
    EXPECT_EQ(mixed.near.size(), 1U);
    const auto slides = o.cycle();
    ASSERT_EQ(slides.size(), stops);
    ASSERT_EQ(mixed.near_orbit.events.size(), 4U * stops);
    std::vector<double> found, wanted;
    for (const dynamics::Event& e : mixed.near_orbit.events) found.push_back(e.displacement);
    for (const auto& s : slides) wanted.insert(wanted.end(), {s.from, s.to, -s.from, -s.to});
    std::ranges::sort(found);
    std::ranges::sort(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-10) << i;
  }
}

TEST(Mixed, OfTenMassesConvergesToTheirOrbit) {
  const HybridSystem system = rubbed_ten();
  const PeriodicOrbit exact = exact_orbit(system);
  EXPECT_EQ(exact.word, "+ 0 - 0");
  std::vector<double> error;
  for (const int harmonics : {3, 9, 25}) {
    const MixedOrbit mixed = mixed_orbit(system, {.harmonics = harmonics});
    ASSERT_TRUE(mixed.converged) << mixed.message;
    EXPECT_EQ(mixed.near_orbit.word, exact.word);
    error.push_back(contact_error(mixed, system, exact));
  }
  // What the rest's harmonics beyond H pull with falls as H^-4, the motion from it faster
  // (docs/theory/mixed-orbits.md).
  EXPECT_LT(error[0], 2e-3);
  EXPECT_GT(std::log(error[0] / error[1]) / std::log(9.0 / 3.0), 3.5);
  EXPECT_GT(std::log(error[1] / error[2]) / std::log(25.0 / 9.0), 3.5);
  // Farther from the contact motions are smoother.
  EXPECT_LT(contact_error(mixed_orbit(system, {.harmonics = 9, .reach = 2}), system, exact), 1e-10);
}

TEST(Mixed, KnowsTheMotionOfTheRest) {
  const HybridSystem system = rubbed_ten();
  const PeriodicOrbit exact = exact_orbit(system);
  const MixedOrbit mixed = mixed_orbit(system, {.harmonics = 25});
  const Spectrum expected = orbit_spectrum(system, exact, 25, Eigen::MatrixXd::Identity(10, 10));
  for (int k = 0; k <= 25; ++k)
    for (int i = 0, next = 0; i < 10; ++i) {
      if (i == 5) continue;
      const Harmonics& own = expected.row_displacement[static_cast<std::size_t>(i)];
      EXPECT_LT(std::abs(mixed.rest(next++, k) - std::complex<double>(own.cosine[k], -own.sine[k])), 1e-6);
    }
  // So is its state, from where shooting has next to nothing to do.
  const ShootingResult shot = shoot(system, state_of(system, mixed));
  ASSERT_TRUE(shot.converged());
  EXPECT_LT(shot.orbit.residuals.front(), 1e-5);
  EXPECT_EQ(shot.orbit.word, exact.word);
}

TEST(Mixed, WithoutARestIsShooting) {
  const HybridSystem system = StoppingOscillator{.friction = 0.3, .ratio = 0.22}.system();
  const MixedOrbit mixed = mixed_orbit(system, {.harmonics = 1});
  ASSERT_TRUE(mixed.converged) << mixed.message;
  EXPECT_EQ(mixed.coupled, 0);
  EXPECT_EQ(mixed.rest.rows(), 0);
  EXPECT_LT(contact_error(mixed, system, exact_orbit(system)), 1e-10);
}

TEST(Mixed, OverThreePeriodsOfTheDriveIsTheSame) {
  const HybridSystem system = rubbed_ten();
  const MixedOrbit one = mixed_orbit(system, {.harmonics = 5}),
                   three = mixed_orbit(system, {.order = 3, .harmonics = 15});
  ASSERT_TRUE(one.converged && three.converged);
  for (Eigen::Index k = 0; k <= 15; ++k) {
    const Eigen::VectorXcd expected =
        k % 3 == 0 ? Eigen::VectorXcd(one.rest.col(k / 3)) : Eigen::VectorXcd::Zero(9).eval();
    EXPECT_LT((three.rest.col(k) - expected).lpNorm<Eigen::Infinity>(), 1e-9) << k;
  }
}

TEST(Mixed, OfABeamWithRigidFriction) {
  // Consistent masses couple accelerations too, which jump with friction: the order of convergence is lower.
  const fem::Beam beam(fixtures::stocky_beam(3));
  const Eigen::MatrixXd K = fem::to_dense(beam.structure().K()), M = fem::to_dense(beam.structure().M());
  const double first = std::sqrt(
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M, Eigen::EigenvaluesOnly).eigenvalues()[0]);
  constexpr double kPush = 1000.0;
  const HybridSystem system(fem::Structure(M, Eigen::MatrixXd(0.02 / first * K), K),
                            {{beam.displacement_row(0.5), friction::Coulomb{0.3, 0.3}, 0.5 * kPush}},
                            friction::Force{0.4 * first, {{.amplitude = kPush}}}, {},
                            Eigen::MatrixXd(beam.displacement_row(0.25)));
  const PeriodicOrbit exact = exact_orbit(system);
  EXPECT_EQ(exact.word, "+ 0 - 0");
  const double size = contact_amplitudes(system, exact).front().alternating;
  std::vector<double> error;
  for (const int harmonics : {5, 25}) {
    const MixedOrbit mixed = mixed_orbit(system, {.harmonics = harmonics, .reach = 1});
    ASSERT_TRUE(mixed.converged) << mixed.message;
    EXPECT_EQ(mixed.coupled, 2);
    error.push_back(contact_error(mixed, system, exact) / size);
  }
  EXPECT_LT(error[0], 0.1);  // 0.03 measured, 4.4e-4 at 25
  EXPECT_GT(std::log(error[0] / error[1]) / std::log(25.0 / 5.0), 2.0);
}

TEST(Mixed, RandomChainsConvergeFromNothing) {
  // Of 1,000 such with 9 harmonics 989 converged from nothing, and one had no orbit behind.
  std::vector<int> lost, bare;
  constexpr int kScenes = 60;
  for (int seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    fixtures::Draws random(static_cast<std::uint64_t>(seed));
    const int n = random.integer(3, 12), first = random.integer(0, n - 1);
    std::vector<friction::Contact> contacts;
    for (int c = 0; c < (random.chance(0.4) ? 2 : 1); ++c) {
      const double mu = random.uniform(0.05, 0.8), mu_s = random.chance(0.5) ? mu : mu * random.uniform(1.0, 1.4);
      friction::Law law = friction::Coulomb{mu_s, mu};
      if (random.chance(0.25)) law = friction::CompliantCoulomb{mu_s, mu, random.uniform(1.0, 30.0)};
      if (random.chance(0.25)) {
        friction::Clearance stops;
        stops.right = friction::Stop{random.uniform(1.0, 20.0), random.uniform(0.0, 0.5), random.uniform(0.05, 0.8)};
        if (random.chance(0.6)) stops.left = stops.right;
        law = stops;
      }
      contacts.push_back(at_mass(n, (first + 2 * c) % n, std::move(law)));
    }
    const HybridSystem system = pushed_chain(n, std::move(contacts), random.uniform(0.2, 2.2),
                                             random.uniform(0.02, 0.2), random.uniform(0.5, 2.0));
    const MixedOrbit mixed = mixed_orbit(system, {.harmonics = 15});
    if (!mixed.converged) {
      lost.push_back(seed);
      continue;
    }
    const Certificate certificate = certify(system, mixed);
    if (!certificate.behind || certificate.relative > 0.01) bare.push_back(seed);
  }
  EXPECT_LE(lost.size(), 1U) << ::testing::PrintToString(lost);
  EXPECT_LE(bare.size(), 1U) << ::testing::PrintToString(bare);
}

TEST(Mixed, ItsCertificateIsTheDistanceFromTheOrbit) {
  const HybridSystem system = rubbed_ten();
  const PeriodicOrbit exact = exact_orbit(system);
  const MixedOrbit mixed = mixed_orbit(system, {.harmonics = 5});
  const Certificate certificate = certify(system, mixed);
  ASSERT_TRUE(certificate.behind);
  const double error = contact_error(mixed, system, exact);
  EXPECT_NEAR(certificate.error[0], error, 0.01 * error);
  EXPECT_NEAR(certificate.relative, error / contact_amplitudes(system, exact).front().alternating, 0.01 * error);
  EXPECT_EQ(certificate.found.orbit.stability, Stability::kStable);
  EXPECT_THAT(certificate.verdict, HasSubstr("true error"));
}

/// The least order whose true error is at most this, all orders one by one, each from the one before.
int least_order(const HybridSystem& system, double error) {
  MixedOptions options{.harmonics = 1};
  for (; options.harmonics < 100; ++options.harmonics) {
    const MixedOrbit own = mixed_orbit(system, options);
    if (!own.converged) continue;
    options.guess = MixedStart{own.near_orbit.start, own.coupling};
    const Certificate certificate = certify(system, own);
    if (certificate.behind && certificate.relative <= error) break;
  }
  return options.harmonics;
}

TEST(Mixed, OrderIsChosenByTheTrueError) {
  const HybridSystem springs =
      scene::build_system(scene::load_scene(SLIPMODE_SOURCE_DIR "/datasets/jenkins_chain/scene.toml"));
  const HybridSystem den_hartog = StoppingOscillator{.friction = 0.3, .ratio = 0.22}.system();
  const HybridSystem through = pushed_through_a_rest(StoppingOscillator{.friction = 0.5, .ratio = 0.45});
  for (const double error : {1e-3, 1e-6, 1e-9}) {
    SCOPED_TRACE(error);
    for (const HybridSystem& system : {springs, rubbed_ten(), den_hartog}) {
      const CertifiedMixed chosen = mixed_to_error(system, {}, error);
      ASSERT_TRUE(chosen.met) << chosen.certificate.verdict;
      EXPECT_LE(chosen.certificate.relative, error);
      const int least = least_order(system, error);
      EXPECT_GE(chosen.approximation.harmonics, least);
      EXPECT_LE(chosen.approximation.harmonics, 1.5 * least);
      EXPECT_EQ(chosen.trials.back().harmonics, chosen.approximation.harmonics);
      EXPECT_EQ(chosen.trials.back().error, chosen.certificate.relative);
    }
  }
  EXPECT_EQ(mixed_to_error(den_hartog, {}, 1e-9).approximation.harmonics, 1) << "there is no rest";
  // Known in closed form: the error told is the true one.
  const CertifiedMixed chosen = mixed_to_error(through, {}, 1e-9);
  ASSERT_TRUE(chosen.met) << chosen.certificate.verdict;
  EXPECT_EQ(chosen.approximation.harmonics, 1) << "the rest moves in the first harmonic alone";
}

TEST(Mixed, AnErrorOutOfReachGivesTheBest) {
  const CertifiedMixed found = mixed_to_error(rubbed_ten(), {}, 1e-9, 20);
  EXPECT_FALSE(found.met);
  ASSERT_TRUE(found.certificate.behind);
  for (const OrderTrial& trial : found.trials) EXPECT_LE(found.certificate.relative, trial.error) << trial.harmonics;
  EXPECT_LT(found.certificate.relative, 1e-6);
  EXPECT_EQ(found.trials.back().harmonics, 18);  // 1, 2, ..., 7, 9, 11, 14, 18
  EXPECT_THROW(static_cast<void>(mixed_to_error(rubbed_ten(), {}, 0.0)), InvalidInput);
}

TEST(Mixed, LeastOrderIsTheDrivesAwayFromTheContacts) {
  const HybridSystem one = rubbed_ten();
  const auto driven = [&](Eigen::Index at) {
    return HybridSystem(one.structure(), one.contacts(),
                        friction::Force{0.6, {{.amplitude = 1.0}, {.amplitude = 0.2, .order = 3}}}, {},
                        Eigen::MatrixXd(Eigen::VectorXd::Unit(10, at)));
  };
  EXPECT_EQ(least_harmonics(driven(0), {}), 3);
  EXPECT_EQ(least_harmonics(driven(0), {.order = 2}), 6);
  EXPECT_EQ(least_harmonics(driven(5), {}), 1) << "it acts on the contact's mass";
  const CertifiedMixed chosen = mixed_to_error(driven(0), {}, 1e-3);
  EXPECT_TRUE(chosen.met);
  EXPECT_EQ(chosen.trials.front().harmonics, 3);
}

TEST(Mixed, BeginsFromAGuess) {
  const HybridSystem system = rubbed_ten();
  const MixedOrbit coarse = mixed_orbit(system, {.harmonics = 9}), cold = mixed_orbit(system, {.harmonics = 15});
  ASSERT_TRUE(coarse.converged && cold.converged);
  const MixedOrbit warm =
      mixed_orbit(system, {.harmonics = 15, .guess = MixedStart{coarse.near_orbit.start, coarse.coupling}});
  ASSERT_TRUE(warm.converged) << warm.message;
  EXPECT_LE(warm.iterations, 4);
  EXPECT_LT(warm.iterations, cold.iterations);
  EXPECT_LT((warm.coupling - cold.coupling).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_THROW(static_cast<void>(mixed_orbit(system, {.guess = MixedStart{system.rest(), coarse.coupling}})),
               InvalidInput);
}

std::string refusal(const HybridSystem& system, const MixedOptions& options) {
  try {
    static_cast<void>(mixed_orbit(system, options));
  } catch (const InvalidInput& refused) {
    return refused.what();
  } catch (const NumericalFailure& failure) {
    return failure.what();
  }
  return "none";
}

TEST(Mixed, RefusesWhatItCannotHold) {
  const HybridSystem system = rubbed_ten();
  EXPECT_THAT(refusal(system, {.harmonics = 0}), HasSubstr("harmonics: 0; valid: 1 or more"));
  EXPECT_THAT(refusal(system, {.order = 0}), HasSubstr("order: 0; valid: 1 or more"));
  EXPECT_THAT(refusal(system, {.reach = -1}), HasSubstr("reach: -1; valid: 0 or more"));
  EXPECT_THAT(refusal(system, {.order = 4, .harmonics = 3}), HasSubstr("valid: that or more"));
  EXPECT_THAT(refusal(pushed_chain(4, {at_mass(4, 1, friction::Stribeck{0.5, 0.3, 3.0})}), {}),
              ::testing::AllOf(HasSubstr("contact.0.law"), HasSubstr("by shooting")));
  EXPECT_THAT(refusal(HybridSystem(system.structure(), system.contacts(), friction::Belt::constant(0.2)), {}),
              HasSubstr("needs a force drive"));
  // Two masses between them that nothing holds, and a mode without damping at the second harmonic.
  const auto two = [](double k, double omega) {
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3, 3);
    K.diagonal() = Eigen::Vector3d(1.0, 2.0, k);
    K(0, 1) = K(1, 0) = -0.5;
    return HybridSystem(fem::Structure(I, Eigen::MatrixXd(Eigen::MatrixXd::Zero(3, 3)), K),
                        {at_mass(3, 0, friction::Coulomb{0.2, 0.2})}, friction::Force{omega, {{.amplitude = 1.0}}}, {},
                        Eigen::MatrixXd(Eigen::Vector3d::UnitX()));
  };
  EXPECT_THAT(refusal(two(0.0, 0.7), {}), HasSubstr("floats"));
  EXPECT_THAT(refusal(two(4.0, 1.0), {}), HasSubstr("without damping at harmonic 2"));
  // The same where the pivot is rounding: 3 (0.1)² is not 0.03.
  EXPECT_THAT(refusal(two(0.1 * 0.1 * 9.0, 0.1), {}), HasSubstr("without damping at harmonic 3"));
  EXPECT_THROW(static_cast<void>(mixed_equations(system, {}, system.rest(), Eigen::VectorXd::Zero(3))), InvalidInput);
  EXPECT_THROW(static_cast<void>(state_of(system, MixedOrbit{})), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
