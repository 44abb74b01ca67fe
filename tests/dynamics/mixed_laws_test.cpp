// Contacts that stick and contacts with bristles in one system; contacts that change together under a shaker.
#include <slipmode/dynamics/consistency.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/bristle_scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Dahl;
using friction::LuGre;
using friction::Shaker;
using friction::Stribeck;

constexpr FlowOptions kTightBristles{.tolerance = 1e-12};

/// Has contacts of both kinds.
bool mixed(const HybridSystem& system) {
  int bristles = 0, rigid = 0;
  for (const friction::Contact& contact : system.contacts()) {
    bristles += has_bristle(contact) ? 1 : 0;
    rigid += contact_forces(contact).sticks() ? 1 : 0;
  }
  return bristles > 0 && rigid > 0;
}

/// The same scene with directions that reach onto the other contacts' masses, so that forces of one accelerate another.
RandomScene interwoven(const RandomScene& scene, std::uint64_t seed) {
  Draws random(9000 + seed);
  std::vector<friction::Contact> contacts = scene.system.contacts();
  for (friction::Contact& contact : contacts)
    for (const friction::Contact& other : scene.system.contacts())
      if (contact.direction.dot(other.direction) == 0.0)
        contact.direction += random.uniform(-0.4, 0.4) * other.direction;
  return {HybridSystem(scene.system.structure(), std::move(contacts), scene.system.drive()), scene.start};
}

TEST(MixedLaws, AgreeWithTheTaylorReferenceOnRandomScenes) {
  std::size_t scenes = 0, events = 0;
  for (std::uint64_t seed = 0; scenes < 40; ++seed) {
    const RandomScene plain = random_bristles(seed, false, 6, 0.5);
    if (!mixed(plain.system)) continue;
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomScene scene = scenes++ % 2 == 0 ? plain : interwoven(plain, seed);
    events += expect_near_reference(scene.system, scene.start, 8.0, kTightBristles, {.event_time = 1e-8});
  }
  EXPECT_GT(events, 200u);
}

TEST(MixedLaws, TheEnergyBalanceClosesAndSticksHold) {
  std::size_t scenes = 0;
  double stuck = 0.0;
  for (std::uint64_t seed = 100; scenes < 30; ++seed) {
    const RandomScene scene = random_bristles(seed, seed % 2 == 0, 12, 0.5);
    if (!mixed(scene.system)) continue;
    ++scenes;
    const Trajectory run = simulate(scene.system, scene.start, {.duration = 20.0, .sample = 0.1});
    EXPECT_LT(std::abs(run.audit.residual()), 1e-9) << "seed " << seed;
    for (std::size_t c = 0; c < scene.system.contacts().size(); ++c) {
      const friction::Contact& contact = scene.system.contacts()[c];
      stuck += run.statistics.stick_time[c];
      if (has_bristle(contact)) {
        EXPECT_EQ(run.statistics.stick_time[c], 0.0);
        continue;
      }
      EXPECT_LE(run.lambda.row(static_cast<Eigen::Index>(c)).cwiseAbs().maxCoeff(),
                friction::static_coefficient(contact.law) * contact.normal_load.constant * (1 + 1e-9))
          << "seed " << seed;
    }
  }
  EXPECT_GT(stuck, 60.0);
}

TEST(MixedLaws, AStuckNeighbourCarriesTheBristleForce) {
  // Two masses joined by a spring, at rest: the first stuck on a belt at rest, the second held by its bristle alone.
  // λ₂ = σ z₂, so the second swings on k + σ about its start as long as z stays small beside μN/σ; the first feels
  // −kq₂.
  const double k = 1.0, sigma = 3.0, way = 1e-6;
  Eigen::MatrixXd K(2, 2);
  K << k, -k, -k, k;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(2, 2);
  const HybridSystem system(fem::Structure(I, Eigen::MatrixXd(0.0 * I), K),
                            {{unit(2, 0), Coulomb{0.4, 0.3}, 1.0}, {unit(2, 1), Dahl{0.5, sigma}, 1e3}},
                            Belt::constant(0.0));
  const Trajectory run = simulate(system, state(way * unit(2, 1), Eigen::VectorXd::Zero(2)),
                                  {.duration = 30.0, .sample = 0.1, .flow = kTightBristles});
  // z = q₂(0) − q₂: λ = σ (way − q₂), equilibrium at way σ/(k + σ).
  const double middle = way * sigma / (k + sigma);
  for (Eigen::Index i = 0; i < run.times.size(); ++i) {
    const double q = middle + (way - middle) * std::cos(std::sqrt(k + sigma) * run.times(i));
    EXPECT_NEAR(run.q(1, i), q, 1e-7 * way);
    EXPECT_NEAR(run.q(0, i), 0.0, 1e-7 * way);
    EXPECT_NEAR(run.lambda(0, i), -k * q, 1e-7 * way);
  }
}

TEST(MixedLaws, StickForceRatesAreTheDifferencesOfStickForces) {
  // λ of a stuck contact beside a LuGre and a Stribeck one under a shaker, by differences of order 4.
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(3, 3);
  Eigen::MatrixXd K(3, 3);
  K << 2.0, -1.0, -0.3, -1.0, 2.5, -0.7, -0.3, -0.7, 1.4;
  const Shaker shaker{0.3, 0.4, 0.2};
  const HybridSystem system(fem::Structure(I, Eigen::MatrixXd(0.1 * K), K),
                            {{(unit(3, 0) + 0.2 * unit(3, 1)).eval(), Coulomb{1e3, 1e3}, 1.0},
                             {(unit(3, 1) + 0.3 * unit(3, 2)).eval(), LuGre{0.5, 0.3, 0.2, 20.0, 1.0, 0.1}, 1.0},
                             {(unit(3, 2) - 0.4 * unit(3, 0)).eval(), Stribeck{0.5, 0.3, 2.0}, 1.0}},
                            shaker);
  Eigen::Vector3d v(0.0, 0.1, -1.0);
  v(0) = shaker.velocity(0.0) - 0.2 * v(1);
  State start = state(Eigen::Vector3d(0.1, -0.2, 0.3), v);
  start.internal = Eigen::VectorXd::Constant(1, 0.004);
  const double h = 1e-4;
  const Trajectory run = simulate(system, start, {.duration = 4.0 * h, .sample = h, .flow = kTightBristles});
  ASSERT_TRUE(run.events.empty());
  ASSERT_EQ(run.final_state.modes[0], ContactMode::kStick);

  const Trajectory middle = simulate(system, start, {.duration = 2.0 * h, .flow = kTightBristles});
  const State& at = middle.final_state;
  const ModalModel model = build_modal_model(system, false);
  std::vector<ContactForces> laws;
  for (const friction::Contact& contact : system.contacts()) laws.push_back(contact_forces(contact));
  const Eigen::VectorXd x = model.from_q * at.q + model.from_v * at.v, force = run.lambda.col(2);
  const double V = shaker.velocity(at.time);
  const Instant now{
      model, laws, x.data(), at.time, V, shaker.acceleration(at.time), nullptr, -shaker.omega() * shaker.omega() * V};
  const Eigen::VectorXd rates = stick_force_rates(now, at.modes, force, Eigen::Vector3d(0.0, at.internal(0), 0.0));
  for (Eigen::Index c = 0; c < 3; ++c) {
    const double difference =
        (8.0 * (run.lambda(c, 3) - run.lambda(c, 1)) - (run.lambda(c, 4) - run.lambda(c, 0))) / (12.0 * h);
    EXPECT_NEAR(rates(c), difference, 1e-7) << c;
  }
}

/// Two equal masses, each on its own spring and its own contact.
HybridSystem twins(double stiffness, friction::Law law, double load, friction::Drive drive) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(2, 2);
  return {fem::Structure(I, Eigen::MatrixXd(0.0 * I), Eigen::MatrixXd(stiffness * I)),
          {{unit(2, 0), law, load}, {unit(2, 1), law, load}},
          drive};
}

TEST(MixedLaws, TwinsOnAShakerChangeTogether) {
  // Stuck, λ = (k − mω²) d: above resonance it rises with −d, which only the shaker's jerk tells. Late in a long run
  // V(t) is rounded with the time.
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation})
    for (const double ratio : {0.5, 3.0})
      for (const double time : {0.0, 1e5}) {
        const Shaker shaker{1.0, ratio / (2.0 * std::numbers::pi), 0.3};
        const HybridSystem system = twins(1.0, Coulomb{0.5, 0.35}, 1.0, shaker);
        State start = state(Eigen::VectorXd::Constant(2, shaker.displacement(time)),
                            Eigen::VectorXd::Constant(2, shaker.velocity(time)), time);
        const Trajectory run = simulate(system, start, {.duration = 60.0, .flow = {.method = method}});
        ASSERT_EQ(run.events.size() % 2, 0u) << ratio << ' ' << time;
        ASSERT_GT(run.events.size(), 10u);
        for (std::size_t i = 0; i < run.events.size(); i += 2) {
          EXPECT_EQ(run.events[i].time, run.events[i + 1].time) << ratio << ' ' << time << " event " << i;
          EXPECT_EQ(run.events[i].after, run.events[i + 1].after);
        }
      }
}

}  // namespace
}  // namespace slipmode::dynamics
