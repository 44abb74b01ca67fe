#include <slipmode/diagnostics/validation/validate.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {
namespace {

/// The chaotic chain's ensemble (short) and what is judged by it: POMs, and LNMs about the same mean.
struct Study {
  dynamics::HybridSystem full = tests::chain10(0.2);
  dynamics::State start = full.rest();
  pod::PodResult pod;
  std::vector<pod::NamedBasis> candidates;

  Study() {
    const dynamics::Trajectory run =
        dynamics::simulate(full, start, {.duration = 30000.0, .transient = 20000.0, .sample = 0.5});
    start = run.final_state;  // on the attractor: the way there from rest takes thousands of units
    const pod::Ensemble ensemble{.snapshots = run.q};
    pod = pod::pod(ensemble);
    pod::Basis lnm = rom::lnm_basis(full.structure(), 10);
    lnm.mean = pod.basis.mean;
    candidates = {{"POM", pod.basis, pod::captured_energy(ensemble, pod.basis)},
                  {"LNM", lnm, pod::captured_energy(ensemble, lnm)}};
  }
};

const Study& study() {
  static const Study once;
  return once;
}

/// Small enough for a test: no sweep, no timing unless asked.
ValidationOptions quick_validation() {
  ValidationOptions options;
  options.horizon_starts = 6;
  options.settle = {.transient = 1000.0, .block = 2000.0, .limit = 10000.0};
  options.lyapunov = {.transient = 0.0, .duration = 4000.0};
  options.cost_duration = 0.0;
  return options;
}

// Chaos needs an exponent above its error; a torus one that is zero within a small error; else nothing is known.
TEST(AttractorWord, CallsAperiodicOnlyWhatHasAPositiveExponent) {
  const auto word = [](Motion motion, std::optional<LyapunovExponent> exponent) {
    Settled settled;
    settled.period.motion = motion;
    settled.slip_rate = 0.1;
    return attractor_word(settled, exponent);
  };
  const auto exponent = [](double nats, double error) { return LyapunovExponent{.nats = nats, .error = error}; };
  EXPECT_EQ(word(Motion::kAperiodic, exponent(0.0139, 0.0004)), "aperiodic");
  EXPECT_EQ(word(Motion::kAperiodic, exponent(7e-5, 3e-5)), "quasi-periodic");
  EXPECT_EQ(word(Motion::kAperiodic, exponent(-3e-5, 3e-5)), "quasi-periodic");
  EXPECT_EQ(word(Motion::kAperiodic, exponent(1e-3, 5e-4)), "undecided") << "may be chaos: too large an error";
  EXPECT_EQ(word(Motion::kAperiodic, exponent(-2e-3, 1e-4)), "undecided") << "still settling";
  EXPECT_EQ(word(Motion::kAperiodic, std::nullopt), "undecided");
  EXPECT_EQ(word(Motion::kUndecided, std::nullopt), "undecided");
  EXPECT_EQ(word(Motion::kPeriodic, std::nullopt), "periodic");
}

TEST(Validate, GivesATableRowForEveryNumberOfModesAndBasis) {
  const ValidationReport report = validate(study().full, study().candidates, study().start, quick_validation());
  ASSERT_EQ(report.candidates.size(), 2u);
  EXPECT_EQ(report.full.period.motion, Motion::kAperiodic);
  EXPECT_EQ(report.chosen, 6);  // 99 % of the energy, as in S4 table 3.1
  for (const CandidateReport& candidate : report.candidates) {
    ASSERT_EQ(candidate.shares.size(), 10u);
    for (std::size_t i = 0; i < 10; ++i) {
      const ShareRow& row = candidate.shares[i];
      EXPECT_EQ(row.modes, static_cast<Eigen::Index>(i + 1));
      EXPECT_EQ(row.failure, "");
      EXPECT_TRUE(row.attractor.has_value());
      if (i == 0) continue;
      EXPECT_GT(row.energy, candidate.shares[i - 1].energy);
      EXPECT_LE(row.start_error, candidate.shares[i - 1].start_error * (1.0 + 1e-12));
    }
  }
  // POMs are the optimal basis for the ensemble's displacements, whatever L.
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_GE(report.candidates[0].shares[i].energy, report.candidates[1].shares[i].energy - 1e-9);
  }
}

TEST(Validate, AllModesAreTheFullModel) {
  ValidationOptions options = quick_validation();
  options.modes = {10};
  options.lyapunov.duration = 20000.0;
  const ValidationReport report = validate(study().full, study().candidates, study().start, options);
  for (const CandidateReport& candidate : report.candidates) {
    const ShareRow& row = candidate.shares.front();
    EXPECT_NEAR(row.energy, 100.0, 1e-9);
    EXPECT_LT(row.start_error, 1e-10);
    // Up to the horizon of 100 units, 1.4 e-folds of the chaotic growth.
    EXPECT_LT(row.horizon.dX, 1e-5);
    EXPECT_LT(row.horizon.dE, 1e-5);
    EXPECT_TRUE(row.is_chaotic());
  }
}

TEST(ModeLadder, IsAllOfFewAndGrowsBeyond) {
  EXPECT_EQ(mode_ladder(5, 3), (std::vector<Eigen::Index>{1, 2, 3, 4, 5}));
  EXPECT_EQ(mode_ladder(100, 10), (std::vector<Eigen::Index>{1, 2, 3, 4, 6, 8, 10, 12, 16, 24, 32, 48, 64, 96, 100}));
}

// What is tried is what would be tried without growing, up to the second row in turn within the scatter, from the modes
// chosen on; all, in a draw of the chaotic motion that scatters so little that there are none.
TEST(Validate, GrowsUntilTheDeviationSinksIntoTheScatter) {
  ValidationOptions options = quick_validation();
  options.modes = {1, 2, 4, 6, 7, 8, 9, 10};
  const ValidationReport all = validate(study().full, study().candidates, study().start, options);
  options.grow = true;
  const ValidationReport grown = validate(study().full, study().candidates, study().start, options);
  const auto within = [&](std::size_t i) {
    return options.modes[i] >= all.chosen && std::ranges::all_of(all.candidates, [&](const CandidateReport& c) {
             return c.shares[i].distance.wasserstein <= 3.0 * all.noise.wasserstein;
           });
  };
  std::size_t tried = 2;
  while (tried < options.modes.size() && !(within(tried - 1) && within(tried - 2))) ++tried;
  for (const std::size_t candidate : {0, 1}) {
    const std::vector<ShareRow>& rows = grown.candidates[candidate].shares;
    ASSERT_EQ(rows.size(), tried);
    for (std::size_t i = 0; i < tried; ++i)
      EXPECT_EQ(rows[i].distance.wasserstein, all.candidates[candidate].shares[i].distance.wasserstein);
  }
  EXPECT_EQ(grown.left_out_above, tried < options.modes.size() ? options.modes[tried - 1] : 0);
  EXPECT_EQ(all.left_out_above, 0);
}

TEST(Validate, AllModesHaveTheFullOrbit) {
  ValidationOptions options = quick_validation();
  options.modes = {10};
  options.orbit_speeds = {0.45};
  options.settle.limit = 40000.0;
  const ValidationReport report = validate(study().full, study().candidates, study().full.rest(), options);
  for (const CandidateReport& candidate : report.candidates) {
    ASSERT_EQ(candidate.orbits.size(), 1u);
    ASSERT_TRUE(candidate.orbits[0].comparison.has_value()) << candidate.orbits[0].failure;
    EXPECT_TRUE(candidate.orbits[0].comparison->same_period);
    EXPECT_LT(candidate.orbits[0].comparison->deviation.dX, 1e-4);           // orbits settled to 1e-8
    EXPECT_NEAR(candidate.orbits[0].comparison->reduced.T, 45.10211, 1e-5);  // datasets/chain10/expected.toml
  }
}

TEST(Validate, ChaosIsLostBelowSixModesAndKeptAbove) {
  // Origin: two fixed-step programs found chaos in the reduced models from six modes on; see docs/theory.
  ValidationOptions options = quick_validation();
  options.modes = {3, 6, 8};
  options.settle.limit = 40000.0;
  options.lyapunov = {.transient = 0.0, .duration = 20000.0};
  const ValidationReport report = validate(study().full, study().candidates, study().start, options);
  ASSERT_TRUE(report.lyapunov.has_value());
  EXPECT_GT(report.lyapunov->nats, 4.0 * report.lyapunov->error);
  for (const CandidateReport& candidate : report.candidates) {
    EXPECT_FALSE(candidate.shares[0].is_chaotic()) << candidate.name;
    EXPECT_TRUE(candidate.shares[1].is_chaotic()) << candidate.name;
    EXPECT_TRUE(candidate.shares[2].is_chaotic()) << candidate.name;
  }
}

TEST(Validate, TriesOtherStartsWhereTheGivenOneLeadsToNoOrbit) {
  // One undamped mass, Coulomb friction: at the sliding equilibrium it stays for ever, starts further than V/ω from it
  // end on the stick-slip cycle (fixtures/belt_oscillator.hpp).
  const fixtures::BeltOscillator o;
  const dynamics::HybridSystem full = tests::system_of(o);
  const std::vector<pod::NamedBasis> all = {
      {"all", rom::user_basis(Eigen::MatrixXd::Identity(1, 1)), Eigen::VectorXd::Ones(1)}};
  ValidationOptions options = quick_validation();
  options.speed = o.belt;
  options.orbit_speeds = {o.belt};
  options.orbit_starts = 1;
  ValidationReport report = validate(full, all, sliding_equilibrium(full), options);
  EXPECT_NE(report.candidates[0].orbits[0].failure.find("sliding"), std::string::npos);
  EXPECT_EQ(report.full.period.motion, Motion::kSliding);
  EXPECT_EQ(report.candidates[0].shares[0].attractor->period.motion, Motion::kSliding);
  EXPECT_NE(report.candidates[0].shares[0].failure.find("moves"), std::string::npos);  // ΔX of a model at rest

  options.orbit_starts = 12;
  report = validate(full, all, sliding_equilibrium(full), options);
  ASSERT_TRUE(report.candidates[0].orbits[0].comparison.has_value()) << report.candidates[0].orbits[0].failure;
  EXPECT_TRUE(report.candidates[0].orbits[0].comparison->same_period);
  EXPECT_NEAR(report.candidates[0].orbits[0].comparison->full.T, o.period(), 1e-9);
}

TEST(Validate, ComparesSweepsAndCostAtTheChosenNumberOfModes) {
  ValidationOptions options = quick_validation();
  options.modes = {10};
  options.chosen = 10;
  options.sweep_values = {0.45, 0.44, 0.43};
  options.sweep_settle.limit = 20000.0;  // 0.044 slips per unit: more than a verdict needs
  options.cost_duration = 200.0;
  options.cost_repeats = 1;
  std::size_t last = 0, total = 0;
  options.parallel.progress = [&](std::size_t done, std::size_t of) {
    last = done;
    total = of;
  };
  const ValidationReport report = validate(study().full, study().candidates, study().start, options);
  EXPECT_FALSE(report.interrupted);
  EXPECT_EQ(last, total);
  ASSERT_TRUE(report.bifurcation.has_value());
  EXPECT_EQ(report.bifurcation->values, 3u);
  EXPECT_EQ(report.bifurcation->decided, 3u);
  EXPECT_EQ(report.bifurcation->same_motion, 1.0);
  ASSERT_TRUE(report.cost.has_value());
  EXPECT_GT(report.cost->full_wall, 0.0);
}

TEST(Validate, SweepsWaitForTheirOwnLimitAndAuditNothing) {
  ValidationOptions options = quick_validation();
  options.modes = {6};
  options.sweep_values = {0.2};  // chaos: no limit is ever cut short by a period
  options.sweep_settle = {.transient = 300.0, .block = 700.0, .limit = 700.0, .flow = {.audit = false}};
  const ValidationReport report = validate(study().full, study().candidates, study().start, options);
  for (const auto& points : {report.sweep->full, report.sweep->reduced}) {
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].settled.time, 1000.0);
    EXPECT_TRUE(std::isnan(points[0].settled.audit_residual));
  }
  EXPECT_EQ(report.full.time, 11000.0);
  EXPECT_LT(report.full.audit_residual, 1e-9);
}

TEST(Validate, MeasuresEveryExponentFromTheEndOfItsAttractor) {
  ValidationOptions options = quick_validation();
  options.modes = {10};
  const ValidationReport report = validate(study().full, study().candidates, study().full.rest(), options);
  ASSERT_TRUE(report.lyapunov.has_value());
  EXPECT_EQ(report.lyapunov->nats, largest_exponent(study().full, report.full.end, options.lyapunov).nats);
}

TEST(Validate, GivesTheSameBytesForAnyNumberOfThreads) {
  ValidationOptions options = quick_validation();
  options.modes = {4, 6};
  options.parallel.threads = 1;
  const ValidationReport one = validate(study().full, study().candidates, study().start, options);
  options.parallel.threads = 3;
  const ValidationReport three = validate(study().full, study().candidates, study().start, options);
  EXPECT_EQ(one.noise.wasserstein, three.noise.wasserstein);
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t i = 0; i < 2; ++i) {
      const ShareRow& a = one.candidates[c].shares[i];
      const ShareRow& b = three.candidates[c].shares[i];
      EXPECT_EQ(a.horizon.dX, b.horizon.dX);
      EXPECT_EQ(a.distance.wasserstein, b.distance.wasserstein);
      EXPECT_EQ(a.attractor->mean_energy, b.attractor->mean_energy);
      EXPECT_EQ(a.lyapunov.has_value(), b.lyapunov.has_value());
    }
  }
}

TEST(Validate, ABasisTheContactCannotSeeFillsItsRowWithTheReason) {
  pod::NamedBasis blind{.name = "blind", .basis = study().candidates[0].basis, .captured = Eigen::VectorXd::Ones(1)};
  blind.basis.vectors = Eigen::MatrixXd::Identity(10, 1);  // the first mass alone; the contact is on the tenth
  ValidationOptions options = quick_validation();
  options.modes = {1};
  options.chosen = 1;
  const ValidationReport report = validate(study().full, {study().candidates[0], blind}, study().start, options);
  EXPECT_EQ(report.candidates[0].shares[0].failure, "");
  EXPECT_NE(report.candidates[1].shares[0].failure, "");
  EXPECT_FALSE(report.candidates[1].shares[0].attractor.has_value());
}

TEST(Validate, RefusesWhatItCannotTryAndReportsAnInterrupt) {
  const auto run = [](const std::vector<pod::NamedBasis>& candidates, const ValidationOptions& options) {
    return validate(study().full, candidates, study().start, options);
  };
  ValidationOptions options = quick_validation();
  EXPECT_THROW((void)run({}, options), InvalidInput);
  options.modes = {11};
  EXPECT_THROW((void)run(study().candidates, options), InvalidInput);
  options = quick_validation();
  options.horizon = 0.0;
  EXPECT_THROW((void)run(study().candidates, options), InvalidInput);
  options = quick_validation();
  options.orbit_starts = 0;
  EXPECT_THROW((void)run(study().candidates, options), InvalidInput);
  std::vector<pod::NamedBasis> small = {
      {"small", rom::lnm_basis(fem::chain({.masses = 3}), 2), Eigen::VectorXd::Ones(2)}};
  EXPECT_THROW((void)run(small, quick_validation()), InvalidInput);
  options = quick_validation();
  const StopFlag stop = true;
  options.parallel.stop = &stop;
  EXPECT_TRUE(run(study().candidates, options).interrupted);
}

TEST(ModesForShare, IsTheSmallestNumberThatReachesIt) {
  const Eigen::Vector3d captured(0.6, 0.9, 1.0);
  EXPECT_EQ(pod::modes_for_share(captured, 0.5), 1);
  EXPECT_EQ(pod::modes_for_share(captured, 0.9), 2);
  EXPECT_EQ(pod::modes_for_share(captured, 0.91), 3);
  EXPECT_EQ(pod::modes_for_share(captured, 1.1), 3);
}

}  // namespace
}  // namespace slipmode::diagnostics
