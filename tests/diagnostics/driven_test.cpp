// Shaken oscillators with closed forms: stuck behind a contact spring (linear), sliding all the time (half-period
// antisymmetric), and manufactured section points.
#include <slipmode/diagnostics/attractors/driven.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/series/spectrum.hpp>
#include <slipmode/diagnostics/validation/driven_validation.hpp>
#include <slipmode/rom/reduce.hpp>
#include "fixtures/den_hartog.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstring>
#include <map>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

namespace slipmode::diagnostics {
namespace {

constexpr double kPi = std::numbers::pi;

/// m q̈ + c q̇ + k q = λ under a shaker.
struct Oscillator {
  double m = 1.0, c = 0.4, k = 4.0;

  [[nodiscard]] dynamics::HybridSystem with(friction::Law law, double load, friction::Shaker shaker) const {
    const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
    friction::Contact contact;
    contact.direction = Eigen::VectorXd::Ones(1);
    contact.law = law;
    contact.normal_load = load;
    return {fem::Structure(one(m), one(c), one(k)), {contact}, shaker};
  }
};

const Readings kDisplacement{.rows = Eigen::MatrixXd::Ones(1, 1), .offset = {}};
constexpr DrivenOptions kQuick{.cycles = 120.0, .kept = 40.0};
constexpr friction::CompliantCoulomb kHeld{.mu_s = 1e3, .mu_k = 1e3, .stiffness = 6.0};

/// At rest with its springs relaxed, at a section.
dynamics::State at_section(const dynamics::HybridSystem& system) {
  dynamics::State state = system.rest();
  state.time = system.drive().shaker()->next_upward_zero(0.0);
  return state;
}

TEST(Driven, AStopThatIsMetAndLeftIsNoLossOfAContactAndNoShareOfStick) {
  // The motion of the held contact, and a stop that its swing meets: labels and shares are of the pad alone.
  const friction::Shaker shaker{.amplitude = 0.3, .frequency_hz = 0.7};
  const Oscillator o;
  dynamics::HybridSystem pad = o.with(kHeld, 1.0, shaker);
  std::vector<friction::Contact> contacts = pad.contacts();
  contacts.push_back(contacts[0]);
  contacts[1].law = friction::Clearance{friction::Stop{.stiffness = 5.0, .gap = 0.01}, std::nullopt};
  const dynamics::HybridSystem both(pad.structure(), contacts, shaker);
  const DrivenMotion found = settle_driven(both, kDisplacement, both.rest(), kQuick);
  EXPECT_GT(found.events, 100);
  EXPECT_EQ(found.separations, 0);
  EXPECT_EQ(found.label, DrivenLabel::kStick);
  EXPECT_DOUBLE_EQ(found.stick_fraction, 1.0);
}

TEST(Driven, AHeldContactMovesLikeALinearOscillatorOnAMovingSpring) {
  const Oscillator o;
  const friction::Shaker shaker{.amplitude = 0.3, .frequency_hz = 0.7, .phase = 0.4};
  const DrivenMotion found =
      settle_driven(o.with(kHeld, 1.0, shaker), kDisplacement, at_section(o.with(kHeld, 1.0, shaker)), kQuick);
  // The spring is relaxed at the start, a section, where d = −A: its far end is at d + A. In complex form d = Re(i A
  // e^{iφ}) with φ = −π/2 … at a section the phase of d = A cos θ is θ = π.
  const double w = shaker.omega(), total = o.k + kHeld.stiffness;
  const std::complex<double> response = kHeld.stiffness / std::complex<double>(total - o.m * w * w, o.c * w);
  const double steady = kHeld.stiffness * shaker.amplitude / total;
  EXPECT_EQ(found.label, DrivenLabel::kStick);
  EXPECT_EQ(found.period.repeat, DrivenRepeat::kPeriodic);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_DOUBLE_EQ(found.stick_fraction, 1.0);
  EXPECT_NEAR(found.rms(0), shaker.amplitude * std::abs(response) / std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(found.mean(0), steady, 1e-9);
  for (Eigen::Index k = 0; k < found.readings.cols(); ++k) {
    EXPECT_NEAR(found.readings(0, k), steady - shaker.amplitude * response.real(), 1e-9) << "section " << k;
  }
  EXPECT_LT(std::abs(found.audit_residual), 1e-10);
}

TEST(Driven, SlidingAllTheTimeIsTheResponseToASquareWave) {
  const Oscillator o;
  const double force = 0.05;  // μ_k N, little beside the slider's speed
  const friction::Shaker shaker{.amplitude = 2.0, .frequency_hz = 0.9, .phase = 0.0};
  const auto system = o.with(friction::Coulomb{force, force}, 1.0, shaker);
  const DrivenMotion found = settle_driven(system, kDisplacement, system.rest(), kQuick);

  // From reversal to reversal λ = F: x(T/2) = E x(0) + (I − E) x_F = −x(0).
  const double T = shaker.period(), w = shaker.omega();
  Eigen::Matrix2d A;
  A << 0.0, 1.0, -o.k / o.m, -o.c / o.m;
  const Eigen::Vector2d rest(force / o.k, 0.0);
  const auto flow = [&](double t, const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return rest + Eigen::Matrix2d((A * t).exp()) * (x - rest);
  };
  const Eigen::Matrix2d E = (A * (0.5 * T)).exp();
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d begin = -(I + E).inverse() * ((I - E) * rest);
  const double late = std::asin(begin(1) / (shaker.amplitude * w)) / w;  // reversal after the section
  const Eigen::Vector2d at_section = late > 0.0 ? Eigen::Vector2d(-flow(0.5 * T - late, begin)) : flow(-late, begin);

  EXPECT_EQ(found.label, DrivenLabel::kSlip);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_EQ(found.separations, 0);
  EXPECT_NEAR(found.contact_q(0, 0), at_section(0), 1e-9);
  EXPECT_NEAR(found.contact_v(0, 0), at_section(1), 1e-9);
}

/// m q̈ + c q̇ + k q = λ + A sin(ωt + φ), the counterpart at rest.
dynamics::HybridSystem forced(const Oscillator& o, friction::Law law, double load, friction::Force force) {
  const dynamics::HybridSystem still = o.with(std::move(law), load, {});
  return {still.structure(), still.contacts(), std::move(force), {}, Eigen::MatrixXd::Ones(1, 1)};
}

TEST(Driven, UnderAForceALinearOscillatorMovesAsItsTransferFunctionSays) {
  // Stops too far to be met. Sections are at ωt = 0, 2π, …, where Im(H A e^{i(ωt + φ)}) = Im(H A e^{iφ}).
  const Oscillator o;
  constexpr double kOmega = 2.3, kForce = 0.8, kPhase = 0.4;
  const friction::Stop far{.stiffness = 1.0, .gap = 1e3};
  const auto system = forced(o, friction::Clearance{far, far}, 0.0, {kOmega, {{.amplitude = kForce, .phase = kPhase}}});
  const DrivenMotion found = settle_driven(system, kDisplacement, system.rest(), kQuick);
  const std::complex<double> answer =
      std::polar(kForce, kPhase) / std::complex<double>(o.k - o.m * kOmega * kOmega, o.c * kOmega);
  EXPECT_EQ(found.label, DrivenLabel::kNoFriction);
  EXPECT_EQ(found.period.repeat, DrivenRepeat::kPeriodic);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_NEAR(found.frequency_hz, kOmega / (2.0 * kPi), 1e-15);
  EXPECT_NEAR(found.rms(0), std::abs(answer) / std::numbers::sqrt2, 1e-11);
  for (Eigen::Index k = 0; k < found.readings.cols(); ++k) {
    EXPECT_NEAR(found.readings(0, k), answer.imag(), 1e-11) << "section " << k;
    EXPECT_NEAR(found.contact_v(0, k), kOmega * answer.real(), 1e-11) << "section " << k;
  }
  EXPECT_LT(std::abs(found.audit_residual), 1e-10);
}

// Two decaying motions that beat with the drive's never come back: of a damped linear motion no period but the drive's
// is claimed, nor is it called aperiodic; without damping it is what it seems.
TEST(Driven, WhereNothingHappensADampedMotionSettlesToTheDrivesPeriod) {
  const auto motion = [](double damping) {
    const Eigen::Matrix2d K{{7.0, -2.0}, {-2.0, 3.0}};
    friction::Contact far{Eigen::VectorXd::Unit(2, 0),
                          friction::Clearance{friction::Stop{1.0, 0.0, 1e3}, std::nullopt}};
    const dynamics::HybridSystem system(
        fem::Structure(Eigen::MatrixXd(Eigen::Matrix2d::Identity()), Eigen::MatrixXd(damping * K), Eigen::MatrixXd(K)),
        {far}, friction::Force{1.1, {{.amplitude = 0.8}}}, {}, Eigen::MatrixXd::Ones(2, 1));
    return settle_driven(system, {.rows = Eigen::RowVector2d(1.0, 0.0), .offset = {}}, system.rest(), kQuick);
  };
  const DrivenMotion slow = motion(1e-3), free = motion(0.0);
  EXPECT_EQ(slow.period.repeat, DrivenRepeat::kSettling);
  EXPECT_EQ(slow.period.period, 1);
  EXPECT_GT(slow.period.mismatch, kQuick.tolerance);
  EXPECT_EQ(free.period.repeat, DrivenRepeat::kAperiodic);
  EXPECT_EQ(motion(0.1).period.repeat, DrivenRepeat::kPeriodic);
}

// Its own frequency a third of the drive's and hardly damped: all but the same three periods later, and no period 3.
TEST(Driven, ADampedLinearMotionHasNoPeriodOfItsOwn) {
  constexpr double kOmega = 1.2;
  const friction::Stop far{.stiffness = 1.0, .gap = 1e3};
  const auto system =
      forced({1.0, 1e-7, kOmega * kOmega / 9.0}, friction::Clearance{far, far}, 0.0, {kOmega, {{.amplitude = 0.8}}});
  const DrivenMotion found = settle_driven(system, kDisplacement, system.rest(), kQuick);
  EXPECT_EQ(found.period.repeat, DrivenRepeat::kSettling);
  EXPECT_EQ(found.period.period, 1);
}

TEST(Driven, UnderAForceAStateHandedOnKeepsThePhase) {
  // What one run ends with, the next begins with: no transient is left where the motion has settled.
  const Oscillator o;
  const auto system = forced(o, friction::Coulomb{0.05, 0.05}, 1.0, {2.3, {{.amplitude = 0.8, .phase = 0.4}}});
  const DrivenMotion first = settle_driven(system, kDisplacement, system.rest(), kQuick);
  const DrivenMotion second = settle_driven(system, kDisplacement, first.end, {.cycles = 30.0, .kept = 25.0});
  ASSERT_EQ(first.period.period, 1);
  for (Eigen::Index k = 0; k < second.readings.cols(); ++k)
    EXPECT_NEAR(second.readings(0, k), first.readings(0, first.readings.cols() - 1), 1e-11);
}

// In coordinates of the base Den Hartog's oscillator is one on dry ground under a force; φ = ψ begins at a turning
// point, so sections are (x₀, 0).
TEST(Driven, UnderAForceDenHartogsOscillatorReturnsToItsTurningPoint) {
  const fixtures::DenHartog own;
  const double w = own.omega();
  const auto system =
      forced({own.mass, 0.0, own.stiffness}, friction::Coulomb{own.friction, own.friction}, 1.0,
             {w, {{.amplitude = own.base * (own.mass * w * w - own.stiffness), .phase = own.shaker().phase}}});
  dynamics::State start = system.rest();
  start.q[0] = 1.01 * own.amplitude();
  const DrivenMotion found = settle_driven(system, kDisplacement, start, {.cycles = 4000.0, .kept = 100.0});
  EXPECT_EQ(found.label, DrivenLabel::kSlip);
  EXPECT_EQ(found.period.period, 1);
  EXPECT_NEAR(found.readings.row(0).maxCoeff(), own.amplitude(), 1e-9);
  EXPECT_NEAR(found.readings.row(0).minCoeff(), own.amplitude(), 1e-9);
  EXPECT_LT(found.contact_v.row(0).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Driven, TurningTheContactSpringRoundIsMicroStick) {
  const Oscillator o;
  const friction::Shaker shaker{.amplitude = 2.0, .frequency_hz = 0.9, .phase = 0.0};
  const auto motion = [&](double stiffness) {
    const auto system = o.with(friction::CompliantCoulomb{0.05, 0.05, stiffness}, 1.0, shaker);
    return settle_driven(system, kDisplacement, system.rest(), kQuick);
  };
  const DrivenMotion stiff = motion(100.0), soft = motion(0.2);
  EXPECT_EQ(stiff.label, DrivenLabel::kSlip);
  EXPECT_GT(stiff.longest_stick, 0.0) << "a reversal always passes through stick behind a spring";
  EXPECT_EQ(soft.label, DrivenLabel::kStickSlip);
  // Turning the spring round takes a way of 2 μN/K_c; from a standstill 2 A sin²(wt/2) of it, the mass moving little.
  const double way = 2.0 * 0.05 / 100.0;
  const double time = 2.0 * std::asin(std::sqrt(way / (2.0 * shaker.amplitude))) / shaker.omega();
  EXPECT_NEAR(stiff.longest_stick, time / shaker.period(), 0.1 * time / shaker.period());
}

/// One row of section points.
Eigen::MatrixXd series(Eigen::Index count, const std::function<double(double)>& value) {
  Eigen::MatrixXd points(1, count);
  for (Eigen::Index k = 0; k < count; ++k) points(0, k) = value(static_cast<double>(k));
  return points;
}

TEST(DrivenPeriod, FindsTheSmallestPeriodOfManufacturedSections) {
  const Eigen::VectorXd scale = Eigen::VectorXd::Ones(1);
  const auto found = [&](Eigen::Index count, const std::function<double(double)>& value) {
    return driven_period(series(count, value), scale, 1e-5, 8);
  };
  const auto two = found(100, [](double k) { return 0.3 * std::cos(kPi * k) + 1e-7 * std::sin(k); });
  EXPECT_EQ(two.repeat, DrivenRepeat::kPeriodic);
  EXPECT_EQ(two.period, 2);
  EXPECT_EQ(found(100, [](double k) { return std::fmod(k, 5.0) * 0.1; }).period, 5);
  EXPECT_EQ(found(100, [](double) { return 0.2; }).period, 1);
  const auto decaying = found(100, [](double k) { return 0.3 * std::cos(kPi * k) * (1.0 + std::exp(-0.05 * k)); });
  EXPECT_EQ(decaying.repeat, DrivenRepeat::kSettling);
  EXPECT_EQ(decaying.period, 2);
  const auto rotation = found(100, [](double k) { return std::cos(std::numbers::phi * k); });
  EXPECT_EQ(rotation.repeat, DrivenRepeat::kAperiodic);
  EXPECT_EQ(rotation.period, 0);
  EXPECT_EQ(found(15, [](double k) { return k; }).repeat, DrivenRepeat::kUndecided);
  // What beats while it dies out draws nearer to no period in every quarter; it is no motion without a period either.
  const auto beats = found(100, [](double k) { return 0.01 * std::exp(-0.006 * k) * std::cos(0.05 * k); });
  EXPECT_EQ(beats.repeat, DrivenRepeat::kUndecided);
  EXPECT_EQ(beats.period, 0);
  EXPECT_GT(beats.mismatch, 1e-5);
}

/// Largest exponent over 200 cycles.
double exponent_of(const friction::Law& law) {
  const auto system = Oscillator{}.with(law, 1.0, {.amplitude = 0.3, .frequency_hz = 0.7, .phase = 0.0});
  DrivenOptions options = kQuick;
  options.exponent_cycles = 200.0;
  return settle_driven(system, kDisplacement, system.rest(), options).exponent.value().nats;
}

TEST(DrivenExponent, IsTheDecayRateOfAnOscillatorThatSlidesFreely) {
  // Both eigenvalues of an underdamped oscillator have the real part −c/2m; the energy norm oscillates about the decay
  // by a bounded factor, which 200 cycles make small. So little friction changes nothing.
  EXPECT_NEAR(exponent_of(friction::Coulomb{1e-7, 1e-7}), -0.5 * Oscillator{}.c / Oscillator{}.m, 2e-3);
}

TEST(DrivenExponent, OfAHeldContactIsZeroSinceItsSpringForgetsNothing) {
  // Where the contact point stands is kept for ever: a direction that neither grows nor shrinks. The transient of the
  // others is a bounded factor.
  EXPECT_NEAR(exponent_of(kHeld), 0.0, 5e-3);
}

/// A structure of two masses with a contact spring at the second.
DrivenCase two_masses(const friction::Law& law, double load) {
  Eigen::Matrix2d M = Eigen::Matrix2d::Identity(), K;
  K << 5.0, -2.0, -2.0, 2.5;
  friction::Contact contact;
  contact.direction = Eigen::VectorXd::Unit(2, 1);
  contact.law = law;
  contact.normal_load = load;
  return {.system =
              dynamics::HybridSystem(fem::Structure(Eigen::MatrixXd(M), Eigen::MatrixXd(0.2 * M), Eigen::MatrixXd(K)),
                                     {contact}, friction::Shaker{.amplitude = 0.5, .frequency_hz = 0.3, .phase = 0.0}),
          .readings = {.rows = Eigen::MatrixXd::Identity(1, 2), .offset = {}}};
}

const DriveAt kDrive = [](double frequency) {
  return friction::Shaker{.amplitude = 0.5, .frequency_hz = frequency, .phase = 0.0};
};
const std::vector<double> kFrequencies = {0.15, 0.2, 0.25, 0.3, 0.35, 0.4};

std::vector<DrivenPoint> swept(const DrivenCase& model, const std::vector<double>& values, SweepMode mode,
                               int threads = 1, DrivenSink sink = {}) {
  return driven_sweep(driven_model(model, kDrive), values, model.system.rest(),
                      {.mode = mode, .driven = kQuick, .parallel = {.threads = threads}, .sink = std::move(sink)})
      .points;
}

void expect_same_bytes(const std::vector<DrivenPoint>& a, const std::vector<DrivenPoint>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const DrivenMotion &p = a[i].settled, &q = b[i].settled;
    ASSERT_EQ(p.readings.cols(), q.readings.cols());
    EXPECT_EQ(std::memcmp(p.readings.data(), q.readings.data(), sizeof(double) * p.readings.size()), 0) << i;
    EXPECT_EQ(std::memcmp(p.end.q.data(), q.end.q.data(), sizeof(double) * p.end.q.size()), 0) << i;
    EXPECT_EQ(p.end.internal, q.end.internal) << i;
    EXPECT_EQ(p.mean_energy, q.mean_energy) << i;
    EXPECT_EQ(p.label, q.label) << i;
    EXPECT_EQ(p.period.period, q.period.period) << i;
  }
}

constexpr friction::CompliantCoulomb kRubbing{.mu_s = 0.5, .mu_k = 0.4, .stiffness = 20.0};

TEST(DrivenSweep, GivesTheSameBytesForAnyNumberOfThreads) {
  const DrivenCase model = two_masses(kRubbing, 0.6);
  for (const SweepMode mode : {SweepMode::kIndependent, SweepMode::kFollow}) {
    expect_same_bytes(swept(model, kFrequencies, mode, 1), swept(model, kFrequencies, mode, 2));
  }
}

TEST(DrivenSweep, GoesOnFromRecalledPointsAsIfThereHadBeenNoBreak) {
  const DrivenCase model = two_masses(kRubbing, 0.6);
  const auto whole = swept(model, kFrequencies, SweepMode::kFollow);
  std::size_t computed = 0;
  const DrivenSink half{.recall = [&](std::size_t i, int) -> std::optional<DrivenPoint> {
                          return i < 3 ? std::optional(whole[i]) : std::nullopt;
                        },
                        .store = [&](const DrivenPoint&) { ++computed; }};
  expect_same_bytes(swept(model, kFrequencies, SweepMode::kFollow, 1, half), whole);
  EXPECT_EQ(computed, 3u);
}

TEST(DrivenSweep, UpAndDownAgreeWhereMotionIsLinear) {
  const DrivenCase model = two_masses(kHeld, 1.0);
  const std::vector<double> down(kFrequencies.rbegin(), kFrequencies.rend());
  const auto up = swept(model, kFrequencies, SweepMode::kFollow), back = swept(model, down, SweepMode::kFollow);
  EXPECT_EQ(hysteresis(up, back), 0.0);
}

TEST(DrivenSweep, ASpringKeepsTheStretchOfPastSliding) {
  // Swept over amplitude: held at small ones. On the way up the contact spring is as relaxed as at the start; on the
  // way down it keeps the stretch with which sliding ended. The motions differ by that constant.
  const DrivenCase model = two_masses(kRubbing, 0.6);
  const DrivenModel over_amplitude = driven_model(model, [](double amplitude) {
    return friction::Shaker{.amplitude = amplitude, .frequency_hz = 0.2, .phase = 0.0};
  });
  const std::vector<double> up = {0.005, 0.3, 0.6}, down = {0.6, 0.3, 0.005};
  const DrivenSweepOptions follow{.mode = SweepMode::kFollow, .driven = kQuick};
  const auto rising = driven_sweep(over_amplitude, up, model.system.rest(), follow).points;
  const auto falling = driven_sweep(over_amplitude, down, model.system.rest(), follow).points;
  EXPECT_EQ(rising.front().settled.label, DrivenLabel::kStick);
  EXPECT_EQ(falling.back().settled.label, DrivenLabel::kStick);
  EXPECT_NEAR(rising.front().settled.rms(0), falling.back().settled.rms(0), 1e-9)
      << "the motion about the mean is the same";
  EXPECT_GT(std::abs(rising.front().settled.mean(0) - falling.back().settled.mean(0)), 1e-3);
  EXPECT_GE(hysteresis(rising, falling), 1.0 / 3.0 - 1e-12);
}

TEST(DrivenValidation, AllModesAreTheFullModel) {
  const DrivenCase model = two_masses(kRubbing, 0.6);
  const pod::NamedBasis lnm{.name = "lnm", .basis = rom::lnm_basis(model.system.structure(), 2)};
  dynamics::State other = model.system.rest();
  other.v << 0.02, -0.01;
  const auto report = validate_driven(model, kDrive, {lnm}, model.system.rest(), other,
                                      {.values = kFrequencies,
                                       .driven = kQuick,
                                       .cost_parameter = 0.3,
                                       .cost_cycles = 10.0,
                                       .cost_repeats = 1,
                                       .parallel = {.threads = 1}});
  ASSERT_EQ(report.candidates.front().rows.size(), 2u);
  const DrivenRow &one = report.candidates.front().rows[0], &all = report.candidates.front().rows[1];
  EXPECT_LT(all.agreement.mean_wasserstein, 1e-7);
  EXPECT_EQ(all.agreement.same_label, 1.0);
  EXPECT_EQ(all.agreement.same_period, 1.0);
  EXPECT_EQ(all.trusted_share, 1.0);
  EXPECT_EQ(all.band, std::pair(kFrequencies.front(), kFrequencies.back()));
  EXPECT_GT(one.agreement.mean_wasserstein, 1e-3) << "one mode of two is not the full model";
  EXPECT_GT(report.cost.wall, 0.0);
  EXPECT_GT(all.cost.wall, 0.0);
}

// One mode cannot hold two contacts that stick rigidly: no distance, not one of 0, and nothing to be trusted.
TEST(DrivenValidation, ABasisThatCannotServeHasNoDistance) {
  DrivenCase model = two_masses(friction::Coulomb{.mu_s = 0.5, .mu_k = 0.4}, 0.6);
  std::vector<friction::Contact> contacts = model.system.contacts();
  contacts.push_back({Eigen::VectorXd::Unit(2, 0), contacts[0].law, 0.6});
  model.system = {model.system.structure(), contacts, model.system.drive()};
  const pod::NamedBasis lnm{.name = "lnm", .basis = rom::lnm_basis(model.system.structure(), 2)};
  const auto report = validate_driven(model, kDrive, {lnm}, model.system.rest(), model.system.rest(),
                                      {.values = {0.3},
                                       .driven = kQuick,
                                       .cost_parameter = 0.3,
                                       .cost_cycles = 10.0,
                                       .cost_repeats = 1,
                                       .parallel = {.threads = 1}});
  const DrivenRow &one = report.candidates.front().rows[0], &all = report.candidates.front().rows[1];
  EXPECT_NE(one.failure, "");
  EXPECT_TRUE(std::isnan(one.agreement.mean_wasserstein));
  EXPECT_TRUE(std::isnan(one.agreement.same_label));
  EXPECT_TRUE(std::isnan(one.cost.cpu));
  EXPECT_EQ(one.trusted_share, 0.0);
  EXPECT_EQ(all.failure, "");
  EXPECT_EQ(report.candidates.front().trusted_from, 2);
}

// Undecided beside undecided is no agreement.
TEST(DrivenCompare, PeriodsAreTheSameWhereBothAreDecided) {
  const auto point = [](std::size_t index, DrivenRepeat repeat, int period) {
    DrivenPoint out{.index = index, .parameter = static_cast<double>(index)};
    out.settled.readings = Eigen::MatrixXd::Constant(1, 3, 0.5);
    out.settled.rms = Eigen::VectorXd::Ones(1);
    out.settled.period = {repeat, period, 0.0};
    return out;
  };
  const DrivenPoint one = point(0, DrivenRepeat::kPeriodic, 1), unknown = point(1, DrivenRepeat::kUndecided, 0),
                    two = point(2, DrivenRepeat::kPeriodic, 2), three = point(2, DrivenRepeat::kPeriodic, 3);
  EXPECT_EQ(compare_driven({one, unknown, two}, {one, unknown, three}).same_period, 0.5);
  EXPECT_EQ(compare_driven({one, unknown}, {one, unknown}).same_period, 1.0);
  EXPECT_TRUE(std::isnan(compare_driven({unknown}, {unknown}).same_period));
}

// Distances 0 and 0.2 of full motions whose root mean square is 1: 0.1, as in compare_sweeps.
TEST(DrivenCompare, TheMedianOfTwoDistancesIsTheirMean) {
  const auto point = [](std::size_t index, double reading) {
    DrivenPoint out{.index = index, .parameter = static_cast<double>(index)};
    out.settled.readings = Eigen::MatrixXd::Constant(1, 3, reading);
    out.settled.rms = Eigen::VectorXd::Ones(1);
    return out;
  };
  const DrivenAgreement found = compare_driven({point(0, 0.5), point(1, 0.5)}, {point(0, 0.5), point(1, 0.7)});
  EXPECT_NEAR(found.median_wasserstein, 0.1, 1e-15);
}

TEST(DrivenCompare, PeaksAreThoseThatRiseAboveTheirGround) {
  std::vector<DrivenPoint> points;
  const std::vector<double> rms = {1.0, 3.0, 2.0, 2.05, 1.9, 6.0, 1.0};
  for (std::size_t i = 0; i < rms.size(); ++i) {
    points.push_back({.index = i, .parameter = static_cast<double>(i)});
    points.back().settled.rms = Eigen::VectorXd::Constant(1, rms[i]);
  }
  const auto peaks = amplitude_peaks(points);  // 2.05 rises by less than a twentieth of the largest
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_EQ(peaks[0].parameter, 1.0);
  EXPECT_EQ(peaks[1].parameter, 5.0);
  EXPECT_DOUBLE_EQ(peaks[1].amplitude, 6.0 * std::numbers::sqrt2);
}

TEST(Driven, RefusesABeltAndOptionsOutOfRange) {
  const Oscillator o;
  const auto shaken = o.with(kHeld, 1.0, {.amplitude = 0.1, .frequency_hz = 1.0, .phase = 0.0});
  EXPECT_THROW((void)settle_driven(shaken.with_drive(friction::Belt::constant(1.0)), kDisplacement, shaken.rest()),
               InvalidInput);
  EXPECT_THROW((void)settle_driven(shaken, kDisplacement, shaken.rest(), {.cycles = 10.0, .kept = 10.0}), InvalidInput);
  EXPECT_THROW((void)settle_driven(shaken, kDisplacement, shaken.rest(), {.cycles = 10.5, .kept = 2.0}), InvalidInput);
  const Readings wrong{.rows = Eigen::MatrixXd::Ones(1, 2), .offset = {}};
  EXPECT_THROW((void)settle_driven(shaken, wrong, shaken.rest()), InvalidInput);
}

TEST(Spectrum, ShowsTheAmplitudeOfASineOnItsGrid) {
  const double interval = 0.01;
  const Eigen::Index segment = 200;  // grid of 0.5 Hz
  Eigen::VectorXd series(2000);
  for (Eigen::Index i = 0; i < series.size(); ++i) {
    const double t = interval * static_cast<double>(i);
    series[i] = 0.7 + 0.3 * std::sin(2.0 * kPi * 5.0 * t) + 0.02 * std::cos(2.0 * kPi * 12.5 * t + 0.3);
  }
  const AmplitudeSpectrum found = amplitude_spectrum(series, interval, segment);
  EXPECT_EQ(found.segments, 19);
  EXPECT_DOUBLE_EQ(found.frequency_hz[10], 5.0);
  EXPECT_NEAR(found.amplitude[0], 0.7, 1e-12);
  EXPECT_NEAR(found.amplitude[10], 0.3, 1e-12);
  EXPECT_NEAR(found.amplitude[25], 0.02, 1e-12);
  EXPECT_LT(found.amplitude[18], 1e-12);
  EXPECT_THROW((void)amplitude_spectrum(series, interval, 5000), InvalidInput);
  // Cut off within its period a sine leaks as Hann's window lets it, like 1/f³ of the distance, and not more at zero.
  Eigen::VectorXd cut(1024);
  for (Eigen::Index k = 0; k < cut.size(); ++k) cut[k] = std::cos(2.0 * kPi * 60.37 * static_cast<double>(k) / 256.0);
  const AmplitudeSpectrum leaked = amplitude_spectrum(cut, 1.0, 256);
  EXPECT_LT(leaked.amplitude.head(10).maxCoeff(), 2e-5);
}

}  // namespace
}  // namespace slipmode::diagnostics
