// Den Hartog's oscillator with stops: m ẍ + k x + F sign ẋ = P cos ωt, one stop or several each half cycle, against its
// sliding arcs in closed form. (Without stops: friction_orbits_test.cpp.)
#include <slipmode/orbits/shooting.hpp>
#include "fixtures/differences.hpp"
#include "fixtures/stopping_oscillator.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

using dynamics::EventKind;
using fixtures::StoppingOscillator;

void expect_slides(const StoppingOscillator& o, std::size_t stops) {
  const std::vector<StoppingOscillator::Slide> expected = o.cycle();
  ASSERT_EQ(expected.size(), stops);
  EXPECT_LT(std::abs(expected.front().from + expected.back().to), 1e-13);
  const dynamics::HybridSystem system = o.system();
  const PeriodicOrbit orbit = find_orbit(system, settle_guess(system, system.rest(), 20.0));
  // What stops forgets its velocity and keeps its place: multipliers 0 and the square of d(last place)/d(first place).
  const auto last = [&](double step) { return o.half_cycle(expected.front().from + step).back().to; };
  const double half = fixtures::slope(last, 1e-4);
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
