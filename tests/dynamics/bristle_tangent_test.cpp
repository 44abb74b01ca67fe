// Tangents through Dahl's and the LuGre law: closed forms, differences of an independent integrator, volumes.
#include <slipmode/core/decompositions.hpp>
#include "fixtures/against_reference.hpp"
#include "fixtures/bristle_scenes.hpp"
#include "fixtures/differences.hpp"
#include "fixtures/scenes.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Belt;
using friction::Coulomb;
using friction::Dahl;
using friction::LuGre;
using friction::Shaker;

constexpr FlowOptions kFinest{.tolerance = 1e-13};
/// Of differences of order 6: they leave the rounding of starts and ends alone, a few 1e-16/1e-5; ten times as far
/// apart a start of the random scenes passes an event.
constexpr double kStep = 1e-5;

Eigen::VectorXd all_of(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& own) {
  Eigen::VectorXd x(q.size() + v.size() + own.size());
  x << q, v, own;
  return x;
}

/// End state of the independent reference (Taylor series in long double).
auto reference_end(const HybridSystem& system, double duration) {
  return [&system, duration](const State& from) -> Eigen::VectorXd {
    TaylorReference<long double> reference(reference_of(system));
    const ReferenceRun run = reference.run(from.q, from.v, from.time, duration, {}, bristles_of(system, from.internal));
    Eigen::VectorXd own(system.internal_size());
    for (int c = 0; c < static_cast<int>(system.contacts().size()); ++c)
      if (has_bristle(system.contacts()[static_cast<std::size_t>(c)])) own[system.internal_begin(c)] = run.bristle[c];
    return all_of(run.q, run.v, own);
  };
}

double relative_gap(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

/// d(ẋ)/dx of one mass sliding at s on one LuGre contact, x = (q, v, z).
Eigen::Matrix3d field_of(double m, double k, double c, const LuGre& law, double load, double s, double z) {
  const double e = (law.mu_s - law.mu_k) * std::exp(-s * s / (law.stribeck_speed * law.stribeck_speed));
  const double g = load * (law.mu_k + e), g_slope = -2.0 * s / (law.stribeck_speed * law.stribeck_speed) * load * e;
  const double decay = law.stiffness * std::abs(s) / g;
  const double decay_slope = law.stiffness * (std::copysign(1.0, s) / g - std::abs(s) * g_slope / (g * g));
  const double by_z = law.stiffness - law.damping * decay, by_s = law.damping * (1.0 - decay_slope * z) + law.viscous;
  Eigen::Matrix3d A;
  A << 0, 1, 0, -k / m, -(c + by_s) / m, by_z / m, 0, -(1.0 - decay_slope * z), -decay;
  return A;
}

TEST(BristleTangent, InSteadySlidingItIsTheExponentialOfTheLinearisedField) {
  const double m = 1.3, k = 2.0, c = 0.1, load = 1.5, duration = 3.7;
  for (const LuGre& law : {LuGre{0.5, 0.3, 0.4, 20.0, 1.5, 0.2}, LuGre{0.4, 0.4, 1.0, 35.0, 0.0, 0.0},
                           LuGre{0.6, 0.2, 0.3, 900.0, 4.0, 0.0}}) {
    for (const double V : {0.3, -0.7}) {
      const double g =
          load * (law.mu_k + (law.mu_s - law.mu_k) * std::exp(-V * V / (law.stribeck_speed * law.stribeck_speed)));
      const double z = std::copysign(g / law.stiffness, V);
      const HybridSystem system = oscillator(m, k, c, law, load, Belt::constant(V));
      State start = system.rest();
      start.q[0] = (std::copysign(g, V) + law.viscous * V) / k;
      start.internal = Eigen::VectorXd::Constant(1, z);
      const Eigen::Matrix3d field = field_of(m, k, c, law, load, V, z) * duration;
      const Eigen::Matrix3d expected = field.exp();
      EXPECT_LT(relative_gap(tangent_flow(system, start, duration, kFinest).monodromy, expected), 1e-11) << V;
    }
  }
}

TEST(BristleTangent, AtRestABristleIsASpringBesideItsDashpots) {
  // About rest κ z is of second order: λ = −σ₀ (q − q₀) − (σ₁ + σ₂) v, and z + q is kept. Eigenvalues: 0 and the roots
  // of m p² + (c + σ₁ + σ₂) p + k + σ₀.
  const double m = 1.3, k = 2.0, c = 0.1, duration = 2.3;
  const LuGre law{0.5, 0.3, 0.4, 20.0, 1.5, 0.2};
  const HybridSystem system = oscillator(m, k, c, law, 1.5, Belt::constant(0.0));
  State rest = system.rest();
  rest.internal = Eigen::VectorXd::Zero(1);
  const Eigen::MatrixXd found = tangent_flow(system, rest, duration, kFinest).monodromy;
  const double d = c + law.damping + law.viscous;
  const std::complex<double> root = std::sqrt(std::complex<double>(d * d - 4.0 * m * (k + law.stiffness)));
  const std::complex<double> p = (-d + root) / (2.0 * m);
  ASSERT_GT(p.imag(), 0.0);
  const Eigen::VectorXcd multipliers = Eigen::EigenSolver<Eigen::MatrixXd>(found).eigenvalues();
  const auto off = [&](std::complex<double> expected) { return (multipliers.array() - expected).abs().minCoeff(); };
  EXPECT_LT(off(1.0), 1e-12);
  EXPECT_LT(off(std::exp(p * duration)), 1e-12);
  EXPECT_LT(off(std::exp(std::conj(p) * duration)), 1e-12);
}

TEST(BristleTangent, AgreesWithDifferencesOfTheReferenceThroughReversals) {
  std::size_t reversals = 0;
  for (const std::uint64_t seed : {0u, 1u, 2u, 4u, 5u, 7u, 8u, 11u}) {
    const RandomScene scene = random_bristles(seed, false, 3);
    const TangentResult tangent = tangent_flow(scene.system, scene.start, 4.0, kFinest);
    reversals += tangent.events.size();
    const Eigen::MatrixXd expected = slopes(scene.start, reference_end(scene.system, 4.0), kStep, 6);
    EXPECT_LT(relative_gap(tangent.monodromy, expected), 1e-10) << "seed " << seed;
  }
  EXPECT_GT(reversals, 20u);
}

TEST(BristleTangent, AgreesWithDifferencesOfTheReferenceBesideSticks) {
  std::size_t scenes = 0, releases = 0, sticks = 0;
  for (std::uint64_t seed = 0; scenes < 14; ++seed) {
    const RandomScene scene = random_bristles(seed, false, 3, 0.5);
    const auto& contacts = scene.system.contacts();
    const auto bristles = std::ranges::count_if(contacts, has_bristle);
    if (bristles == 0 || bristles == std::ssize(contacts)) continue;
    ++scenes;
    const TangentResult tangent = tangent_flow(scene.system, scene.start, 6.0, kFinest);
    for (const Event& event : tangent.events) {
      releases += event.kind == EventKind::kRelease ? 1 : 0;
      sticks += event.kind == EventKind::kStick ? 1 : 0;
    }
    const Eigen::MatrixXd expected = slopes(scene.start, reference_end(scene.system, 6.0), kStep, 6);
    EXPECT_LT(relative_gap(tangent.monodromy, expected), 1e-10) << "seed " << seed;
  }
  EXPECT_GT(sticks, 5u);
  EXPECT_GT(releases, 3u);
}

TEST(BristleTangent, DifferencesConvergeToItAtTheirOrder) {
  // Truncation of central differences of order p falls by 2^p as the step is halved; what is left is the tangent's.
  const HybridSystem system =
      oscillator(1.0, 1.0, 0.05, LuGre{0.4, 0.25, 0.3, 15.0, 0.8, 0.1}, 1.0, Belt::constant(0.2));
  State start = state(Eigen::VectorXd::Constant(1, 0.9), Eigen::VectorXd::Constant(1, -0.4));
  start.internal = Eigen::VectorXd::Constant(1, 0.004);
  const TangentResult tangent = tangent_flow(system, start, 9.0, kFinest);
  ASSERT_GE(tangent.events.size(), 2u);
  const auto end = reference_end(system, 9.0);
  for (const int order : {2, 4}) {
    double before = 0.0;
    for (const double h : {8e-3, 4e-3, 2e-3}) {
      const double gap = relative_gap(slopes(start, end, h, order), tangent.monodromy);
      if (before > 0.0) {
        EXPECT_NEAR(std::log2(before / gap), order, 0.1 * order) << order << ' ' << h;
      }
      before = gap;
    }
  }
  EXPECT_LT(relative_gap(slopes(start, end, 5e-4, 6), tangent.monodromy), 1e-11);
}

TEST(BristleTangent, VolumesShrinkByTheIntegratedDivergence) {
  // ln det Φ = ∫ −tr M⁻¹C − Σ (κ + wᵀM⁻¹w ∂λ/∂s) dt, for the field has no jump. Dahl, and LuGre without σ₁: ∂λ/∂s = σ₂.
  // κ(s) from the reference's series, by Gauss's rule of 5 points on 16 pieces of each of its steps.
  const double point[] = {-0.906179845938664, -0.538469310105683, 0.0, 0.538469310105683, 0.906179845938664};
  const double weight[] = {0.236926885056189, 0.478628670499366, 0.568888888888889, 0.478628670499366,
                           0.236926885056189};
  const Dahl dahl{0.3, 12.0};
  const LuGre lugre{0.5, 0.3, 0.4, 20.0, 0.0, 0.15};
  const double loads[] = {1.5, 0.8};
  const HybridSystem system(fem::chain({.masses = 3, .damping = 0.04}),
                            {{unit(3, 2), dahl, loads[0]}, {unit(3, 0), lugre, loads[1]}}, Belt::constant(0.25));
  State start = swinging(3, 5, 1.0);
  start.internal = Eigen::Vector2d(0.01, -0.004);
  const double duration = 12.0;
  double divergence = -duration * fem::to_dense(system.structure().C()).trace() - duration * lugre.viscous;  // M = 1
  TaylorReference<long double> reference(reference_of(system));
  (void)reference.run(
      start.q, start.v, 0.0, duration,
      [&](long double, long double h, const TaylorSeries<long double>& series) {
        for (int piece = 0; piece < 16; ++piece)
          for (int j = 0; j < 5; ++j) {
            const double tau = static_cast<double>(h) / 16.0 * (piece + 0.5 * (1.0 + point[j]));
            for (std::size_t c = 0; c < 2; ++c) {
              double s = 0.0;
              for (auto a = series.slip_velocity(c).rbegin(); a != series.slip_velocity(c).rend(); ++a)
                s = s * tau + static_cast<double>(*a);
              const double g =
                  loads[c] * (c == 0
                                  ? dahl.mu
                                  : lugre.mu_k + (lugre.mu_s - lugre.mu_k) *
                                                     std::exp(-s * s / (lugre.stribeck_speed * lugre.stribeck_speed)));
              const double stiffness = c == 0 ? dahl.stiffness : lugre.stiffness;
              divergence -= 0.5 * weight[j] * static_cast<double>(h) / 16.0 * stiffness * std::abs(s) / g;
            }
          }
      },
      start.internal);
  const TangentResult tangent = tangent_flow(system, start, duration, kFinest);
  EXPECT_GE(tangent.events.size(), 4u);
  // Shrunk by e^−100 and more the determinant of the product is rounding: take it stretch by stretch.
  double found = 0.0;
  State at = start;
  for (int k = 0; k < 48; ++k) {
    const TangentResult part = tangent_flow(system, at, duration / 48.0, kFinest);
    found += std::log(part.monodromy.determinant());
    at = part.end;
  }
  EXPECT_LT(divergence, -20.0);
  EXPECT_NEAR(found, divergence, 1e-9 * std::abs(divergence));
}

TEST(BristleTangent, CarriesTheMotionsOwnRate) {
  // Φ f(x₀) = f(x_T) of an autonomous flow, bristles beside a sticking contact included.
  const HybridSystem system(
      fem::chain({.masses = 4, .damping = 0.02}),
      {{unit(4, 3), LuGre{0.5, 0.3, 0.2, 30.0, 0.5, 0.0}, 1.5}, {unit(4, 1), Coulomb{0.3, 0.15}, 0.7}},
      Belt::constant(0.3));
  State start = swinging(4, 2, 1.0);
  start.internal = Eigen::VectorXd::Zero(1);
  const TangentResult begin = tangent_flow(system, start, 0.0, kFinest),
                      end = tangent_flow(system, start, 14.0, kFinest);
  EXPECT_GE(std::ranges::count_if(end.events, [](const Event& e) { return e.kind == EventKind::kRelease; }), 1);
  EXPECT_GE(std::ranges::count_if(end.events, [](const Event& e) { return e.kind == EventKind::kReversal; }), 1);
  EXPECT_LT((end.monodromy * begin.rate - end.rate).cwiseAbs().maxCoeff(), 1e-10 * end.rate.cwiseAbs().maxCoeff());
}

TEST(BristleTangent, ErrorsFollowTheTolerance) {
  const RandomScene scene = random_bristles(3, true, 4);  // stiff ones
  const auto tangent = [&](double tolerance) {
    return tangent_flow(scene.system, scene.start, 6.0, {.tolerance = tolerance}).monodromy;
  };
  const Eigen::MatrixXd fine = tangent(1e-13);
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    EXPECT_LT(relative_gap(tangent(tolerance), fine), 300.0 * tolerance) << tolerance;
}

}  // namespace
}  // namespace slipmode::dynamics
