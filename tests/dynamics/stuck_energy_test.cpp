// A contact that sticks on a shaker for many cycles: what goes in by the contact is what damping takes, however much
// stiffer than the structure the contact is. Expected: the closed form of the steady motion, written here in long
// double.
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>
#include <slipmode/fem/modes.hpp>
#include "fixtures/cantilever_beam.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <complex>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using Long = long double;
using Complex = std::complex<Long>;

constexpr double kCycles = 600.0, kRatio = 0.01, kAmplitude = 3e-3;

/// A structure in its natural modes, each with the damping ratio of this file, and the contact's direction there.
struct Modal {
  Eigen::VectorXd omega, direction;
  Eigen::MatrixXd shapes;
};

/// Steady motion stuck to d = A sin Ωt behind a contact spring: λ (1/K_c + H) = d with H = Σ w²/(ω² − Ω² + 2iζωΩ).
struct Steady {
  State start;      ///< at t = 0
  Long loss = 0.0;  ///< mean viscous loss, Ω/2 |λ|² (−Im H)
};

Steady steady_motion(const Modal& m, Long compliance, Long omega) {
  const auto answer = [&](Eigen::Index i) {
    const Long w = m.omega(i);
    return static_cast<Long>(m.direction(i)) / Complex(w * w - omega * omega, 2.0L * kRatio * w * omega);
  };
  Complex H = 0.0L;
  for (Eigen::Index i = 0; i < m.omega.size(); ++i) H += static_cast<Long>(m.direction(i)) * answer(i);
  const Complex force = Complex(0.0L, -static_cast<Long>(kAmplitude)) / (compliance + H);
  Eigen::VectorXd eta(m.omega.size()), rate = eta;
  for (Eigen::Index i = 0; i < eta.size(); ++i) {
    const Complex own = answer(i) * force;
    eta(i) = static_cast<double>(own.real());
    rate(i) = static_cast<double>(-omega * own.imag());
  }
  Steady out{state(m.shapes * eta, m.shapes * rate), -omega / 2.0L * std::norm(force) * H.imag()};
  if (compliance > 0.0L)
    out.start.internal = Eigen::VectorXd::Constant(1, static_cast<double>((force * compliance).real()));
  out.start.modes = {ContactMode::kStick};
  return out;
}

/// @param stiffness  K_c; 0: rigid
void expect_balance(const fem::Structure& structure, const Eigen::VectorXd& direction, double stiffness,
                    double frequency_hz) {
  SCOPED_TRACE(testing::Message() << "K_c = " << stiffness << ", " << frequency_hz << " Hz");
  const fem::Modes modes = fem::natural_modes(structure, structure.size());
  const friction::Shaker shaker{.amplitude = kAmplitude, .frequency_hz = frequency_hz};
  friction::Contact contact{direction, friction::Coulomb{1.0, 1.0}, 1e6};
  if (stiffness > 0.0) contact.law = friction::CompliantCoulomb{1.0, 1.0, stiffness};
  const HybridSystem system(structure, {contact}, shaker);
  const Steady expected = steady_motion({modes.omega, modes.shapes.transpose() * direction, modes.shapes},
                                        stiffness > 0.0 ? 1.0L / stiffness : 0.0L, shaker.omega());
  const SimulateOptions options{.duration = kCycles / frequency_hz, .flow = {.method = FlowMethod::kClosedForm}};
  const Trajectory run = simulate(system, expected.start, options);
  EXPECT_TRUE(run.events.empty());
  EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
  EXPECT_NEAR(run.audit.viscous_loss / static_cast<double>(expected.loss * options.duration), 1.0, 1e-10);
  EXPECT_NEAR(run.audit.drive_work / static_cast<double>(expected.loss * options.duration), 1.0, 1e-10);
  // Set in motion with a jerk a rigid contact would slide first, and a force of 1e6 N would leave nothing but rounding.
  if (stiffness == 0.0) return;
  EXPECT_LT(std::abs(simulate(system, system.rest(), options).audit.residual()), 1e-10);
}

TEST(StuckEnergy, OneMassBalancesBehindAnyContactSpring) {
  const double k = 4.0, m = 0.0155;
  const auto one = [](double value) -> fem::Matrix { return Eigen::MatrixXd::Constant(1, 1, value); };
  const fem::Structure mass(one(m), one(2.0 * kRatio * std::sqrt(k * m)), one(k));
  for (const double stiffness : {1e4, 1e6, 1e8, 1e10})
    for (const double frequency : {0.3, 5.0}) expect_balance(mass, unit(1, 0), stiffness, frequency);
}

TEST(StuckEnergy, TheBeamBalancesBehindAnyContactSpringAndWithoutOne) {
  fem::BeamOptions options = source_beam(40);
  options.tip.extension = 0.064;
  options.damping = fem::ModalRatios{{kRatio}};
  const fem::Beam beam(options);
  const Eigen::VectorXd tip = beam.displacement_row(beam.reach());
  for (const double stiffness : {1e4, 2e4, 1e6, 1e8, 1e10, 0.0})
    for (const double frequency : {5.0, 7.0}) expect_balance(beam.structure(), tip, stiffness, frequency);
}

TEST(StuckEnergy, SeveralContactsBalanceUnderAShakerAndUnderForces) {
  const int n = 6;
  const fem::Structure structure = fem::chain({.masses = n, .damping = 0.01});
  const auto coulomb = [&](int at, friction::Law law) { return friction::Contact{unit(n, at), std::move(law), 1e9}; };
  friction::Force force{.omega = 0.7};
  force.harmonics.push_back({.amplitude = 1.3, .phase = 0.4});
  const std::vector<friction::Contact> contacts{coulomb(1, friction::CompliantCoulomb{1.0, 1.0, 1e5}),
                                                coulomb(3, friction::Coulomb{1.0, 1.0}),
                                                coulomb(5, friction::CompliantCoulomb{1.0, 1.0, 1e4})};
  const HybridSystem shaken(structure, contacts, friction::Shaker{0.5, 0.11, std::numbers::pi / 2.0});
  const HybridSystem forced(structure, contacts, force, {}, unit(n, 0));
  for (const HybridSystem& system : {shaken, forced}) {
    const Trajectory run = simulate(system, system.rest(), {.duration = 2000.0});
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
  }
}

/// Three masses in a row on springs, and dampers of theirs that are no share of mass or stiffness.
struct ThreeMasses {
  Eigen::MatrixXd M = Eigen::Vector3d(0.9, 0.3, 0.5).asDiagonal();
  Eigen::MatrixXd K{{3.0, -1.0, 0.0}, {-1.0, 2.5, -1.2}, {0.0, -1.2, 1.6}};
  Eigen::MatrixXd C = Eigen::Vector3d(0.3, 0.9, 1.3).asDiagonal();

  [[nodiscard]] fem::Structure structure() const { return {fem::Matrix(M), fem::Matrix(C), fem::Matrix(K)}; }
};

TEST(StuckEnergy, AStiffSpringOnAStructureWithDampersIsToldByTheStructure) {
  // Complex modes. A belt pulls the spring of one mass for good. Once free motion has died, q = a t + b with
  // (K + K_c wwᵀ) a = K_c w V, (K + K_c wwᵀ) b = −C a, and w λ = K q + C a.
  const double V = 0.7;
  const ThreeMasses three;
  const Eigen::MatrixXd &K = three.K, &C = three.C;
  const fem::Structure structure = three.structure();
  for (const double spring : {1e3, 1e5, 1e7, 1e9})
    for (const friction::Belt& belt : {friction::Belt::constant(V), friction::Belt::ramp(0.5 * V, V, 0.0, 1.0)}) {
      SCOPED_TRACE(spring);
      const HybridSystem system(structure, {{unit(3, 2), friction::CompliantCoulomb{1.0, 1.0, spring}, 1e9}}, belt);
      const double T = 90.0, way = V * T - (belt.is_constant() ? 0.0 : 0.25 * V);
      const Trajectory run = simulate(system, system.rest(), {.duration = T});
      using Matrix = Eigen::Matrix<Long, 3, 3>;
      using Vector = Eigen::Matrix<Long, 3, 1>;
      Matrix held = K.cast<Long>();
      held(2, 2) += spring;
      const Vector a = held.fullPivLu().solve(Vector(0.0L, 0.0L, static_cast<Long>(spring) * V)),
                   b = held.fullPivLu().solve(Vector(-C.cast<Long>() * a));
      const auto force = static_cast<double>((K.cast<Long>() * (a * (way / V) + b) + C.cast<Long>() * a)(2));
      EXPECT_NEAR(run.final_state.internal(0) * spring / force, 1.0, 1e-13 + 1e-15 * spring);
      EXPECT_LT(std::abs(run.audit.residual()), 1e-12);  // forms under a constant speed, quadrature in the ramp
    }
}

TEST(StuckEnergy, OneOrTwoContactsThatABeltPullsFarBalanceUnderAnyDamping) {
  // 63 m of way behind springs up to 1e8 times the structure's, beside a rigid contact too; modes that are damped each
  // by itself, that damping couples, that hardly decay (the audit is by quadrature then). Rounding of such springs'
  // rows by all of the way left up to 2e-9.
  ThreeMasses three;
  const Eigen::MatrixXd by_springs = 0.1 * three.K, of_masses = three.C,
                        hardly = Eigen::Vector3d(3e-8, 0.0, 1e-8).asDiagonal();
  for (const Eigen::MatrixXd& C : {by_springs, of_masses, hardly}) {
    three.C = C;
    const fem::Structure structure = three.structure();
    for (const double spring : {1e4, 1e6, 1e8}) {
      SCOPED_TRACE(testing::Message() << "K_c = " << spring << ", C =\n" << C);
      const friction::Contact third{unit(3, 2), friction::CompliantCoulomb{1.0, 1.0, spring}, 1e12},
          first{unit(3, 0), friction::CompliantCoulomb{1.0, 1.0, 0.7 * spring}, 1e12},
          rigid{unit(3, 0), friction::Coulomb{1.0, 1.0}, 1e12};
      for (const std::vector<friction::Contact>& contacts :
           {std::vector{third}, std::vector{third, first}, std::vector{rigid, third}}) {
        const HybridSystem system(structure, contacts, friction::Belt::constant(0.7));
        State start = system.rest();
        start.v.setConstant(0.7);
        const Trajectory run = simulate(system, start, {.duration = 90.0});
        EXPECT_TRUE(run.events.empty());
        EXPECT_LT(std::abs(run.audit.residual()), 1e-13 + 1.5e-14 * std::sqrt(spring));
      }
    }
  }
}

TEST(StuckEnergy, ANormalOscillatorBesideAStiffSpringLeavesItItsDigits) {
  // The same with a block that slides on the first mass under the load of an oscillator, N = N₀ + s (k y + c ẏ) − k ζ −
  // c ζ̇, which adds to K, C and the steady force of (q, ζ). Without friction it is only carried along.
  const double V = 0.7, T = 150.0, N0 = 40.0;
  const ThreeMasses three;
  const Eigen::MatrixXd &K = three.K, &C = three.C;
  const fem::Structure structure = three.structure();
  const friction::NormalOscillator own{.mass = 0.4,
                                       .support_stiffness = 1.3,
                                       .support_damping = 0.7,
                                       .spring_stiffness = 0.9,
                                       .spring_damping = 0.2,
                                       .slope = 0.6};
  using Matrix = Eigen::Matrix<Long, 4, 4>;
  using Vector = Eigen::Matrix<Long, 4, 1>;
  for (const double spring : {1e3, 1e5, 1e7, 1e9})
    for (const double mu : {0.0, 0.3}) {
      SCOPED_TRACE(testing::Message() << "K_c = " << spring << ", mu = " << mu);
      Matrix held = Matrix::Zero(), damped = Matrix::Zero();
      held.topLeftCorner(3, 3) = K.cast<Long>();
      damped.topLeftCorner(3, 3) = C.cast<Long>();
      const auto add = [&](Matrix& of, Long spring_, Long support) {
        of(0, 0) -= mu * spring_ * own.slope;
        of(0, 3) = mu * spring_;
        of(3, 0) = -spring_ * own.slope;
        of(3, 3) = spring_ + support;
      };
      add(held, own.spring_stiffness, own.support_stiffness);
      add(damped, own.spring_damping, own.support_damping);
      held(2, 2) += spring;
      const Vector a = held.fullPivLu().solve(Vector(0.0L, 0.0L, static_cast<Long>(spring) * V, 0.0L)),
                   b = held.fullPivLu().solve(Vector(Vector(mu * N0, 0.0L, 0.0L, 0.0L) - damped * a)),
                   q = a * static_cast<Long>(T) + b;
      const auto force = static_cast<double>((K.cast<Long>() * q.head(3) + C.cast<Long>() * a.head(3))(2));
      const HybridSystem system(structure,
                                {{unit(3, 0), friction::Coulomb{mu, mu}, friction::NormalLoad(N0, own)},
                                 {unit(3, 2), friction::CompliantCoulomb{1.0, 1.0, spring}, 1e9}},
                                friction::Belt::constant(V));
      const Trajectory run = simulate(system, system.rest(), {.duration = T});
      const Eigen::Index last = run.final_state.internal.size() - 1;
      EXPECT_NEAR(run.final_state.internal(last) * spring / force, 1.0, 1e-13 + 4e-15 * spring);
      EXPECT_NEAR(run.final_state.internal(0) / static_cast<double>(q(3)), 1.0, 1e-13 + 1e-15 * std::sqrt(spring));
      EXPECT_LT(std::abs(run.audit.residual()), 1e-12 + 1e-15 * std::sqrt(spring));
    }
}

TEST(StuckEnergy, AFloatingMassThatABeltCarriesTakesNoWork) {
  // A mass that nothing else holds moves with the belt, its spring without a force, while two others swing and a damper
  // carries one of them off. Of all that the belt has moved it by, the spring's row rounds by 1e-16 K_c: the work was
  // off by that times the way.
  const double V = -0.5;
  const fem::Structure structure =
      fem::masses({.mass = {1.5, 0.8, 2.0}, .links = {{0, 2, 0.36, 0.0}, {2, 3, 0.0, 0.035}}});
  for (const double spring : {1e2, 1e4, 1e6, 1e8}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(structure, {{unit(3, 0), friction::CompliantCoulomb{0.3, 0.3, spring}, 2.0}},
                              friction::Belt::constant(V));
    State start = system.rest();
    start.q = Eigen::Vector3d(0.6, 0.5, 0.9);
    start.v.setConstant(V);
    const Trajectory run = simulate(system, start, {.duration = 40.0});
    EXPECT_TRUE(run.events.empty());
    EXPECT_NEAR(run.final_state.q(0), start.q(0) + V * 40.0, 1e-13);
    // A stretch that is rounding at the begin of each sum swings on: sqrt(K_c m) V 1e-16 in a period, of all sums more.
    EXPECT_LT(std::abs(run.audit.drive_work), 1e-14 + 1e-14 * std::sqrt(spring));
    EXPECT_LT(std::abs(run.audit.residual()), 1e-14 + 1e-14 * std::sqrt(spring));
  }
}

TEST(StuckEnergy, AMassThatSwingsOnAWayOfItsOwnGivesAndTakesNothing) {
  // The same mass at another speed swings about the belt's for good: as force and velocity of two motions that round
  // apart, its work was off by 1e-5 after 300 s at 1e6.
  const double V = 0.7;
  const fem::Structure structure = fem::masses({.mass = {0.74, 0.47}, .links = {{0, 1, 0.0, 0.0}, {0, 2, 0.0, 0.0}}});
  for (const double spring : {1e2, 1e4, 1e6, 1e8}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(structure, {{unit(2, 0), friction::CompliantCoulomb{1.0, 1.0, spring}, 1e9}},
                              friction::Belt::constant(V));
    State start = system.rest();
    start.v = Eigen::Vector2d(-0.8, 0.1);
    const Trajectory run = simulate(system, start, {.duration = 300.0});
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11 + 1e-12 * std::sqrt(spring));
  }
}

TEST(StuckEnergy, ASpringIsHeldToTheWayHoweverManyWindowsItTakes) {
  // The same mass, so near to sliding that windows are short: 40,000 of them. What each adds to the belt's way and to
  // the place that follows it rounds to one side, both otherwise: the spring's force was off by 9e-5 N at the end, the
  // balance by 1e-8, the place by 1e-10 m. In closed form y = V t + u / w sin w t.
  const double V = 0.7, u = 0.05, mass = 0.9, spring = 1e6, duration = 300.0, rate = std::sqrt(spring / mass);
  const HybridSystem system(
      fem::masses({.mass = {mass}, .links = {{0, 1, 0.0, 0.0}}}),
      {{unit(1, 0), friction::CompliantCoulomb{1.0, 1.0, spring}, 1.3 * std::sqrt(spring * mass) * u}},
      friction::Belt::constant(V));
  State start = system.rest();
  start.v(0) = V + u;
  const Trajectory run = simulate(system, start, {.duration = duration, .sample = duration});
  EXPECT_TRUE(run.events.empty());
  EXPECT_GT(run.statistics.steps, 30000);
  const double swings = u / rate * std::sin(rate * duration), rounds = 2e-16 * V * duration;
  EXPECT_NEAR(run.lambda(0, run.lambda.cols() - 1), -spring * swings, 4.0 * spring * rounds);
  EXPECT_NEAR(run.final_state.q(0), V * duration + swings, 10.0 * rounds);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-10);
}

TEST(StuckEnergy, PartsOnDampersAreHeldToTheWayAsWell) {
  // Of six masses two parts hang on dampers alone, one with the spring: some modes do not oscillate, and go by tables.
  // As long as all others did so too, from window to window, the balance was 6e-10 and 2e-9 behind the two springs.
  for (const double spring : {4e7, 4e8}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(fem::masses({.mass = {1.1, 0.7, 2.3, 0.4, 1.9, 0.6},
                                           .links = {{0, 1, 900.0, 0.4},
                                                     {1, 2, 350.0, 0.1},
                                                     {2, 3, 0.0, 0.8},
                                                     {3, 4, 120.0, 0.05},
                                                     {1, 5, 0.0, 0.02},
                                                     {5, 6, 77.0, 0.0}}}),
                              {{unit(6, 4), friction::CompliantCoulomb{0.5, 0.3, spring}, 40.0},
                               {unit(6, 1), friction::Coulomb{0.3, 0.2}, 25.0}},
                              friction::Belt::constant(0.35));
    const Trajectory run = simulate(system, system.rest(), {.duration = 25.0});
    EXPECT_GT(run.statistics.steps, 10000);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
  }
}

TEST(StuckEnergy, AModeThatNextToNothingHoldsIsNoneToTellForcesBy) {
  // A block under a load that grows by 1e-12 N/m, and joins a spring: the mode it holds, at 1e-6 rad/s, is so far out
  // under a constant force that the spring's row and the structure's equations differ by 100 N there. Forces of the one
  // beside motions of the other made half the balance.
  const Eigen::MatrixXd M = Eigen::Vector3d(1.26, 1.14, 0.67).asDiagonal();
  Eigen::MatrixXd K(3, 3);
  K << 1.52, 0.0, -1.52, 0.0, 0.0, 0.0, -1.52, 0.0, 1.52;
  const fem::Structure structure{fem::Matrix(M), fem::Matrix(Eigen::MatrixXd(0.05 * K)), fem::Matrix(K)};
  for (const auto& [spring, slope] : {std::pair(1e4, -1e-12), std::pair(1e6, -1e-10), std::pair(1e6, 1e-10)}) {
    SCOPED_TRACE(testing::Message() << spring << ", " << slope);
    const HybridSystem system(structure,
                              {{Eigen::Vector3d(1.0, -1.0, 0.0), friction::CompliantCoulomb{1.0, 1.0, spring}, 1e9},
                               {unit(3, 1), friction::Coulomb{0.1, 0.1}, friction::NormalLoad(1.0, slope)}},
                              friction::Belt::ramp(-0.22, 0.9, 2.0, 12.0));
    State start = system.rest();
    start.v = Eigen::Vector3d(-0.22, -0.05, 0.99);
    const Trajectory run = simulate(system, start, {.duration = 30.0, .flow = {.method = FlowMethod::kClosedForm}});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-6);
  }
}

TEST(StuckEnergy, AMomentFromRestIsToldFromTheShakersOwnPlace) {
  // From rest at t = 0 the spring takes d(τ) − d(0) = A (sin(ωτ + φ) − sin φ), since the mass moves by (K/m) ∫∫ (d −
  // d(0)) only, 1e-14 of it: work K (d − d(0))²/2. In 1e-10 s the shaker goes 1e-9 of its amplitude.
  const double K = 4e6, m = 1.0, c = 0.3, tau = 1e-10, A = 0.3, phi = 0.7;
  const auto one = [](double value) -> fem::Matrix { return Eigen::MatrixXd::Constant(1, 1, value); };
  const friction::Shaker shaker{A, 3.0, phi};
  const HybridSystem system(fem::Structure(one(m), one(c), one(2.0)),
                            {{unit(1, 0), friction::CompliantCoulomb{1.0, 1.0, K}, 1e6}}, shaker);
  const Trajectory run =
      simulate(system, system.rest(), {.duration = tau, .flow = {.method = FlowMethod::kClosedForm}});
  const Long w = shaker.omega(), turn = w * tau, sine = std::sin(static_cast<Long>(phi)),
             cosine = std::cos(static_cast<Long>(phi));
  const Long moved = A * turn * (cosine - turn * sine / 2.0L);
  const Long place =
      K / m * A * turn * tau * tau / 6.0L * (cosine - turn * sine / 4.0L) * (1.0L - c * tau / (4.0L * m));
  EXPECT_NEAR(run.audit.drive_work / static_cast<double>(K * moved * moved / 2.0L), 1.0, 1e-13);
  EXPECT_NEAR(run.final_state.q(0) / static_cast<double>(place), 1.0, 1e-13);
  EXPECT_NEAR(run.final_state.internal(0) / static_cast<double>(moved), 1.0, 1e-13);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-13);
}

TEST(StuckEnergy, AForceOnASpringsPlaceMovesWhatTheSpringLeaves) {
  // Steady motion q = Re X e^{iwt}, X = F / (k + K - m w^2 + i w c), beside 2 m that the force would move without the
  // spring. X as the difference of that and of what the spring takes back was off by 1e-16 m: the balance by 1e-9
  // behind 8e5 N/m, and by 6e-4 behind 1e11.
  const Long m = 0.37L, c = 0.01L, k = 0.1L, F = 0.19L, w = 0.9L;
  const auto one = [](Long value) -> fem::Matrix {
    return Eigen::MatrixXd::Constant(1, 1, static_cast<double>(value));
  };
  for (const double spring : {1.0, 1e3, 8e5, 1e8, 1e11}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(
        fem::Structure(one(m), one(c), one(k)), {{unit(1, 0), friction::CompliantCoulomb{0.5, 0.5, spring}, 3.0}},
        friction::Force{static_cast<double>(w), {{.amplitude = static_cast<double>(F)}}}, {}, unit(1, 0));
    const Complex X = Complex(0.0L, -F) / Complex(k + spring - m * w * w, w * c);  // of F sin wt
    State start = state(Eigen::VectorXd::Constant(1, static_cast<double>(X.real())),
                        Eigen::VectorXd::Constant(1, static_cast<double>(-w * X.imag())));
    start.internal = -start.q;
    start.modes = {ContactMode::kStick};
    const double duration = 10.9;
    const Trajectory run = simulate(system, start, {.duration = duration, .flow = {.method = FlowMethod::kClosedForm}});
    EXPECT_TRUE(run.events.empty());
    const double q = static_cast<double>((X * std::polar(1.0L, w * static_cast<Long>(duration))).real());
    EXPECT_NEAR(run.final_state.q(0) / q, 1.0, 1e-13);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-13);
  }
}

TEST(StuckEnergy, ForcesOnThePlacesOfSeveralSpringsBalance) {
  // Two masses that damping couples, each behind a spring and under the force: no force is left beside the springs.
  for (const double spring : {1e3, 1e5, 1e8, 1e11}) {
    SCOPED_TRACE(spring);
    const HybridSystem system(fem::masses({.mass = {1.0, 2.0}, .links = {{0, 1, 1.0, 0.02}, {1, 2, 0.7, 0.3}}}),
                              {{unit(2, 1), friction::CompliantCoulomb{0.5, 0.3, spring}, 2.0},
                               {unit(2, 0), friction::CompliantCoulomb{0.5, 0.4, 3e6}, 3.0}},
                              friction::Force{0.9, {{.amplitude = 0.3}}}, {}, Eigen::Vector2d(0.5, 1.0));
    const Trajectory run = simulate(system, system.rest(), {.duration = 50.0});
    EXPECT_TRUE(run.events.empty());
    EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
  }
}

TEST(StuckEnergy, AHeavyPartBesideAHeldOneKeepsItsDigits) {
  // A mass of 1e12 on a spring to one that sticks: x = x₀ cos ωt, λ = −k x. What is free was told from what is held by
  // a reflection whose small entries were differences of ones: both errors were 1e-10 x₀.
  const double heavy = 1e12, k = 1.1, x0 = 1.5, omega = std::sqrt(k / heavy);
  const Eigen::MatrixXd M = Eigen::Vector2d(1.3, heavy).asDiagonal(), K{{2.1, -k}, {-k, k}};
  const HybridSystem system(fem::Structure(fem::Matrix(M), fem::Matrix(Eigen::MatrixXd(0.0 * M)), fem::Matrix(K)),
                            {{unit(2, 0), friction::Coulomb{1.0, 1.0}, 10.0}}, friction::Belt::constant(0.0));
  State start = system.rest();
  start.q(1) = x0;
  const Trajectory run = simulate(system, start, {.duration = 1e7, .sample = 1e5});
  EXPECT_TRUE(run.events.empty());
  for (Eigen::Index i = 0; i < run.times.size(); ++i) {
    const double x = x0 * std::cos(omega * run.times(i));
    EXPECT_NEAR(run.q(1, i), x, 1e-13 * x0);
    EXPECT_NEAR(run.q(0, i), 0.0, 1e-15 * x0);
    EXPECT_NEAR(run.lambda(0, i), -k * x, 1e-13 * k * x0);
  }
}

}  // namespace
}  // namespace slipmode::dynamics
