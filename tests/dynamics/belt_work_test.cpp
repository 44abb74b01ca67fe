// The energy audit under a belt of constant speed, in closed form.
#include "dynamics/internal/belt_work.hpp"
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/masses.hpp>
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace slipmode::dynamics {
namespace {

TEST(BeltWork, AgreesWithQuadrature) {
  // A belt whose ramp lies in the future moves the same, and is audited by quadrature.
  const double duration = 60.0, speed = 0.2;
  const friction::Belt later = friction::Belt::ramp(speed, 2.0 * speed, 10.0 * duration, 11.0 * duration);
  for (const double damping : {0.0, 0.02})
    for (const friction::Law& law :
         {friction::Law(friction::Coulomb{0.5, 0.3}), friction::Law(friction::CompliantCoulomb{0.5, 0.3, 20.0})}) {
      const HybridSystem system = fixtures::belt_chain(law, friction::Belt::constant(speed), 5, damping, 1.0);
      const State start = fixtures::swinging(5, 3, 1.0);
      const SimulateOptions options{.duration = duration, .flow = {.method = FlowMethod::kClosedForm}};
      const Trajectory by_forms = simulate(system, start, options);
      const EnergyAudit a = by_forms.audit, b = simulate(system.with_drive(later), start, options).audit;
      EXPECT_GT(by_forms.events.size(), 10u);
      EXPECT_LT(std::abs(a.residual()), 1e-12);
      EXPECT_NEAR(a.contact_work, b.contact_work, 1e-12 * b.exchanged);
      EXPECT_NEAR(a.drive_work, b.drive_work, 1e-12 * b.exchanged);
      EXPECT_NEAR(a.viscous_loss, b.viscous_loss, 1e-12 * b.exchanged);
    }
}

TEST(BeltWork, BalancesHoweverFarABeltHasCarriedWhatFloats) {
  // Two masses carried along by a belt behind a stiff spring: its force is what the belt's way and theirs leave of one
  // another, and must do no work by their rounding, 2e-5 of what is exchanged for the stiffest and longest of these.
  for (const double stiffness : {2e3, 2e4, 1e6})
    for (const double duration : {100.0, 1000.0}) {
      const HybridSystem system(
          fem::masses({.mass = {1.0, 2.0}, .links = {{.first = 1, .second = 2, .stiffness = 1.0, .damping = 0.1}}}),
          {{fixtures::unit(2, 0), friction::CompliantCoulomb{100.0, 100.0, stiffness}, 1.0}},
          friction::Belt::constant(3.0));
      State start = system.rest();
      start.v(0) = 0.5;
      start.q(1) = 0.2;
      const Trajectory run = simulate(system, start, {.duration = duration, .sample = duration / 10.0});
      EXPECT_LT(std::abs(run.audit.residual()), 1e-9) << stiffness << ' ' << duration;
    }
}

TEST(BeltWork, IsThereForComplexModesAndForcesThatVary) {
  // Else both runs of the comparisons would be quadratures.
  const auto work_of = [](const friction::Contact& contact, ContactRole role, bool& out_real) {
    const HybridSystem system(fem::chain({.masses = 4, .damping = 0.05}), {contact}, friction::Belt::constant(0.2));
    const RegimeTables& tables = system.cache().regime(system, {role});
    out_real = tables.regime().pairs.proportional;
    return BeltWork::make(tables, system.cache().tables(system, false).model) != nullptr;
  };
  friction::Contact sprung{.direction = fixtures::unit(4, 3), .law = friction::CompliantCoulomb{0.5, 0.3, 20.0}};
  friction::Contact varying{.direction = fixtures::unit(4, 3), .law = friction::Coulomb{0.5, 0.3}};
  varying.normal_load.slope = -0.1;
  bool real = true;
  EXPECT_TRUE(work_of(sprung, ContactRole::kSprung, real));
  EXPECT_FALSE(real);
  EXPECT_TRUE(work_of(varying, ContactRole::kSlidingPositive, real));
}

}  // namespace
}  // namespace slipmode::dynamics
