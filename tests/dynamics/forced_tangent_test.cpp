// Tangents of the forces of a force drive: constants and harmonics along each direction, beside differences.
#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/shaken_scenes.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;

constexpr int kOrders = 3;
constexpr double kForcedFor = 6.0;

/// Contacts of every kind that the closed form knows, under a force on the first mass and one on all.
HybridSystem forced(unsigned seed) {
  if (seed % 2 == 0) return random_clearances(seed);
  const HybridSystem made = random_piecewise_linear(seed);
  Draws random(seed + 1000);
  friction::Force force{random.uniform(0.5, 2.5), {}};
  for (int order = 1; order <= 2; ++order)
    force.harmonics.push_back({random.uniform(0.5, 2.0), random.uniform(0.0, 6.0), order, order - 1});
  Eigen::MatrixXd directions = Eigen::MatrixXd::Ones(made.size(), 2);
  directions.col(0) = Eigen::VectorXd::Unit(made.size(), 0);
  return {made.structure(), made.contacts(), force, Eigen::VectorXd::Zero(made.size()), directions};
}

/// The same with this added to its forces. @param change  as one column of Tangents::forces
HybridSystem with_forces(const HybridSystem& system, const Eigen::VectorXd& change) {
  friction::Force force = *system.drive().force();
  Eigen::VectorXd load = system.load();
  if (load.size() == 0) load = Eigen::VectorXd::Zero(system.size());
  constexpr Eigen::Index kBlock = 2 * kOrders + 1;
  for (int d = 0; d < system.force_directions().cols(); ++d) {
    load += change[d * kBlock] * system.force_directions().col(d);
    for (int j = 1; j <= kOrders; ++j) {
      force.harmonics.push_back({change[d * kBlock + j], 0.5 * std::numbers::pi, j, d});
      force.harmonics.push_back({change[d * kBlock + kOrders + j], 0.0, j, d});
    }
  }
  return {system.structure(), system.contacts(), force, load, system.force_directions()};
}

/// Where no rigid contact sticks, so that the start does not depend on the forces.
std::optional<State> start_without_stick(const HybridSystem& system) {
  const bool rigid = std::holds_alternative<friction::Coulomb>(system.contacts().front().law);
  State at = simulate(system, system.rest(), {.duration = 1.3, .flow = {.audit = false}}).final_state;
  for (int k = 0; k < 50 && rigid && at.modes.front() == ContactMode::kStick; ++k)
    at = simulate(system, at, {.duration = 0.07, .flow = {.audit = false}}).final_state;
  if (rigid && at.modes.front() == ContactMode::kStick) return std::nullopt;
  at.modes.clear();
  return at;
}

bool same_events(const std::vector<Event>& a, const std::vector<Event>& b) {
  return std::ranges::equal(
      a, b, [](const Event& x, const Event& y) { return x.contact == y.contact && x.after == y.after; });
}

/// Fourth-order differences of the end state; nothing where the order of events changes or two steps disagree by a
/// tenth of what is asked. Rounding of the end state, 3e-12 where a stop is just touched, is divided by the step: with
/// 1e-5 it would be 1e-7 there, as much as is asked.
std::optional<Eigen::MatrixXd> by_differences(const HybridSystem& system, const State& start,
                                              const Eigen::MatrixXd& changes) {
  const std::vector<Event> events = simulate(system, start, {.duration = kForcedFor, .flow = {.audit = false}}).events;
  bool smooth = true;
  const auto end_of = [&](const Eigen::VectorXd& change) -> Eigen::VectorXd {
    const Trajectory run =
        simulate(with_forces(system, change), start, {.duration = kForcedFor, .flow = {.audit = false}});
    smooth &= same_events(run.events, events);
    return stacked(run.final_state);
  };
  const auto matrix = [&](double h) {
    Eigen::MatrixXd out(stacked(start).size(), changes.cols());
    for (Eigen::Index k = 0; k < changes.cols(); ++k) {
      out.col(k) = slope([&](double step) { return end_of(step * changes.col(k)); }, h);
    }
    return out;
  };
  const Eigen::MatrixXd fine = matrix(1e-4), coarse = matrix(3e-4);
  if (!smooth || !((coarse - fine).cwiseAbs().maxCoeff() < 1e-8 * std::max(1.0, fine.cwiseAbs().maxCoeff())))
    return std::nullopt;
  return fine;
}

TEST(ForcedTangent, EqualsCentralDifferences) {
  int compared = 0, with_events = 0;
  for (unsigned seed = 0; seed < 160; ++seed) {
    SCOPED_TRACE(seed);
    const HybridSystem system = forced(seed);
    const std::optional<State> start = start_without_stick(system);
    if (!start) continue;
    const Eigen::Index count = 2 * (2 * kOrders + 1);
    const Tangents tangents{.start = Eigen::MatrixXd::Zero(stacked(*start).size(), count),
                            .forces = Eigen::MatrixXd::Identity(count, count)};
    TangentFlow flow(system);
    const TangentResult found = flow.run(*start, kForcedFor, tangents);
    const auto expected = by_differences(system, *start, tangents.forces);
    if (!expected) continue;
    ++compared;
    with_events += found.events.empty() ? 0 : 1;
    const double size = std::max(1.0, expected->cwiseAbs().maxCoeff());
    EXPECT_LT((found.monodromy - *expected).cwiseAbs().maxCoeff(), 1e-7 * size);
  }
  EXPECT_GE(compared, 90);
  EXPECT_GE(with_events, 80);
}

TEST(ForcedTangent, GoesOnFromASample) {
  // What the start and the forces change at a later time is what the state and they change from then on.
  for (const unsigned seed : {2U, 4U, 7U, 11U, 15U}) {
    const HybridSystem system = forced(seed);
    const std::optional<State> start = start_without_stick(system);
    ASSERT_TRUE(start) << seed;
    const Eigen::Index N = stacked(*start).size(), rows = 2 * (2 * kOrders + 1);
    Draws random(seed);
    Tangents tangents{Eigen::MatrixXd(N, 4), Eigen::MatrixXd(rows, 4)};
    for (double& value : tangents.start.reshaped()) value = random.uniform(-1.0, 1.0);
    for (double& value : tangents.forces.reshaped()) value = random.uniform(-1.0, 1.0);
    TangentFlow flow(system), other(system);
    const std::vector<double> times = {start->time + 1.1, start->time + 2.9};
    std::vector<State> states;
    std::vector<Eigen::MatrixXd> there;
    const TangentResult whole = flow.run(*start, kForcedFor, tangents, times, [&](const State& s, const auto& t) {
      states.push_back(s);
      there.push_back(t);
    });
    ASSERT_EQ(states.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_DOUBLE_EQ(states[k].time, times[k]);
      const TangentResult rest =
          other.run(states[k], kForcedFor - (times[k] - start->time), {.start = there[k], .forces = tangents.forces});
      EXPECT_LT((rest.monodromy - whole.monodromy).cwiseAbs().maxCoeff(),
                1e-11 * std::max(1.0, whole.monodromy.cwiseAbs().maxCoeff()));
    }
  }
}

TEST(ForcedTangent, RefusesTangentsOfWrongSize) {
  const HybridSystem system = forced(0);
  TangentFlow flow(system);
  const Eigen::Index N = 2 * system.size();
  const auto run = [&](Eigen::Index rows, Eigen::Index columns) {
    static_cast<void>(
        flow.run(system.rest(), 1.0, {Eigen::MatrixXd::Zero(N, 3), Eigen::MatrixXd::Zero(rows, columns)}));
  };
  EXPECT_NO_THROW(run(2 * 5, 3));
  EXPECT_THROW(run(2 * 4, 3), InvalidInput);
  EXPECT_THROW(run(7, 3), InvalidInput);
  EXPECT_THROW(run(2 * 5, 2), InvalidInput);
  const auto nothing = [](const State&, const Eigen::MatrixXd&) {};
  const Tangents none{.start = Eigen::MatrixXd(N, 0)};
  EXPECT_THROW(static_cast<void>(flow.run(system.rest(), 1.0, none, {0.5, 0.2}, nothing)), InvalidInput);
  EXPECT_THROW(static_cast<void>(flow.run(system.rest(), 1.0, none, {0.5, 1.2}, nothing)), InvalidInput);
  TangentFlow belt(random_piecewise_linear(3).with_drive(friction::Belt::constant(0.1)));
  const Eigen::Index own = 2 * random_piecewise_linear(3).size() + random_piecewise_linear(3).internal_size();
  EXPECT_THROW(static_cast<void>(belt.run(random_piecewise_linear(3).rest(), 1.0,
                                          {Eigen::MatrixXd::Zero(own, 1), Eigen::MatrixXd::Zero(3, 1)})),
               InvalidInput);
}

}  // namespace
}  // namespace slipmode::dynamics
