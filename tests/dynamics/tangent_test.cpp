// The tangent flow against closed forms, central differences and the identity M(T) f(x₀) = f(x(T)) of autonomous flows.
#include "dynamics/end_differences.hpp"
#include "fixtures/belt_oscillator.hpp"
#include "fixtures/contact_forces.hpp"
#include "fixtures/scenes.hpp"
#include "fixtures/uniform_chain.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Stribeck;

FlowOptions flow_of(FlowMethod method) { return {.method = method, .tolerance = 1e-13}; }

void expect_differences(const HybridSystem& system, const State& start, double duration, FlowMethod method,
                        std::size_t least_events) {
  const TangentResult tangent = tangent_flow(system, start, duration, flow_of(method));
  EXPECT_GE(tangent.events.size(), least_events);
  const Eigen::MatrixXd expected = slopes_of_end(system, start, duration, flow_of(method));
  EXPECT_LT((tangent.monodromy - expected).cwiseAbs().maxCoeff(), 1e-7 * expected.cwiseAbs().maxCoeff());
  const Trajectory run = simulate(system, start, {.duration = duration, .flow = flow_of(method)});
  EXPECT_LT((stacked(tangent.end) - stacked(run.final_state)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Tangent, WithoutFrictionItIsTheLinearFlow) {
  const UniformChain chain{6, 0.05};
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const HybridSystem system = belt_chain(Coulomb{0.0, 0.0}, Belt::constant(20.0), 6, 0.05);
    const TangentResult tangent = tangent_flow(system, swinging(6, 1, 1.0), 13.0, flow_of(method));
    for (Eigen::Index i = 0; i < 12; ++i) {
      const Eigen::VectorXd q = i < 6 ? unit(6, i) : Eigen::VectorXd::Zero(6);
      const Eigen::VectorXd v = i < 6 ? Eigen::VectorXd::Zero(6) : unit(6, i - 6);
      const auto expected = chain.motion(q, v, 13.0);
      EXPECT_LT((tangent.monodromy.col(i).head(6) - expected.q).cwiseAbs().maxCoeff(), 1e-11);
      EXPECT_LT((tangent.monodromy.col(i).tail(6) - expected.v).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(Tangent, AContactJustGainedSlidesWithItsLoad) {
  // m = k = 1 from −2 without contact, N = 1 + q: q = −2 cos t, contact at π/3. Below a belt that is faster it slides
  // at once, z = μ_k N/K, whose sign no stretch tells yet.
  const double mu = 0.3, stiffness = 2.0, T = std::numbers::pi / 3.0 + 1e-9;
  const HybridSystem system(
      fem::chain({.masses = 1, .damping = 0.0}),
      {{unit(1, 0), friction::CompliantCoulomb{mu, mu, stiffness}, friction::NormalLoad(1.0, 1.0)}},
      Belt::constant(5.0));
  const State start = state(Eigen::VectorXd::Constant(1, -2.0), Eigen::VectorXd::Zero(1));
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const TangentResult tangent = tangent_flow(system, start, T, flow_of(method));
    ASSERT_EQ(tangent.events.size(), 1u);
    EXPECT_NEAR(tangent.monodromy(2, 0), mu / stiffness * std::cos(T), 1e-8);
    EXPECT_NEAR(tangent.monodromy(2, 1), mu / stiffness * std::sin(T), 1e-8);
  }
}

TEST(Tangent, SaltationAtAReversalOfOneMass) {
  // m = k = 1 on a belt at rest, let go at x = 5, F = 0.2: at the turning point −4.6 the acceleration jumps from
  // 4.6 + 0.2 to 4.6 − 0.2; saltation is diag(1, 4.4/4.8) between two rotations.
  const double second = 1.1;
  Eigen::Matrix2d quarter, rotation;
  quarter << -1, 0, 0, -1;  // half a turn
  rotation << std::cos(second), std::sin(second), -std::sin(second), std::cos(second);
  const Eigen::Matrix2d expected = rotation * Eigen::Vector2d(1.0, 4.4 / 4.8).asDiagonal() * quarter;
  const HybridSystem system = oscillator(1.0, 1.0, 0.0, Coulomb{0.4, 0.2}, 1.0, Belt::constant(0.0));
  State start = state(Eigen::VectorXd::Constant(1, 5.0), Eigen::VectorXd::Zero(1));
  start.modes = {ContactMode::kSlipPositive};
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const TangentResult tangent = tangent_flow(system, start, std::numbers::pi + second, flow_of(method));
    ASSERT_EQ(tangent.events.size(), 1u);
    EXPECT_LT((tangent.monodromy - expected).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(Tangent, AStickSlipCycleOfOneMassHasMultipliersOneAndZero) {
  const BeltOscillator b;
  const HybridSystem system =
      oscillator(b.mass, b.stiffness, 0.0, Coulomb{b.mu_s, b.mu_k}, b.load, Belt::constant(b.belt));
  const double begin = 0.4 * b.slip_time();
  const State start =
      state(Eigen::VectorXd::Constant(1, b.position(begin)), Eigen::VectorXd::Constant(1, b.velocity(begin)));
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const TangentResult tangent = tangent_flow(system, start, b.period(), flow_of(method));
    EXPECT_EQ(tangent.events.size(), 2u);
    EXPECT_NEAR(tangent.monodromy.trace(), 1.0, 1e-9);
    EXPECT_NEAR(tangent.monodromy.determinant(), 0.0, 1e-9);
    const Eigen::Vector2d field(b.velocity(begin), -(b.position(begin) - b.centre()));
    EXPECT_LT((tangent.monodromy * field - field).norm(), 1e-9);
  }
}

TEST(Tangent, AgreesWithDifferencesInSlip) {
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 1.0}, Belt::constant(3.0), 4);
  expect_differences(chain, swinging(4, 1, 0.5), 9.0, FlowMethod::kCollocation, 0);
}

TEST(Tangent, AgreesWithDifferencesThroughReversalsSticksAndReleases) {
  const HybridSystem stribeck = belt_chain(Stribeck{0.4, 0.2, 2.0}, Belt::constant(0.3), 4);
  const HybridSystem coulomb = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.3), 4);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const State start = swinging(4, seed, 1.5);
    expect_differences(stribeck, start, 14.0, FlowMethod::kCollocation, 2);
    expect_differences(coulomb, start, 14.0, FlowMethod::kClosedForm, 2);
    expect_differences(coulomb, start, 14.0, FlowMethod::kCollocation, 2);
  }
}

TEST(Tangent, AgreesWithDifferencesOnARampAndWithSeveralContacts) {
  const HybridSystem system(fem::chain({.masses = 4, .damping = 0.02}),
                            {{unit(4, 3), Stribeck{0.4, 0.2, 2.0}, 1.5}, {unit(4, 1), Coulomb{0.3, 0.15}, 0.7}},
                            Belt::ramp(0.4, -0.2, 3.0, 9.0));
  for (const std::uint64_t seed : {1u, 2u}) {
    expect_differences(system, swinging(4, seed, 1.5), 12.0, FlowMethod::kCollocation, 3);
  }
}

TEST(Tangent, AgreesWithDifferencesForACharacteristic) {
  // Weakening that ends in a dip; a jump where sliding begins, so that releases saltate.
  const friction::Characteristic law{
      .mu_s = 0.35,
      .mu = [](double v) { return 0.2 * (1.0 + 0.5 * std::sin(2.0 * v) * std::exp(-v)); },
      .slope = [](double v) { return 0.1 * (2.0 * std::cos(2.0 * v) - std::sin(2.0 * v)) * std::exp(-v); }};
  const HybridSystem one = belt_chain(law, Belt::constant(0.3), 4);
  const HybridSystem two(fem::chain({.masses = 4, .damping = 0.02}),
                         {{unit(4, 3), law, 1.5}, {unit(4, 1), Stribeck{0.3, 0.15, 2.0}, 0.7}},
                         Belt::ramp(0.4, -0.2, 3.0, 9.0));
  for (const std::uint64_t seed : {1u, 2u}) {
    expect_differences(one, swinging(4, seed, 1.5), 14.0, FlowMethod::kCollocation, 2);
    expect_differences(two, swinging(4, seed, 1.5), 12.0, FlowMethod::kCollocation, 3);
  }
}

TEST(Tangent, EnteringStickProjectsOutOneDirection) {
  const HybridSystem chain = belt_chain(Coulomb{0.4, 0.2}, Belt::constant(0.2), 5);
  for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
    const Trajectory run = simulate(chain, swinging(5, 2, 1.0), {.duration = 60.0, .flow = flow_of(method)});
    const auto stick =
        std::find_if(run.events.begin(), run.events.end(), [](const Event& e) { return e.kind == EventKind::kStick; });
    ASSERT_NE(stick, run.events.end());
    const TangentResult tangent = tangent_flow(chain, swinging(5, 2, 1.0), stick->time + 1e-3, flow_of(method));
    const Eigen::VectorXd sigma = tangent.monodromy.jacobiSvd().singularValues();
    EXPECT_LT(sigma[9], 1e-11 * sigma[0]);
    EXPECT_GT(sigma[8], 1e-6 * sigma[0]);
    EXPECT_LT(tangent.monodromy.row(9).cwiseAbs().maxCoeff(), 1e-11);  // the stuck mass moves with the belt
  }
}

TEST(Tangent, ACornerOfTheBeltWhileStuckChangesNothing) {
  // Stuck from rest on a belt that speeds up until T, one mass goes with it: d(q, v)/d(q, v at the start) = diag(1, 0).
  // The step that ends at the corner may foresee a release beyond it.
  for (const double T : {0.3, 0.7, 1.0, 1.3})
    for (const double spare : {0.01, 0.05, 0.1, 0.2, 0.4, 10.0}) {
      const double mu_s = 1.0 + 0.1 * T + 0.5 * T * T + spare;  // of m a + c v + k q at T
      for (const friction::Law& law :
           {friction::Law(friction::Stribeck{mu_s, 0.5, 2.0}), friction::Law(friction::Coulomb{mu_s, 0.5})}) {
        const HybridSystem system = fixtures::oscillator(1.0, 1.0, 0.1, law, 1.0, friction::Belt::ramp(0.0, T, 0.0, T));
        const State start = fixtures::state(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1));
        for (const FlowMethod method : {FlowMethod::kClosedForm, FlowMethod::kCollocation}) {
          if (method == FlowMethod::kClosedForm && std::holds_alternative<friction::Stribeck>(law)) continue;
          const TangentResult run = tangent_flow(system, start, T, {.method = method, .tolerance = 1e-6});
          const Eigen::Matrix2d exact = Eigen::Vector2d(1.0, 0.0).asDiagonal();
          EXPECT_LT((run.monodromy - exact).cwiseAbs().maxCoeff(), 1e-9) << T << ' ' << spare;
        }
      }
    }
}

TEST(Tangent, CarriesTheFieldAlongTheTrajectory) {
  const HybridSystem chain = belt_chain(Stribeck{0.4, 0.2, 8.0}, Belt::constant(0.2));
  const State start = swinging(10, 1, 1.5);
  const TangentResult tangent = tangent_flow(chain, start, 50.0, flow_of(FlowMethod::kCollocation));
  ASSERT_GE(tangent.events.size(), 4u);
  const ReferenceModel model = reference_of(chain);
  const auto field = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v, const std::vector<int>& modes) {
    Eigen::VectorXd f(20);
    f << v, contact_forces(model, q, v, modes, 0.2, 0.0).acceleration;
    return f;
  };
  const int side = start.v[9] < 0.2 ? 1 : -1;
  const Eigen::VectorXd first = field(start.q, start.v, {side});
  const Eigen::VectorXd last = field(tangent.end.q, tangent.end.v, {static_cast<int>(tangent.end.modes.at(0))});
  EXPECT_LT((tangent.monodromy * first - last).cwiseAbs().maxCoeff(), 1e-8 * last.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace slipmode::dynamics
