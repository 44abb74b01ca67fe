// A law made of the program's own functions on the collocation flow.
#include "fixtures/runge_kutta_reference.hpp"
#include "fixtures/scenes.hpp"

#include <slipmode/core/errors.hpp>

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Characteristic;
using friction::Shaker;
using friction::Stribeck;

constexpr FlowOptions kTightest{.tolerance = 1e-13};

/// Stribeck's law by its formula.
Characteristic as_functions(const Stribeck& law) {
  return {.mu_s = law.mu_s,
          .mu = [law](double v) { return law.mu_k + (law.mu_s - law.mu_k) * std::exp(-law.alpha * v); },
          .slope = [law](double v) { return -law.alpha * (law.mu_s - law.mu_k) * std::exp(-law.alpha * v); }};
}

/// A law nobody shipped: a jump at the start of sliding, then a dip and a bump that die out.
Characteristic bumpy() {
  return {.mu_s = 0.35,
          .mu = [](double v) { return 0.2 * (1.0 - 0.5 * std::sin(6.0 * v) * std::exp(-v)); },
          .slope = [](double v) { return 0.1 * (std::sin(6.0 * v) - 6.0 * std::cos(6.0 * v)) * std::exp(-v); }};
}

void expect_same(const HybridSystem& a, const HybridSystem& b, const State& start, double duration) {
  const SimulateOptions options{.duration = duration, .sample = 0.1, .flow = kTightest};
  const Trajectory run = simulate(a, start, options), other = simulate(b, start, options);
  ASSERT_EQ(run.events.size(), other.events.size());
  EXPECT_GE(run.events.size(), 4u);
  for (std::size_t k = 0; k < run.events.size(); ++k) {
    EXPECT_EQ(run.events[k].kind, other.events[k].kind);
    EXPECT_EQ(run.events[k].contact, other.events[k].contact);
    EXPECT_NEAR(run.events[k].time, other.events[k].time, 1e-12 * duration) << k;
  }
  EXPECT_LT((run.q - other.q).cwiseAbs().maxCoeff(), 1e-12 * run.q.cwiseAbs().maxCoeff());
  EXPECT_LT((run.v - other.v).cwiseAbs().maxCoeff(), 1e-12 * run.v.cwiseAbs().maxCoeff() * duration);
}

TEST(Characteristic, WithStribecksFormulaItMovesAsStribeck) {
  // One contact (Stribeck's own kernel against the general solver), two contacts, a shaker.
  const Stribeck law{0.4, 0.2, 2.0};
  for (const std::uint64_t seed : {1u, 2u, 3u})
    expect_same(belt_chain(law, Belt::constant(0.3), 4), belt_chain(as_functions(law), Belt::constant(0.3), 4),
                swinging(4, seed, 1.5), 20.0);
  const auto two = [](friction::Law first, friction::Law second) {
    return HybridSystem(fem::chain({.masses = 4, .damping = 0.02}),
                        {{unit(4, 3), std::move(first), 1.5}, {unit(4, 1), std::move(second), 0.7}},
                        Belt::ramp(0.4, -0.2, 3.0, 9.0));
  };
  const Stribeck other{0.3, 0.15, 3.0};
  expect_same(two(law, other), two(as_functions(law), as_functions(other)), swinging(4, 1, 1.5), 12.0);
  const Shaker shaker{0.4, 0.11, 0.3};
  expect_same(oscillator(1.0, 1.0, 0.05, law, 1.0, shaker), oscillator(1.0, 1.0, 0.05, as_functions(law), 1.0, shaker),
              state(Eigen::VectorXd::Constant(1, 1.0), Eigen::VectorXd::Zero(1)), 30.0);
}

TEST(Characteristic, WithBoundsItsStepsAreCertified) {
  const Stribeck law{0.4, 0.2, 2.0};
  Characteristic functions = as_functions(law);
  const auto run_of = [](const Characteristic& own) {
    return simulate(belt_chain(own, Belt::constant(0.3), 4), swinging(4, 1, 1.5),
                    {.duration = 200.0, .flow = {.certify = true}});
  };
  EXPECT_EQ(run_of(functions).statistics.certified, 0);
  functions.bounds = [law](double from, double) {
    const double slope = law.alpha * (law.mu_s - law.mu_k) * std::exp(-law.alpha * from);
    return friction::LawBounds{slope, law.alpha * slope};
  };
  functions.most = law.mu_s;
  const Trajectory run = run_of(functions);
  EXPECT_GT(run.events.size(), 20U);
  EXPECT_GT(run.statistics.certified, 0.98 * static_cast<double>(run.statistics.steps));
}

TEST(Characteristic, ALawNobodyShippedFollowsRungeKutta) {
  // Runge-Kutta in long double, step 1e-3 of rates below 4 (chain) and 2 (law): error of the order of 1e-12.
  const HybridSystem chain = belt_chain(bumpy(), Belt::constant(0.15), 3, 0.006, 1.0);
  const State start{.q = Eigen::VectorXd::Zero(3), .v = Eigen::VectorXd::Zero(3)};
  const double duration = 40.0;
  const Trajectory run = simulate(chain, start, {.duration = duration, .flow = kTightest});
  RungeKuttaReference reference(chain, RungeKuttaReference::Mode::kPositive);
  reference.run(duration, 1e-3L);
  ASSERT_EQ(run.events.size(), reference.changes().size());
  EXPECT_GE(run.events.size(), 6u);
  for (std::size_t k = 0; k < run.events.size(); ++k) {
    EXPECT_EQ(static_cast<int>(run.events[k].after), reference.changes()[k].mode);
    EXPECT_NEAR(run.events[k].time, reference.changes()[k].time, 1e-10) << k;
  }
  EXPECT_LT((run.final_state.q - reference.q()).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((run.final_state.v - reference.v()).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Characteristic, EnergyClosesInLongRuns) {
  for (const Characteristic& law : {bumpy(), as_functions({0.4, 0.2, 8.0})}) {
    const HybridSystem chain = belt_chain(law, Belt::constant(0.2));
    const Trajectory run = simulate(chain, swinging(10, 1, 1.5), {.duration = 500.0});
    EXPECT_GE(run.events.size(), 20u);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9);
    EXPECT_GT(run.audit.friction_loss, 0.0);
  }
}

TEST(Characteristic, WhatItsFunctionsSayBelowZeroChangesNoResult) {
  // Constant below zero instead of smooth: a kink where a step may pass, which costs steps alone.
  Characteristic cut = as_functions({0.4, 0.2, 2.0});
  cut.mu = [mu = cut.mu](double v) { return mu(std::max(v, 0.0)); };
  cut.slope = [slope = cut.slope](double v) { return v < 0.0 ? 0.0 : slope(v); };
  const auto run = [](const Characteristic& law) {
    return simulate(belt_chain(law, Belt::constant(0.3), 4), swinging(4, 1, 1.5),
                    {.duration = 14.0, .flow = {.tolerance = 1e-11}});
  };
  const Trajectory smooth = run(as_functions({0.4, 0.2, 2.0})), kinked = run(cut);
  ASSERT_EQ(smooth.events.size(), kinked.events.size());
  EXPECT_LT((smooth.final_state.q - kinked.final_state.q).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Characteristic, GoesWithTheFlowsStribeckGoesWith) {
  const HybridSystem chain = belt_chain(bumpy(), Belt::constant(0.2), 3);
  EXPECT_THROW((void)simulate(chain, chain.rest(), {.duration = 1.0, .flow = {.method = FlowMethod::kClosedForm}}),
               InvalidInput);
}

}  // namespace
}  // namespace slipmode::dynamics
