// The tangent flow of the closed form: saltation at stops, contact springs, lost contact, stick and their mixtures.
#include <slipmode/dynamics/simulate.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/shaken_scenes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <functional>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;

struct Differences {
  Eigen::MatrixXd matrix;
  bool smooth = true;  ///< every motion met the same events in the same order, and two steps agree
};

/// Fourth-order central differences of the end state. Where the order of events changes within the step, or a crossing
/// comes close to grazing, there is nothing smooth to compare with.
Differences by_differences(const HybridSystem& system, const State& start, double duration) {
  Differences out;
  const SimulateOptions options{.duration = duration, .flow = {.method = FlowMethod::kClosedForm, .audit = false}};
  const std::vector<Event> events = simulate(system, start, options).events;
  const auto end_of = [&](const State& from) {
    const Trajectory run = simulate(system, from, options);
    out.smooth &= run.events.size() == events.size();
    for (std::size_t k = 0; out.smooth && k < events.size(); ++k)
      out.smooth &= run.events[k].contact == events[k].contact && run.events[k].after == events[k].after;
    return stacked(run.final_state);
  };
  out.matrix = slopes(start, end_of, 1e-5);
  const Eigen::MatrixXd coarse = slopes(start, end_of, 3e-5);
  out.smooth &= (coarse - out.matrix).cwiseAbs().maxCoeff() < 1e-7 * out.matrix.cwiseAbs().maxCoeff();
  return out;
}

/// A point of the motion where no rigid contact sticks: there velocities may be moved.
State free_start(const HybridSystem& system) {
  const bool rigid = std::holds_alternative<friction::Coulomb>(system.contacts().front().law);
  State at = simulate(system, system.rest(), {.duration = 1.234, .flow = {.audit = false}}).final_state;
  for (int k = 0; k < 50 && rigid && at.modes.front() == ContactMode::kStick; ++k)
    at = simulate(system, at, {.duration = 0.05, .flow = {.audit = false}}).final_state;
  return at;
}

/// Compares random systems; returns how many had smooth differences to compare with.
int expect_differences(const std::function<HybridSystem(unsigned)>& make, unsigned seeds, double duration) {
  int compared = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(seed);
    const HybridSystem system = make(seed);
    const State start = free_start(system);
    if (std::holds_alternative<friction::Coulomb>(system.contacts().front().law) &&
        start.modes.front() == ContactMode::kStick)
      continue;  // never free
    const TangentResult tangent = tangent_flow(system, start, duration, {.method = FlowMethod::kClosedForm});
    const Trajectory run = simulate(system, start, {.duration = duration});
    EXPECT_LT((stacked(tangent.end) - stacked(run.final_state)).cwiseAbs().maxCoeff(), 1e-12);
    const Differences expected = by_differences(system, start, duration);
    if (!expected.smooth) continue;
    ++compared;
    const double size = std::max(1.0, expected.matrix.cwiseAbs().maxCoeff());
    EXPECT_LT((tangent.monodromy - expected.matrix).cwiseAbs().maxCoeff(), 1e-7 * size);
  }
  return compared;
}

TEST(ClearanceTangent, EqualsCentralDifferences) {
  EXPECT_GE(expect_differences([](unsigned seed) { return random_clearances(seed); }, 80, 8.0), 60);
}

TEST(ClearanceTangent, DeterminantIsTheDampingMetOnTheWay) {
  // Volumes shrink by the damping alone, and reaching a stop of one mass keeps them: saltation [1 0; s 1].
  for (const double omega : {0.3, 0.65, 1.1}) {
    const HybridSystem system = backlash_mass(omega);
    const State start{0.0, Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Constant(1, 1.5)};
    const TangentResult tangent = tangent_flow(system, start, 20.0);
    double since = 0.0, in_contact = 0.0;
    bool pressing = false;
    for (const Event& e : tangent.events) {
      if (e.kind == EventKind::kContact) since = e.time;
      if (e.kind == EventKind::kSeparation) in_contact += e.time - since;
      pressing = e.kind == EventKind::kContact;
    }
    if (pressing) in_contact += 20.0 - since;
    ASSERT_GE(tangent.events.size(), 4U);
    EXPECT_NEAR(std::log(tangent.monodromy.determinant()), -(0.05 * 20.0 + 0.5 * in_contact), 1e-10);
  }
}

TEST(ClearanceTangent, RateIsWhatAnInstantMoreAdds) {
  const HybridSystem system = backlash_train(0.8);
  TangentFlow flow(system);
  const TangentResult at = flow.run(system.rest(), 30.0);
  const auto end_at = [&](double later) { return stacked(flow.run(system.rest(), 30.0 + later).end); };
  EXPECT_LT((slope(end_at, 1e-5, 2) - at.rate).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ClearanceTangent, NoTangentsAtAllCarryNothing) {
  const HybridSystem system = backlash_mass(0.65);
  TangentFlow flow(system);
  const State start{0.0, Eigen::VectorXd::Constant(1, 2.0), Eigen::VectorXd::Zero(1)};
  const TangentResult none = flow.run(start, 50.0, {.start = Eigen::MatrixXd(2, 0)}), all = flow.run(start, 50.0);
  EXPECT_EQ(none.monodromy.cols(), 0);
  EXPECT_EQ(stacked(none.end), stacked(all.end));
  EXPECT_EQ(none.rate, all.rate);
}

TEST(ClearanceTangent, AStateOnItsGuardIsTakenUpAgain) {
  // A run that ends at an event leaves y off the guard by the rounding of the time; its end is a start again.
  const HybridSystem system = backlash_mass(0.3);
  State at = simulate(system, {900.0, Eigen::VectorXd::Constant(1, 2.0), Eigen::VectorXd::Zero(1)}, {.duration = 50.0})
                 .final_state;
  int events = 0;
  for (const Event& e : simulate(system, at, {.duration = 60.0}).events) {
    State end = simulate(system, at, {.duration = e.time - at.time}).final_state;
    const Trajectory direct = simulate(system, at, {.duration = e.time + 1.0 - at.time});
    const Trajectory onward = simulate(system, end, {.duration = 1.0});
    EXPECT_LT((direct.final_state.q - onward.final_state.q).norm(), 1e-9);
    end.modes.clear();
    EXPECT_LT((simulate(system, end, {.duration = 1.0}).final_state.q - direct.final_state.q).norm(), 1e-9);
    ++events;
  }
  EXPECT_GE(events, 10);
}

TEST(ClearanceTangent, ARunLeavesNoTraceInTheNext) {
  const HybridSystem system = backlash_mass(0.65);
  TangentFlow flow(system);
  const State start{0.0, Eigen::VectorXd::Constant(1, 2.0), Eigen::VectorXd::Zero(1)};
  const TangentResult first = flow.run(start, 50.0);
  static_cast<void>(flow.run(system.rest(), 7.0));
  const TangentResult again = flow.run(start, 50.0);
  EXPECT_EQ(first.monodromy, again.monodromy);
  EXPECT_EQ(stacked(first.end), stacked(again.end));
}

TEST(ClosedFormTangent, OfContactSpringsLoadsAndSticksEqualsCentralDifferences) {
  EXPECT_GE(expect_differences([](unsigned seed) { return random_piecewise_linear(seed); }, 120, 2.0), 60);
}

}  // namespace
}  // namespace slipmode::dynamics
