// What is refused, at the boundary and by name.
#include <slipmode/core/errors.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

HybridSystem chain() { return belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2)); }

void refuse(const State& start, const SimulateOptions& options) {
  EXPECT_THROW((void)simulate(chain(), start, options), InvalidInput);
}

TEST(BadInput, ClosedFormRefusesLawsThatAreNotPiecewiseLinear) {
  const SimulateOptions exact{.duration = 1.0, .flow = {.method = FlowMethod::kClosedForm}};
  refuse(chain().rest(), exact);
  const HybridSystem smooth = belt_chain(friction::TanhRegularised{0.4, 0.2, 8.0, 1e-2}, Belt::constant(0.2));
  EXPECT_THROW((void)simulate(smooth, smooth.rest(), exact), InvalidInput);
  // Stribeck without a slope is Coulomb: allowed.
  const HybridSystem flat = belt_chain(Stribeck{0.3, 0.3, 8.0}, Belt::constant(0.2));
  EXPECT_NO_THROW((void)simulate(flat, flat.rest(), exact));
}

TEST(BadInput, ForcesNeedTheirDirections) {
  const HybridSystem gap = backlash_mass(1.0);
  EXPECT_THROW((void)gap.with_drive(friction::Force{1.0, {{.amplitude = 1.0, .direction = 1}}}), InvalidInput);
  EXPECT_THROW((void)HybridSystem(gap.structure(), gap.contacts(), gap.drive(), {}, Eigen::MatrixXd::Ones(2, 1)),
               InvalidInput);
}

TEST(BadInput, AClearanceIsWhereItsStateSaysItIs) {
  const HybridSystem gap = backlash_mass(1.0);
  State start = gap.rest();
  start.modes = {ContactMode::kRightStop};
  EXPECT_THROW((void)simulate(gap, start, {.duration = 1.0}), InvalidInput);
  start.q(0) = 1.5;
  EXPECT_NO_THROW((void)simulate(gap, start, {.duration = 1.0}));
}

TEST(BadInput, SizesTimesAndTolerances) {
  const State rest = chain().rest();
  refuse(state(Eigen::VectorXd::Zero(9), Eigen::VectorXd::Zero(10)), {.duration = 1.0});
  refuse(state(Eigen::VectorXd::Zero(10), Eigen::VectorXd::Zero(11)), {.duration = 1.0});
  refuse(state(Eigen::VectorXd::Constant(10, kNan), Eigen::VectorXd::Zero(10)), {.duration = 1.0});
  refuse(state(Eigen::VectorXd::Zero(10), Eigen::VectorXd::Zero(10), kNan), {.duration = 1.0});
  refuse(rest, {.duration = -1.0});
  refuse(rest, {.duration = kNan});
  refuse(rest, {.duration = 1.0, .transient = -1.0});
  refuse(rest, {.duration = 1.0, .sample = -0.1});
  refuse(rest, {.duration = 1.0, .flow = {.tolerance = 0.0}});
  refuse(rest, {.duration = 1.0, .flow = {.tolerance = kNan}});
}

TEST(BadInput, NothingToDoIsNoError) {
  const Trajectory run = simulate(chain(), chain().rest(), {.duration = 0.0});
  EXPECT_TRUE(run.events.empty());
  EXPECT_EQ(run.final_state.time, 0.0);
}

TEST(BadInput, SystemsThatMakeNoSense) {
  const fem::Structure structure = fem::chain({.masses = 3});
  const auto make = [&](std::vector<friction::Contact> contacts, Belt belt, Eigen::VectorXd load) {
    return HybridSystem(structure, std::move(contacts), belt, std::move(load));
  };
  const Belt belt = Belt::constant(0.1);
  const friction::Contact good{unit(3, 2), Coulomb{0.4, 0.2}, 1.0};
  EXPECT_NO_THROW((void)make({good}, belt, {}));
  EXPECT_NO_THROW((void)make({}, belt, {}));
  EXPECT_THROW((void)make({{unit(4, 2), Coulomb{0.4, 0.2}, 1.0}}, belt, {}), InvalidInput);
  EXPECT_THROW((void)make({{Eigen::VectorXd::Zero(3), Coulomb{0.4, 0.2}, 1.0}}, belt, {}), InvalidInput);
  EXPECT_THROW((void)make({{unit(3, 2), Coulomb{0.1, 0.2}, 1.0}}, belt, {}), InvalidInput);
  EXPECT_THROW((void)make({{unit(3, 2), Coulomb{0.4, 0.2}, -1.0}}, belt, {}), InvalidInput);
  EXPECT_THROW((void)make({good, good}, belt, {}), InvalidInput);
  EXPECT_THROW((void)make({good}, Belt::constant(kNan), {}), InvalidInput);
  EXPECT_THROW((void)make({good}, belt, Eigen::VectorXd::Zero(2)), InvalidInput);
  EXPECT_THROW((void)make({good}, belt, Eigen::VectorXd::Constant(3, kNan)), InvalidInput);
}

TEST(BadInput, AStructureWithoutContactsSwingsFreely) {
  const HybridSystem free(fem::chain({.masses = 1}), {}, Belt::constant(0.1));
  const Trajectory run = simulate(free, state(Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1)), {.duration = 2.0});
  EXPECT_NEAR(run.final_state.q[0], std::cos(2.0), 1e-12);
}

}  // namespace
}  // namespace slipmode::dynamics
