#include <slipmode/diagnostics/model.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/diagnostics/validation/cost.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace slipmode::diagnostics {
namespace {

TEST(SlidingEquilibrium, OfTheChainRisesByTheFrictionForcePerSpring) {
  // Every spring carries λ = N(μ_k + (μ_s − μ_k)e^{−αV}); unit stiffness.
  const double lambda = 3.0 * (0.2 + 0.2 * std::exp(-8.0 * 0.2));
  const dynamics::State state = sliding_equilibrium(tests::chain10(0.2));
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(state.q[i], lambda * (i + 1), 1e-12);
  EXPECT_TRUE(state.v.isZero(0.0));
  const dynamics::State backwards = sliding_equilibrium(tests::chain10(-0.2));
  EXPECT_NEAR(backwards.q[9], -10.0 * lambda, 1e-12);
  EXPECT_TRUE(sliding_equilibrium(tests::chain10(0.0)).q.isZero(0.0));
}

TEST(SlidingEquilibrium, RefusesAStructureThatFloats) {
  const dynamics::HybridSystem free(fem::chain({.masses = 4, .left_fixed = false}),
                                    {{Eigen::VectorXd::Unit(4, 3), friction::Coulomb{0.4, 0.2}, 1.0}},
                                    friction::Belt::constant(0.1));
  EXPECT_THROW((void)sliding_equilibrium(free), InvalidInput);
}

TEST(Model, ReducedEnergyPlusOffsetIsTheLiftedStatesEnergy) {
  const dynamics::HybridSystem bare = tests::chain10(0.2);
  const dynamics::HybridSystem system(bare.structure(), bare.contacts(), bare.drive(),
                                      Eigen::VectorXd::LinSpaced(10, -0.5, 0.4));
  pod::Basis basis = rom::lnm_basis(system.structure(), 4);
  basis.mean = Eigen::VectorXd::LinSpaced(10, 0.3, 3.0);
  const Model reduced = reduced_belt_model(system, basis);
  const dynamics::State state{0.0, Eigen::Vector4d(0.4, -0.3, 0.2, 0.1), Eigen::Vector4d(0.1, 0.2, -0.3, 0.4), {}};
  EXPECT_NEAR(reduced.system(0.3).energy(state) + energy_offset_at(reduced, 0.3), system.energy(lifted(reduced, state)),
              1e-12);
  EXPECT_EQ(reduced.system(0.3).drive().velocity(0.0), 0.3);
}

TEST(RandomStates, DependOnSeedAndIndexOnly) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const auto four = random_states(system, {.count = 4, .seed = 9});
  const auto two = random_states(system, {.count = 2, .seed = 9});
  EXPECT_EQ(four[1].q, two[1].q);
  EXPECT_EQ(four[1].v, two[1].v);
  EXPECT_NE(four[0].q, four[1].q);
  EXPECT_NE(random_states(system, {.seed = 10})[0].q, four[0].q);
  // Spread: 20 × 2000 standard normal numbers times 0.1; the sample's standard deviation is right to 0.1/sqrt(8e4).
  const auto many = random_states(system, {.count = 2000});
  const Eigen::VectorXd centre = sliding_equilibrium(system).q;
  double square = 0.0;
  for (const auto& state : many) square += (state.q - centre).squaredNorm() + state.v.squaredNorm();
  EXPECT_NEAR(std::sqrt(square / 40000.0), 0.1, 4.0 * 0.1 / std::sqrt(80000.0));
  EXPECT_THROW((void)random_states(system, {.count = 0}), InvalidInput);
  EXPECT_THROW((void)random_states(system, {.spread = -1.0}), InvalidInput);
}

TEST(EnsembleRun, GivesTheSameBytesForAnyNumberOfThreads) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const auto starts = random_states(system, {.count = 3});
  EnsembleOptions options{.duration = 300.0, .transient = 100.0, .sample = 0.5};
  options.parallel.threads = 1;
  const EnsembleRun one = run_ensemble(belt_model(tests::chain10(0.2)), {0.2, 0.3}, starts, options);
  EXPECT_EQ(one.ensemble.snapshots.cols(), 6 * 401);
  EXPECT_EQ(one.ensemble.run_begin, (std::vector<Eigen::Index>{0, 401, 802, 1203, 1604, 2005}));
  EXPECT_EQ(one.members[4].parameter, 0.3);
  EXPECT_EQ(one.members[4].start, 1);
  // Members are the runs themselves.
  const dynamics::Trajectory fifth = dynamics::simulate(belt_model(system).system(0.3), starts[1],
                                                        {.duration = 300.0, .transient = 100.0, .sample = 0.5});
  EXPECT_EQ(one.ensemble.snapshots.middleCols(1604, 401), fifth.q);
  options.parallel.threads = 4;
  const EnsembleRun four = run_ensemble(belt_model(tests::chain10(0.2)), {0.2, 0.3}, starts, options);
  EXPECT_EQ(std::memcmp(four.ensemble.snapshots.data(), one.ensemble.snapshots.data(),
                        sizeof(double) * static_cast<std::size_t>(one.ensemble.snapshots.size())),
            0);
}

TEST(EnsembleRun, InPartsIsTheWholeSideBySide) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const auto starts = random_states(system, {.count = 3});
  EnsembleOptions options{.duration = 50.0, .transient = 0.0, .sample = 0.5};
  const EnsembleRun whole = run_ensemble(belt_model(system), {0.2, 0.3}, starts, options);
  for (const std::size_t parts : {2U, 4U, 7U}) {
    options.parts = parts;
    Eigen::Index column = 0;
    std::size_t member = 0;
    for (options.part = 1; options.part <= parts; ++options.part) {
      const EnsembleRun part = run_ensemble(belt_model(system), {0.2, 0.3}, starts, options);
      const Eigen::MatrixXd& snapshots = part.ensemble.snapshots;
      if (snapshots.cols() > 0) {
        EXPECT_EQ(snapshots, whole.ensemble.snapshots.middleCols(column, snapshots.cols()));
      }
      column += snapshots.cols();
      for (const EnsembleMember& one : part.members) {
        EXPECT_EQ(one.start, whole.members[member].start);
        EXPECT_EQ(one.parameter, whole.members[member].parameter);
        EXPECT_EQ(one.audit.residual(), whole.members[member++].audit.residual());
      }
    }
    EXPECT_EQ(member, 6U);
    EXPECT_EQ(column, whole.ensemble.snapshots.cols());
  }
}

TEST(EnsembleRun, RecordsAMemberThatFailsAndKeepsTheOthers) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  Model model = belt_model(system);
  const dynamics::SystemFamily sound = model.system;
  model.system = [sound](double speed) {
    if (speed == 0.3) throw NumericalFailure("made to fail", 0.0, {}, 0.0);
    return sound(speed);
  };
  const EnsembleOptions options{.duration = 50.0, .transient = 0.0, .sample = 0.5};
  const auto starts = random_states(system, {.count = 1});
  const EnsembleRun run = run_ensemble(model, {0.2, 0.3, 0.4}, starts, options);
  EXPECT_EQ(run.ensemble.snapshots.cols(), 2 * 101);
  EXPECT_EQ(run.members[1].failure, "made to fail");
  EXPECT_EQ(run.members[1].columns, 0);
  EXPECT_THROW((void)run_ensemble(model, {0.3}, starts, options), NumericalFailure);
  const EnsembleRun second = run_ensemble(model, {0.2, 0.3}, starts,
                                          {.duration = 50.0, .transient = 0.0, .sample = 0.5, .part = 2, .parts = 2});
  EXPECT_EQ(second.members.size(), 1U);
  EXPECT_EQ(second.ensemble.snapshots.cols(), 0) << "a part may fail as a whole";
  EXPECT_THROW((void)run_ensemble(model, {}, starts, options), InvalidInput);
  EXPECT_THROW((void)run_ensemble(model, {0.2}, starts, {.duration = 10.0, .transient = 10.0}), InvalidInput);
}

TEST(EnsembleRun, RefusesAPartThatThereIsNot) {
  const dynamics::HybridSystem system = tests::chain10(0.2);
  const auto starts = random_states(system, {.count = 3});
  EnsembleOptions options{.duration = 50.0, .transient = 0.0, .sample = 0.5};
  for (const auto& [part, parts] : {std::pair(0U, 2U), std::pair(3U, 2U), std::pair(0U, 0U), std::pair(1U, 0U)}) {
    options.part = part;
    options.parts = parts;
    EXPECT_THROW((void)run_ensemble(belt_model(system), {0.2}, starts, options), InvalidInput);
  }
}

TEST(Cost, BreaksEvenWhenTheSavedTimePaysTheBasis) {
  // 10 − 2 saved per run against 30 + 2 once: four runs.
  const Cost cost{.full_wall = 10.0, .reduced_wall = 2.0, .projection_wall = 2.0};
  EXPECT_DOUBLE_EQ(cost.break_even(30.0), 4.0);
  const Cost slower{.full_wall = 1.0, .reduced_wall = 1.0};
  EXPECT_EQ(slower.break_even(1.0), std::numeric_limits<double>::infinity());
}

TEST(Cost, OfALargeChainFallsWithReduction) {
  // 300 masses held to ground against 4 modes: the work per step falls with the number of modes.
  const dynamics::HybridSystem system =
      fixtures::belt_chain(friction::Stribeck{0.4, 0.2, 8.0}, friction::Belt::constant(0.2), 300, 0.006, 3.0, {0.25});
  const Cost cost = measure_cost(system, rom::lnm_basis(system.structure(), 4), system.rest(), 200.0, 3);
  EXPECT_EQ(cost.duration, 200.0);
  EXPECT_GT(cost.reduced_wall, 0.0);
  EXPECT_GT(cost.projection_wall, 0.0);
  EXPECT_LT(cost.reduced_cpu, cost.full_cpu);
  EXPECT_THROW((void)measure_cost(system, rom::lnm_basis(system.structure(), 4), system.rest(), 0.0, 3), InvalidInput);
  EXPECT_THROW((void)measure_cost(system, rom::lnm_basis(system.structure(), 4), system.rest(), 1.0, 0), InvalidInput);
}

}  // namespace
}  // namespace slipmode::diagnostics
