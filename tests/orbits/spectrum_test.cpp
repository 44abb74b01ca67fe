// Fourier coefficients of exact orbits: against an independent program, and against the equations of motion.
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/structure.hpp>
#include <slipmode/orbits/shooting.hpp>
#include <slipmode/orbits/spectrum.hpp>
#include "clearance_systems.hpp"
#include "play_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <complex>
#include <limits>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using Complex = std::complex<double>;

/// Settled for whole periods of the drive, on a clock that starts there: late instants have fewer digits.
dynamics::State settled(const HybridSystem& system, const dynamics::State& start, double periods) {
  dynamics::State state = settle_guess(system, start, periods);
  state.time = 0.0;
  return state;
}

Complex phasor(const Harmonics& y, int k) { return {y.cosine[k], -y.sine[k]}; }

TEST(Spectrum, Table2OfS2ToTwelveDigits) {
  for (const PlayRow& row : kPlayTable) {
    SCOPED_TRACE(row.figure);
    const HybridSystem system = play(row.xi, row.a, row.omega);
    dynamics::State guess = system.rest();
    guess.q[0] = row.start[0];
    guess.v[0] = row.start[1];
    const PeriodicOrbit orbit = find_orbit(system, guess, {.tolerance = 3e-14});
    const Spectrum spectrum = orbit_spectrum(system, orbit, 11);
    // The last of 16 Legendre terms takes the rounding of the values times 2 x 15 + 1: some ten units of each value.
    EXPECT_LT(spectrum.defect, 31 * 10 * std::numeric_limits<double>::epsilon());
    EXPECT_DOUBLE_EQ(spectrum.omega, row.omega);
    const Harmonics& x = spectrum.displacement.front();
    for (int k = 0; k <= 11; ++k) {
      const bool odd = k % 2 == 1;
      const auto i = static_cast<std::size_t>(k / 2);
      EXPECT_NEAR(x.cosine[k], odd ? row.cosine[i] : 0.0, 1e-12) << k;
      EXPECT_NEAR(x.sine[k], odd ? row.sine[i] : 0.0, 1e-12) << k;
    }
  }
}

/// (K + ikΩC − k²Ω²M) q_k = p_k + Σ d u_k + Σ w λ_k, and v_k = ikΩ q_k: what every exact spectrum obeys.
void expect_equations_of_motion(const HybridSystem& system, const PeriodicOrbit& orbit, int order, double tolerance) {
  const Eigen::Index n = system.size();
  const Spectrum spectrum = orbit_spectrum(system, orbit, order, Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd M = fem::to_dense(system.structure().M()), C = fem::to_dense(system.structure().C()),
                        K = fem::to_dense(system.structure().K());
  double force = 1.0;
  for (const Harmonics& own : spectrum.force) force = std::max(force, own.amplitude().maxCoeff());
  for (int k = 0; k <= order; ++k) {
    const Complex rate(0.0, k * spectrum.omega);
    Eigen::VectorXcd q(n), rest = Eigen::VectorXcd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      q[i] = phasor(spectrum.row_displacement[at], k);
      EXPECT_LT(std::abs(rate * q[i] - phasor(spectrum.row_velocity[at], k)), tolerance) << k;
    }
    rest -= (K.cast<Complex>() + rate * C.cast<Complex>() + rate * rate * M.cast<Complex>()) * q;
    if (k == 0 && system.load().size() > 0) rest += system.load().cast<Complex>();
    if (const friction::Force* drive = system.drive().force())
      for (const friction::ForceHarmonic& h : drive->harmonics)
        if (h.order * orbit.order == k)
          rest += system.force_directions().col(h.direction).cast<Complex>() * h.amplitude *
                  Complex(std::sin(h.phase), -std::cos(h.phase));
    for (std::size_t c = 0; c < system.contacts().size(); ++c) {
      rest += system.contacts()[c].direction.cast<Complex>() * phasor(spectrum.force[c], k);
      const Complex y =
          system.contacts()[c].direction.cast<Complex>().dot(q) + (k == 0 ? system.contacts()[c].offset : 0);
      EXPECT_LT(std::abs(y - phasor(spectrum.displacement[c], k)), tolerance) << k;
    }
    EXPECT_LT(rest.cwiseAbs().maxCoeff(), tolerance * force * std::max(1.0, k * k * spectrum.omega * spectrum.omega))
        << "order " << k;
  }
}

TEST(Spectrum, ObeysTheEquationsOfMotionOrderByOrder) {
  // Damped stops whose force jumps, four masses of which two touch, two contacts with a constant load and a skew
  // damping, three periods of the drive.
  const HybridSystem backlash = Backlash{.omega = 0.4}.system();
  expect_equations_of_motion(
      backlash, find_orbit(backlash, settled(backlash, backlash.rest(), 60.0), {.tolerance = 1e-13}), 60, 2e-12);
  const HybridSystem four = four_masses(1.1);
  expect_equations_of_motion(
      four, find_orbit(four, settled(four, displaced(four, 0, 1.0), 400.0), {.tolerance = 1e-13}), 40, 2e-12);
  const HybridSystem three = three_masses(1.1);
  expect_equations_of_motion(three, find_orbit(three, settled(three, three.rest(), 200.0), {.tolerance = 1e-13}), 40,
                             2e-12);
  const HybridSystem third = Backlash{.omega = 0.475}.system();
  expect_equations_of_motion(
      third, find_orbit(third, settled(third, third.rest(), 300.0), {.order = 3, .tolerance = 1e-13}), 60, 2e-12);
}

TEST(Spectrum, SlidingWithALawThatNoClosedFormMoves) {
  // A sliding speed below the peak of Stribeck's law: self-excited, forces by collocation.
  const friction::Stribeck law{.mu_s = 0.4, .mu_k = 0.25, .alpha = 3.0};
  const HybridSystem system(fem::masses({.links = {{.stiffness = 1.0, .damping = 0.02}}}),
                            {{Eigen::VectorXd::Ones(1), law, 1.0}}, friction::Belt::constant(0.1));
  const RecurrenceGuess guess = recurrence_guess(system, system.rest(), 100.0, 60.0);
  const PeriodicOrbit orbit = find_orbit(system, guess.state, {.period = guess.period});
  ASSERT_GT(orbit.crossings, 0);
  expect_equations_of_motion(system, orbit, 40, 1e-10);  // the collocation's own error
}

TEST(Spectrum, HighOrdersFallAsTheJumpsOfTheMotionSay) {
  // A damped stop's force jumps by cẏ where it is reached: |λ_k| k tends to a bounded, not vanishing, quantity, and
  // |y_k| k³ likewise. Order 20,000 costs as much as order 1.
  const HybridSystem system = Backlash{.omega = 1.2}.system();
  const PeriodicOrbit orbit = find_orbit(system, settled(system, displaced(system, 0, 2.0), 60.0));
  const OrbitSeries series(system, orbit);
  double jump = 0.0;
  for (const dynamics::Event& event : orbit.events)
    if (event.kind == dynamics::EventKind::kContact) jump = 0.5 * std::abs(event.velocity);  // c = 0.5
  ASSERT_GT(jump, 0.1);
  // Two equal and opposite jumps half a period apart: coefficient J/(πik) on odd orders, to 1/k of it.
  for (const int k : {2001, 20001})
    EXPECT_NEAR(std::abs(series.coefficient(k)[2]) * std::numbers::pi * k / jump, 1.0, 20.0 / k);
}

TEST(Spectrum, SeriesIsTheOrbit) {
  const HybridSystem system = Backlash{.omega = 0.65}.system();
  const PeriodicOrbit orbit = find_orbit(system, settled(system, system.rest(), 60.0));
  const OrbitSeries series(system, orbit, Eigen::MatrixXd::Ones(1, 1));
  const std::vector<dynamics::State> points = sample_orbit(system, orbit, 500);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::VectorXd now = series.at(orbit.start.time + static_cast<double>(k) / 500.0 * orbit.period);
    EXPECT_NEAR(now[0], points[k].q[0], 2e-12);
    EXPECT_NEAR(now[1], points[k].v[0], 2e-12);
    EXPECT_EQ(now[3], now[0]);
  }
}

TEST(Spectrum, OfAContactThatNeverSlips) {
  // Its velocity is the rounding of all others: it has no series, and needs none.
  constexpr int kMasses = 6;
  const HybridSystem system(fem::chain({.masses = kMasses, .damping = 0.05}),
                            {{Eigen::VectorXd::Unit(kMasses, 2), friction::Coulomb{50.0, 50.0}}},
                            friction::Force{0.7, {{.amplitude = 1.0}}}, {},
                            Eigen::MatrixXd(Eigen::VectorXd::Unit(kMasses, 5)));
  const PeriodicOrbit orbit = find_orbit(system, settled(system, system.rest(), 600.0));
  EXPECT_EQ(orbit.word, "0");
  const Spectrum spectrum = orbit_spectrum(system, orbit, 2, Eigen::VectorXd::Unit(kMasses, 5));
  // The masses beyond are a chain on a wall: (K + iωC − ω²M)⁻¹ there.
  Eigen::MatrixXd K(3, 3);
  K << 2, -1, 0, -1, 2, -1, 0, -1, 1;
  const Eigen::MatrixXcd D = K * std::complex<double>(1.0, 0.7 * 0.05) - 0.49 * Eigen::MatrixXcd::Identity(3, 3);
  const Eigen::VectorXcd expected = D.partialPivLu().solve(Eigen::VectorXcd::Unit(3, 2));
  EXPECT_NEAR(spectrum.row_displacement[0].amplitude()[1], std::abs(expected[2]), 1e-12);
  EXPECT_LT(spectrum.velocity[0].amplitude().maxCoeff(), 1e-14);
}

TEST(Spectrum, RefusesWhatHasNoMeaning) {
  const HybridSystem system = Backlash{.omega = 1.2}.system();
  const PeriodicOrbit orbit = find_orbit(system, settled(system, displaced(system, 0, 2.0), 60.0));
  EXPECT_THROW((void)orbit_spectrum(system, orbit, -1), InvalidInput);
  EXPECT_THROW((void)orbit_spectrum(system, orbit, 3, Eigen::MatrixXd::Ones(2, 1)), InvalidInput);
}

}  // namespace
}  // namespace slipmode::orbits
