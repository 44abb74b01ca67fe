// A drive at the frequency of a mode without damping, and next to it, in the closed form.
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include "dynamics/internal/harmonic_response.hpp"
#include "fixtures/clearance_reference.hpp"
#include "fixtures/clearance_scenes.hpp"
#include "fixtures/differences.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

using namespace slipmode::fixtures;
using friction::Clearance;
using friction::Contact;
using friction::Force;
using friction::Stop;

/// An undamped mass on a spring of 1 between stops, under A sin ωt.
HybridSystem undamped_play(double omega, double amplitude, double gap) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  const Stop stop{.stiffness = 4.0, .damping = 0.0, .gap = gap};
  return {fem::Structure(fem::Matrix(one), fem::Matrix(Eigen::MatrixXd(0.0 * one)), fem::Matrix(one)),
          {Contact{.direction = Eigen::VectorXd::Ones(1), .law = Clearance{stop, stop}}},
          Force{omega, {{.amplitude = amplitude}}},
          {},
          one};
}

/// `made` without damping but its stops', its force at the frequency of its fastest mode, times 1 + detuning. None for
/// a mass that floats.
std::optional<HybridSystem> at_resonance(const HybridSystem& made, double detuning) {
  const Eigen::MatrixXd M = fem::to_dense(made.structure().M()), K = fem::to_dense(made.structure().K());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);
  const double fastest = modes.eigenvalues().tail<1>()(0);
  if (fastest < 1e-3) return std::nullopt;
  Force force = *made.drive().force();
  force.omega = std::sqrt(fastest) * (1.0 + detuning);
  return HybridSystem{
      fem::Structure(fem::Matrix(M), fem::Matrix(Eigen::MatrixXd::Zero(M.rows(), M.rows())), fem::Matrix(K)),
      made.contacts(), force, made.load(), made.force_directions()};
}

TEST(Resonance, IsFollowedThroughAndBesideIt) {
  // q'' + q = sin ωt from rest: with d = ω − 1, [sin t − 2 cos((1 + d/2) t) sin(dt/2)/d]/(2 + d).
  for (const double d : {0.0, 1e-16, -1e-12, 1e-8, -1e-5, 3e-4, -6e-4, 1e-3, -1e-2}) {
    SCOPED_TRACE(d);
    const HybridSystem system = undamped_play(1.0 + d, 1.0, 1e3);
    const Trajectory run = simulate(system, system.rest(), {.duration = 300.0, .sample = 0.1});
    double worst = 0.0, largest = 0.0;
    for (Eigen::Index k = 0; k < run.times.size(); ++k) {
      const double t = run.times(k), beat = d == 0.0 ? t / 2.0 : std::sin(d * t / 2.0) / d;
      const double q = (std::sin(t) - 2.0 * std::cos((1.0 + d / 2.0) * t) * beat) / (2.0 + d);
      worst = std::max(worst, std::abs(run.q(0, k) - q));
      largest = std::max(largest, std::abs(q));
    }
    EXPECT_LT(worst, 3e-13 * largest);  // rounding of the phases: 300 units of 1e-16, and as much of 1 + d
    EXPECT_LT(std::abs(run.audit.residual()), 1e-13);
    EXPECT_EQ(run.statistics.certified, run.statistics.steps);
  }
}

TEST(Resonance, AgreesWithRungeKuttaWhereStopsBoundIt) {
  std::vector<HybridSystem> systems{undamped_play(1.0, 0.3, 1.0), undamped_play(1.0 - 1e-7, 0.3, 1.0)};
  for (unsigned seed = 0; seed < 24; ++seed)
    if (auto resonant = at_resonance(random_clearances(seed), seed % 3 * 1e-9)) systems.push_back(std::move(*resonant));
  EXPECT_GT(systems.size(), 15U);
  int events = 0;
  for (std::size_t k = 0; k < systems.size(); ++k) {
    SCOPED_TRACE(k);
    const State start = systems[k].rest();
    const Trajectory run = simulate(systems[k], start, {.duration = 12.0});
    ClearanceReference reference(systems[k], start);
    reference.run(12.0L, 1e-3L);
    ASSERT_EQ(run.events.size(), reference.changes().size());
    for (std::size_t e = 0; e < run.events.size(); ++e)
      EXPECT_NEAR(run.events[e].time, reference.changes()[e].time, 1e-7);
    EXPECT_LT((run.final_state.q - reference.q()).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LT((run.final_state.v - reference.v()).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
    EXPECT_GE(run.statistics.certified, run.statistics.steps - 1);
    events += static_cast<int>(run.events.size());
  }
  EXPECT_GT(events, 150);  // the scenes are not idle
}

TEST(Resonance, ALongRunKeepsItsEnergy) {
  const HybridSystem system = undamped_play(1.0, 0.3, 1.0);
  const Trajectory run = simulate(system, system.rest(), {.duration = 2e4, .keep_events = false});
  EXPECT_GT(run.statistics.events, 1000);
  EXPECT_LT(std::abs(run.audit.residual()), 1e-11);
}

TEST(Resonance, TangentsEqualDifferences) {
  // Of the start, and of the force's mean and harmonics, that at resonance among them: fourth-order differences.
  for (const double omega : {1.0, 1.0 + 1e-6}) {
    const HybridSystem system = undamped_play(omega, 0.3, 1.0);
    const State start{0.0, Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Constant(1, 1.3)};
    constexpr double kDuration = 15.0;
    Tangents tangents{.start = Eigen::MatrixXd::Zero(2, 7), .forces = Eigen::MatrixXd::Zero(5, 7)};
    tangents.start.leftCols(2).setIdentity();
    tangents.forces.rightCols(5).setIdentity();
    TangentFlow flow(system);
    const TangentResult found = flow.run(start, kDuration, tangents);
    EXPECT_GE(found.events.size(), 5U);
    for (Eigen::Index k = 0; k < 7; ++k) {
      const auto end_of = [&](double change) -> Eigen::Vector2d {
        const Eigen::VectorXd of_start = change * tangents.start.col(k), of_force = change * tangents.forces.col(k);
        Force force = *system.drive().force();
        for (int j = 1; j <= 2; ++j) {
          force.harmonics.push_back({of_force(j), 0.5 * std::numbers::pi, j});
          force.harmonics.push_back({of_force(2 + j), 0.0, j});
        }
        const HybridSystem changed(system.structure(), system.contacts(), force, of_force.head<1>(),
                                   system.force_directions());
        State from = start;
        from.q(0) += of_start(0);
        from.v(0) += of_start(1);
        const State end = simulate(changed, from, {.duration = kDuration, .flow = {.audit = false}}).final_state;
        return {end.q(0), end.v(0)};
      };
      const Eigen::Vector2d expected = slope(end_of, 2e-5);
      EXPECT_LT((found.monodromy.col(k) - expected).norm(), 1e-8 * std::max(1.0, expected.norm())) << k;
    }
  }
}

TEST(Resonance, ContactsAnswerWhereTheStructureResonatesWithoutThem) {
  // Springs of 3 and 1e6 hold a chain that has no damping, shaken and forced at the frequency of its own mode:
  // (K + Σ K_c w wᵀ − ω²M) q = f + Σ K_c w d in long double. What is not told of q is a share of what the springs hold.
  using Dense = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Column = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  const Eigen::Matrix3d M = Eigen::Vector3d(1.0, 2.0, 0.5).asDiagonal();
  Eigen::Matrix3d K;
  K << 3.0, -1.0, 0.0, -1.0, 2.5, -1.5, 0.0, -1.5, 2.0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> modes(K, M);
  const std::vector<double> springs{3.0, 1e6};
  std::vector<Contact> contacts;
  for (Eigen::Index c = 0; c < 2; ++c)
    contacts.push_back({.direction = Eigen::VectorXd::Unit(3, 2 * c),
                        .law = friction::CompliantCoulomb{0.5, 0.5, springs[static_cast<std::size_t>(c)]}});
  const fem::Structure structure(fem::Matrix(Eigen::MatrixXd(M)), fem::Matrix(Eigen::MatrixXd::Zero(3, 3)),
                                 fem::Matrix(Eigen::MatrixXd(K)));
  for (Eigen::Index mode = 0; mode < 3; ++mode)
    for (const double detuning : {0.0, 1e-12, -1e-6, 1e-3}) {
      SCOPED_TRACE(detuning);
      const double omega = std::sqrt(modes.eigenvalues()(mode)) * (1.0 + detuning);
      const HybridSystem system(structure, contacts, Force{omega, {{.amplitude = 1.0}}}, {},
                                Eigen::MatrixXd::Ones(3, 1));
      const ModalModel& slipping = system.cache().tables(system, false).model;
      const Regime regime(system, slipping, {ContactRole::kSprung, ContactRole::kSprung});
      for (const double way : {0.0, 0.7}) {
        const HarmonicResponse found =
            harmonic_response(regime, slipping, omega, way, Eigen::VectorXcd::Constant(1, way == 0.0 ? 0.4 : 0.0));
        Dense A = K.cast<long double>() - static_cast<long double>(omega) * omega * M.cast<long double>();
        Column b = Column::Constant(3, way == 0.0 ? 0.4L : 0.0L);
        for (Eigen::Index c = 0; c < 2; ++c) {
          A(2 * c, 2 * c) += springs[static_cast<std::size_t>(c)];
          b(2 * c) += static_cast<long double>(springs[static_cast<std::size_t>(c)]) * way;
        }
        const Column q = A.fullPivLu().solve(b);
        const Eigen::VectorXd moved = slipping.to_q * found.slipping.real();
        EXPECT_LT((moved - q.cast<double>()).norm(), 1e-13 * static_cast<double>(q.norm()));
        for (Eigen::Index c = 0; c < 2; ++c) {
          const auto force = static_cast<double>(springs[static_cast<std::size_t>(c)] * (way - q(2 * c)));
          EXPECT_NEAR(found.force(c).real(), force, 1e-13 * (1.0 + std::abs(force)));
        }
      }
    }
}

}  // namespace
}  // namespace slipmode::dynamics
