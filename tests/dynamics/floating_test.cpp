// What floats has no rate of its own: a damper or a spring too weak to be felt, whose rate is no measure of anything,
// leaves its motion as it is.
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/dynamics/step_tables.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/masses.hpp>

#include <gtest/gtest.h>
#include <cmath>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Two masses that nothing but this holds or damps, shaken by friction, the second between stops.
HybridSystem two_carried_masses(double stiffness, double damping) {
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  const fem::Structure structure(fem::Matrix(Eigen::MatrixXd(Eigen::Vector2d(1.0, 0.7).asDiagonal())),
                                 fem::Matrix(Eigen::MatrixXd(damping * one)),
                                 fem::Matrix(Eigen::MatrixXd(stiffness * one)));
  const friction::Clearance stops{.left = friction::Stop{30.0, 0.3, 0.1},
                                  .right = friction::Stop{20.0, 0.1, 0.2},
                                  .loss = friction::ContactLoss::kGap};
  return {structure,
          {{Eigen::Vector2d(1.0, 0.0), friction::Coulomb{0.6, 0.3}, 1.5},
           {Eigen::Vector2d(-1.0, 1.0), friction::Coulomb{0.4, 0.2}, 0.7},
           {Eigen::Vector2d(0.0, 1.0), stops}},
          friction::Shaker{0.3, 0.5, 0.3}};
}

TEST(WhatFloats, MovesOnUnderADamperOrASpringThatIsNotFelt) {
  // Over 20 s a damper of d moves it by some 100 d. Times were told to 1e-15 of the slow decay, 0.1 s of 1e-14/s, and
  // a stop was met 0.3 s late.
  const SimulateOptions options{.duration = 20.0, .flow = {.method = FlowMethod::kClosedForm}};
  const HybridSystem free = two_carried_masses(0.0, 0.0);
  const Trajectory expected = simulate(free, free.rest(), options);
  EXPECT_GT(expected.events.size(), 40U);
  for (const auto& [stiffness, damping] : std::vector<std::pair<double, double>>{
           {0.0, 1e-18}, {0.0, 1e-16}, {0.0, 1e-14}, {0.0, 1e-12}, {1e-16, 0.0}, {1e-14, 0.0}, {1e-12, 0.0}}) {
    const HybridSystem system = two_carried_masses(stiffness, damping);
    const Trajectory run = simulate(system, system.rest(), options);
    const auto where = [&] { return testing::Message() << "stiffness " << stiffness << ", damping " << damping; };
    EXPECT_EQ(run.events.size(), expected.events.size()) << where();
    EXPECT_LT((run.final_state.q - expected.final_state.q).norm(), 1e-9) << where();
    EXPECT_LT((run.final_state.v - expected.final_state.v).norm(), 1e-9) << where();
    EXPECT_LT(std::abs(run.audit.residual()), 1e-12) << where();
  }
}

TEST(WhatFloats, HasGoneNowhereInAShortStepFarFromTheOrigin) {
  // Three masses at rest 1,000 m out, the first in oil. What they move by in a step was the difference of two states:
  // 10^-13 m however short the step, of which a spring of 10^6 N/m made forces (random scene 1423: 1007).
  const fem::Structure structure =
      fem::masses({.mass = {1.0, 1.4, 0.6}, .links = {{0, 1, 0.0, 0.1}, {1, 2, 1.3, 0.05}, {2, 3, 0.5, 0.01}}});
  const HybridSystem system(structure, {{Eigen::Vector3d(0.0, 1.0, 0.0), friction::Coulomb{0.6, 0.3}, 1.5}},
                            friction::Belt::constant(0.0));
  const ModalModel model = build_modal_model(system, false);
  const StepTables tables(model);
  const Eigen::VectorXd x = model.from_q * Eigen::Vector3d::Constant(1e3);
  for (int level = 0; level < 30; ++level) {
    Eigen::VectorXd moved(kNodes);
    tables.displacements(level).without_forces(x.data(), 1, moved.data());
    EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1e-12 * model.fastest * tables.step(level)) << "level " << level;
  }
}

TEST(WhatFloats, BeginsToMoveUnderForcesOnce) {
  // A mass that nothing holds, in oil, sticks and slides under two harmonics. That it had just begun to move was asked
  // of its state, and that it had grown of what is beside its steady answer: 19 of these 96 began anew every 5e-10 s.
  for (const double damping : {0.0, 0.012, 0.3, 3.0})
    for (int k = 0; k < 24; ++k) {
      SCOPED_TRACE(testing::Message() << "damping " << damping << ", phase " << k);
      const friction::Force force{2.2, {{.amplitude = 0.7, .phase = 0.26 * k}, {.amplitude = 1.1, .order = 3}}};
      const auto one = [](double value) { return fem::Matrix(Eigen::MatrixXd::Constant(1, 1, value)); };
      const HybridSystem system(fem::Structure(one(0.33), one(damping), one(0.0)),
                                {{Eigen::VectorXd::Ones(1), friction::Coulomb{0.4, 0.4}, 1.5}}, force,
                                Eigen::VectorXd(), Eigen::MatrixXd(Eigen::VectorXd::Ones(1)));
      const auto run = [&](FlowMethod method) {
        return simulate(system, system.rest(), {.duration = 10.0, .flow = {.method = method, .tolerance = 1e-11}});
      };
      const Trajectory exact = run(FlowMethod::kClosedForm), followed = run(FlowMethod::kCollocation);
      EXPECT_GT(exact.events.size(), 10U);
      EXPECT_LT(exact.statistics.steps, 200);
      EXPECT_EQ(exact.statistics.certified, exact.statistics.steps);
      EXPECT_NEAR(exact.final_state.q(0), followed.final_state.q(0), 1e-9);
      EXPECT_NEAR(exact.final_state.v(0), followed.final_state.v(0), 1e-9);
      EXPECT_LT(std::abs(exact.audit.residual()), 1e-12);
    }
}

TEST(WhatFloats, IsFollowedToTheToleranceByCollocation) {
  // A mass in oil, carried by friction of every kind. The tolerance was of the impulse in four radians of its decay, a
  // month: under a shaker and the tanh law the place was 70 % off after 20 s, at the tolerance that is the default.
  const auto one = [](double value) { return fem::Matrix(Eigen::MatrixXd::Constant(1, 1, value)); };
  const std::vector<friction::Law> laws{friction::TanhRegularised{0.6, 0.3, 3.0, 0.05},
                                        friction::Stribeck{0.6, 0.3, 3.0}, friction::Dahl{.mu = 0.4, .stiffness = 50.0},
                                        friction::LuGre{0.6, 0.3, 0.1, 80.0, 0.5, 0.01}};
  const std::vector<friction::Drive> drives{friction::Shaker{0.3, 1.0, 0.3}, friction::Belt::constant(0.3),
                                            friction::Belt::ramp(0.0, 0.4, 1.0, 2.0)};
  for (const double damping : {0.0, 1e-12, 1e-6})
    for (std::size_t drive = 0; drive < drives.size(); ++drive)
      for (std::size_t law = 0; law < laws.size(); ++law) {
        const HybridSystem system(fem::Structure(one(1.0), one(damping), one(0.0)),
                                  {{Eigen::VectorXd::Ones(1), laws[law], 1.5}}, drives[drive]);
        const auto end = [&](double tolerance) {
          return simulate(system, system.rest(),
                          {.duration = 20.0, .flow = {.method = FlowMethod::kCollocation, .tolerance = tolerance}})
              .final_state;
        };
        const State usual = end(1e-9), tight = end(1e-13);
        const auto where = [&] {
          return testing::Message() << "damping " << damping << ", drive " << drive << ", law " << law;
        };
        EXPECT_LT(std::abs(usual.q(0) - tight.q(0)), 1e-8) << where();
        EXPECT_LT(std::abs(usual.v(0) - tight.v(0)), 1e-8) << where();
      }
}

TEST(WhatFloats, KeepsItsMomentumBehindAnySpringBetweenItsMasses) {
  // The spring that a belt winds up pushes both masses alike. What rounding left of its direction in the motion of all
  // made K_c ε times the belt's way a force on them: 2e-7 of a momentum, and 4e-9 of the energy, for K_c = 1e7.
  const Eigen::VectorXd mass{{1.05, 1.5, 0.4, 0.98, 0.6}};
  for (const double stiffness : {1e3, 1e5, 1e7}) {
    SCOPED_TRACE(stiffness);
    const HybridSystem system(
        fem::chain({.masses = 5, .mass = {mass.begin(), mass.end()}, .damping = 0.03, .left_fixed = false}),
        {{Eigen::VectorXd{{0.0, -1.0, 0.0, 1.0, 0.0}}, friction::CompliantCoulomb{100.0, 100.0, stiffness}, 1.0}},
        friction::Belt::constant(0.2));
    State start = system.rest();
    start.q = Eigen::VectorXd{{0.4, 1.0, -0.2, 0.9, 0.1}};
    start.v = Eigen::VectorXd{{-0.3, 0.2, 0.5, 0.4, -0.6}};
    const Trajectory run = simulate(system, start, {.duration = 20.0, .flow = {.method = FlowMethod::kClosedForm}});
    EXPECT_NEAR(mass.dot(run.final_state.v), mass.dot(start.v), 1e-14);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
  }
}

}  // namespace
}  // namespace slipmode::dynamics
