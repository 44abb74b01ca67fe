// Den Hartog's oscillator with stops: m ẍ + k x + F sign ẋ = P cos ωt, one stop or several each half cycle, against its
// sliding arcs in closed form. (Without stops: friction_orbits_test.cpp.)
#include <slipmode/orbits/shooting.hpp>
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

using dynamics::EventKind;

struct StoppingOscillator {
  double mass = 1.3, stiffness = 2.1, push = 1.7;
  double friction = 0.4, ratio = 0.3;  ///< F/P, ω/√(k/m)

  struct Slide {
    double begin, from, end, to;  ///< phase of the push [rad] and place [m] of its release and of its stop
  };
  [[nodiscard]] double limit() const { return friction * push; }
  [[nodiscard]] double natural() const { return std::sqrt(stiffness / mass); }
  [[nodiscard]] double omega() const { return ratio * natural(); }

  /// Upwards from rest at x as the push rises to kx + F: x(τ) = a cos ω₀τ + b sin ω₀τ + X cos θ − F/k, until ẋ = 0.
  [[nodiscard]] Slide slide_up(double x) const {
    const double begin = -std::acos((limit() + stiffness * x) / push);
    const double forced = push / (stiffness - mass * omega() * omega()), shift = limit() / stiffness;
    const double a = x - forced * std::cos(begin) + shift, b = ratio * forced * std::sin(begin);
    const auto speed = [&](double tau) {
      return natural() * (b * std::cos(natural() * tau) - a * std::sin(natural() * tau)) -
             omega() * forced * std::sin(begin + omega() * tau);
    };
    const double step = 1e-3 / natural();  // ẋ grows as τ² at first
    double low = step;
    while (speed(low + step) > 0.0) low += step;
    double high = low + step;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      (speed(middle) > 0.0 ? low : high) = middle;
    }
    const double end = begin + omega() * low;
    return {begin, x, end,
            a * std::cos(natural() * low) + b * std::sin(natural() * low) + forced * std::cos(end) - shift};
  }

  /// The slides of a half cycle from the lowest place on: up again as long as the rising push gets the better of F.
  [[nodiscard]] std::vector<Slide> half_cycle(double lowest) const {
    std::vector<Slide> slides{slide_up(lowest)};
    while (slides.back().end < 0.0 && push - stiffness * slides.back().to > limit())
      slides.push_back(slide_up(slides.back().to));
    return slides;
  }
  /// That of the periodic motion: what starts from −(where it ends) is its mirror image.
  [[nodiscard]] std::vector<Slide> cycle() const {
    double lowest = -(push - limit()) / stiffness;
    for (int turn = 0; turn < 500; ++turn) lowest = -half_cycle(lowest).back().to;
    return half_cycle(lowest);
  }
  [[nodiscard]] dynamics::HybridSystem system() const {
    dynamics::HybridSystem plain = fixtures::oscillator(mass, stiffness, 0.0, friction::Coulomb{0.5, 0.5},
                                                        limit() / 0.5, friction::Belt::constant(0.0));
    const friction::Force force{omega(), {{.amplitude = push, .phase = 0.5 * std::numbers::pi}}};
    return {plain.structure(), plain.contacts(), force, {}, Eigen::MatrixXd::Ones(1, 1)};
  }
};

void expect_slides(const StoppingOscillator& o, std::size_t stops) {
  const std::vector<StoppingOscillator::Slide> expected = o.cycle();
  ASSERT_EQ(expected.size(), stops);
  EXPECT_LT(std::abs(expected.front().from + expected.back().to), 1e-13);
  const dynamics::HybridSystem system = o.system();
  const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 20.0));
  // What stops forgets its velocity and keeps its place: multipliers 0 and the square of d(last place)/d(first place).
  const auto last = [&](double step) { return o.half_cycle(expected.front().from + step).back().to; };
  const double h = 1e-4, half = (8.0 * (last(h) - last(-h)) - (last(2.0 * h) - last(-2.0 * h))) / (12.0 * h);
  EXPECT_NEAR(orbit.leading_modulus, half * half, 1e-8);
  EXPECT_EQ(orbit.zero_multipliers, 1);
  ASSERT_EQ(orbit.events.size(), 4 * stops);
  std::vector<double> found, wanted;
  for (const dynamics::Event& e : orbit.events) {
    EXPECT_TRUE(e.kind == EventKind::kRelease || e.kind == EventKind::kStick);
    found.push_back(e.displacement);
  }
  for (const StoppingOscillator::Slide& s : expected) wanted.insert(wanted.end(), {s.from, s.to, -s.from, -s.to});
  std::ranges::sort(found);
  std::ranges::sort(wanted);
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-11) << i;
  // Phases of the upward releases and of their stops.
  const double period = 2.0 * std::numbers::pi / o.omega();
  for (const StoppingOscillator::Slide& s : expected)
    for (const double phase : {s.begin, s.end}) {
      double nearest = period;
      for (const dynamics::Event& e : orbit.events)
        nearest = std::min(nearest, std::abs(std::remainder(e.time - phase / o.omega(), period)));
      EXPECT_LT(nearest, 1e-7) << phase;  // at a release ẋ is of second order in time
    }
}

TEST(DenHartogStops, OneStopEachHalfCycle) {
  expect_slides({.friction = 0.7, .ratio = 0.6}, 1);
  expect_slides({.friction = 0.5, .ratio = 0.5}, 1);
  expect_slides({.friction = 0.2, .ratio = 0.17}, 1);
}

TEST(DenHartogStops, SeveralStopsEachHalfCycle) {
  expect_slides({.friction = 0.1, .ratio = 0.3}, 2);
  expect_slides({.friction = 0.3, .ratio = 0.22}, 2);
  expect_slides({.friction = 0.3, .ratio = 0.07}, 3);
  expect_slides({.friction = 0.5, .ratio = 0.07}, 4);
}

}  // namespace
}  // namespace slipmode::orbits
