// The energy balance closes: E_end − E_start = ∫ Σ λ wᵀq̇ dt − ∫ q̇ᵀC q̇ dt, an identity of the equations of motion.
#include <slipmode/fem/masses.hpp>
#include "fixtures/scenes.hpp"
#include "fixtures/taylor_reference.hpp"

#include <gtest/gtest.h>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;

void expect_closed(const HybridSystem& system, const State& start, double duration, const FlowOptions& flow) {
  const Trajectory run = simulate(system, start, {.duration = duration, .flow = flow});
  const EnergyAudit& audit = run.audit;
  EXPECT_LT(std::abs(audit.residual()), 1e-9);
  EXPECT_GT(audit.exchanged, 0.0);
  EXPECT_NEAR(audit.energy_start, system.energy(start), 1e-12 * (1.0 + std::abs(audit.energy_start)));
  EXPECT_NEAR(audit.energy_end, system.energy(run.final_state), 1e-9 * (1.0 + std::abs(audit.energy_end)));
  EXPECT_NEAR(audit.contact_work, audit.drive_work - audit.friction_loss, 1e-9 * audit.exchanged);
  EXPECT_GE(audit.friction_loss, -1e-12 * audit.exchanged);
  EXPECT_GE(audit.viscous_loss, 0.0);
}

TEST(Energy, ClosesOverTenThousandUnitsForTheStribeckChain) {
  const HybridSystem chain = belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2));
  expect_closed(chain, chain.rest(), 1e4, {});
}

TEST(Energy, ClosesOverTenThousandUnitsForTheCoulombChainByBothFlows) {
  const HybridSystem chain = belt_chain(friction::Coulomb{0.4, 0.2}, Belt::constant(0.2));
  expect_closed(chain, chain.rest(), 1e4, {.method = FlowMethod::kClosedForm});
  expect_closed(chain, chain.rest(), 1e4, {.method = FlowMethod::kCollocation});
}

TEST(Energy, ClosesForAHundredMassesAndForTheTanhLaw) {
  const HybridSystem large =
      belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2), 100, 0.006, 3.0, {0.25});
  expect_closed(large, large.rest(), 2e3, {});
  const HybridSystem smooth = belt_chain(friction::TanhRegularised{0.4, 0.2, 8.0, 0.05}, Belt::constant(0.2));
  expect_closed(smooth, smooth.rest(), 1e3, {});
}

TEST(Energy, ClosesWithALoadARampAndGeneralDamping) {
  Draws random(4);
  Eigen::MatrixXd A(6, 6), M(6, 6), C(6, 6);
  for (auto* matrix : {&A, &M, &C}) {
    for (double& value : matrix->reshaped()) value = random.uniform(-1.0, 1.0);
  }
  const Eigen::MatrixXd K = A * A.transpose() + 0.5 * Eigen::MatrixXd::Identity(6, 6);
  const Eigen::MatrixXd mass = 0.2 * M * M.transpose() + Eigen::MatrixXd::Identity(6, 6);
  const Eigen::MatrixXd damping = 0.02 * C * C.transpose();  // not a combination of M and K
  const HybridSystem system(fem::Structure(mass, damping, K),
                            {{random.vector(6, 1.0), friction::Stribeck{0.5, 0.2, 3.0}, 1.0},
                             {random.vector(6, 1.0), friction::Coulomb{0.4, 0.3}, 0.5}},
                            Belt::ramp(0.4, -0.2, 100.0, 300.0), random.vector(6, 0.3));
  expect_closed(system, random_state(random, 6, 1.0), 500.0, {});
}

TEST(Energy, ClosesUnderAShakerThatHardlyPulls) {
  // Speeds of 10^-6 m/s beside the shaker's of 7 and 240. A contact that turned was put at the shaker's speed, which is
  // off by what the event's time rounds by: 5e-9 of the energy, 2e-7 under the larger one.
  const friction::Coulomb weak{0.7, 0.5};
  for (const double amplitude : {2.7, 100.0})
    for (const int contacts : {1, 2}) {
      SCOPED_TRACE(testing::Message() << "amplitude " << amplitude << ", contacts " << contacts);
      std::vector<friction::Contact> pulled{{Eigen::Vector3d(0.0, 1.0, 0.0), weak, 2e-6},
                                            {Eigen::Vector3d(0.0, 0.0, 1.0), weak, 1e-6}};
      pulled.resize(static_cast<std::size_t>(contacts));
      const HybridSystem system(fem::chain({.masses = 3, .ground_stiffness = {0.4}, .damping = 0.012}), pulled,
                                friction::Shaker{amplitude, 0.389, 3.0});
      const Trajectory run = simulate(system, system.rest(), {.duration = 40.0});
      EXPECT_GT(run.events.size(), 25U);
      EXPECT_LT(run.final_state.q.cwiseAbs().maxCoeff(), 1e-4);
      EXPECT_LT(std::abs(run.audit.residual()), 1e-12);
    }
}

TEST(Energy, ClosesWhereClockAndMotionHaveLongToPart) {
  // Undamped masses under a force beside a natural frequency (0.7092) beat for ever. Work is of the force's phase at
  // the clock's times: were these off by roundings of the time at each step, by 1e-7 after 60,000 units, the balance
  // would be by 1e-8. What is left, of rounding 3e5 phases, is below 1e-11.
  const friction::Stop far{.stiffness = 1.0, .gap = 1e3};
  const HybridSystem system(
      fem::masses({.mass = std::vector<double>(6, 1.0),
                   .links = {{0, 1, 1.0}, {1, 2, 1.0}, {2, 3, 1.0}, {3, 4, 1.0}, {4, 5, 1.0}, {5, 6, 1.0}}}),
      {{Eigen::VectorXd::Unit(6, 5), friction::Clearance{far, far}}}, friction::Force{0.711, {{.amplitude = 0.01}}}, {},
      Eigen::VectorXd::Unit(6, 0));
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const Trajectory run = simulate(system, system.rest(), {.duration = 6e4, .flow = {.method = method}});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
  }
}

TEST(Energy, WorkAndLossesAgreeWithQuadratureOfTheReference) {
  // The audit could close and still split wrongly: integrate each part from the Taylor series (composite Gauss rule of
  // 5 points on 16 pieces of each Taylor step).
  const HybridSystem chain = belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2));
  Draws random(2);
  const State start = random_state(random, 10, 1.5);
  const Trajectory run = simulate(chain, start, {.duration = 60.0, .flow = {.tolerance = 1e-12}});

  const ReferenceModel model = reference_of(chain);
  long double drive = 0, friction_loss = 0, viscous = 0;
  const long double nodes[] = {0.0L, 0.538469310105683091036314420700L, 0.906179845938663992797626878299L};
  const long double weights[] = {0.568888888888888888888888888889L, 0.478628670499366468041291514836L,
                                 0.236926885056189087514264040720L};
  TaylorReference<long double> reference(model);
  const ReferenceRun expected = reference.run(
      start.q, start.v, 0.0, 60.0, [&](long double, long double h, const TaylorSeries<long double>& series) {
        for (int piece = 0; piece < 16; ++piece) {
          for (int i = -2; i <= 2; ++i) {
            const long double x = (i < 0 ? -1 : 1) * nodes[std::abs(i)];
            const long double tau = h * (piece + (1 + x) / 2) / 16;
            const long double weight = weights[std::abs(i)] * h / 32;
            const long double lambda = horner(series.force(0), tau);
            const Eigen::VectorXd v = series.velocity_at(tau).cast<double>();
            drive += weight * lambda * 0.2L;
            friction_loss += weight * lambda * horner(series.slip_velocity(0), tau);
            viscous += weight * v.dot(model.C * v);
          }
        }
      });
  EXPECT_LT((expected.q - run.final_state.q).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(run.audit.drive_work, static_cast<double>(drive), 1e-9 * run.audit.exchanged);
  EXPECT_NEAR(run.audit.friction_loss, static_cast<double>(friction_loss), 1e-9 * run.audit.exchanged);
  EXPECT_NEAR(run.audit.viscous_loss, static_cast<double>(viscous), 1e-9 * run.audit.exchanged);
}

}  // namespace
}  // namespace slipmode::dynamics
