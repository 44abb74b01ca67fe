// Fronts, choices and sentences: pure arithmetic, on made-up offers.

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/lean.hpp>
#include <slipmode/trade/pareto.hpp>
#include "cli/small_scenes.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace slipmode::trade {
namespace {

TEST(ParetoFront, HoldsExactlyWhatNothingElseBeats) {
  // Costs and errors from a coarse grid, so that equal ones occur. The definition itself is what is compared with.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    std::vector<Offer> offers;
    for (int i = 0; i < 40; ++i) {
      offers.push_back({.cost = std::floor(random.uniform(1.0, 12.0)), .error = std::floor(random.uniform(0.0, 12.0))});
    }
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < offers.size(); ++i) {
      const bool beaten = std::ranges::any_of(offers, [&](const Offer& other) {
        return other.cost <= offers[i].cost && other.error <= offers[i].error &&
               (other.cost < offers[i].cost || other.error < offers[i].error);
      });
      const auto first = std::ranges::find_if(
          offers, [&](const Offer& other) { return other.cost == offers[i].cost && other.error == offers[i].error; });
      if (!beaten && first == offers.begin() + static_cast<std::ptrdiff_t>(i)) expected.push_back(i);
    }
    std::ranges::sort(expected, {}, [&](std::size_t i) { return offers[i].cost; });
    EXPECT_EQ(pareto_front(offers), expected) << "seed " << seed;
  }
}

TEST(ParetoFront, DoesNotTellErrorsWithinTheirScatterApart) {
  const std::vector<Offer> offers = {{1.0, 0.4, 0.5}, {2.0, 0.1, 0.5}, {3.0, 0.2, 0.3}};
  EXPECT_EQ(pareto_front(offers), (std::vector<std::size_t>{0, 2}));
}

TEST(ParetoFront, LeavesOutWhatIsNotKnown) {
  const std::vector<Offer> offers = {{kNone, 1.0}, {1.0, kNone}, {2.0, 3.0, kNone}, {3.0, 2.0}};
  EXPECT_EQ(pareto_front(offers), std::vector<std::size_t>{3});
  EXPECT_TRUE(pareto_front(std::vector<Offer>{}).empty());
}

TEST(Choices, ALimitHoldsWithTheScatterOfTheErrorOrIsNotAssured) {
  // The first is cheap and right by luck: its scatter is above the limit of 1 %. The second may be 1.3 % wrong.
  const std::vector<Offer> offers = {{1.0, 0.1, 2.0}, {3.0, 0.8, 0.5}, {4.0, 0.2, 0.1}};
  EXPECT_EQ(cheapest_within_error(offers, 1.0), 2U);
  EXPECT_EQ(cheapest_within_error(offers, 1.5), 1U);
  EXPECT_EQ(cheapest_within_error(offers, 2.0), 1U);
  EXPECT_EQ(cheapest_within_error(offers, 2.5), 0U);
  EXPECT_FALSE(cheapest_within_error(offers, 0.25).has_value());
}

TEST(Choices, WithinTheNoiseTheCheaperOfTheAffordableIsTaken) {
  const std::vector<Offer> offers = {{5.0, 0.01, 0.5}, {2.0, 0.4, 0.5}, {1.0, 7.0, 0.5}};
  EXPECT_EQ(best_within_budget(offers, 10.0), 1U);
  EXPECT_EQ(best_within_budget(offers, 1.5), 2U);
  EXPECT_FALSE(best_within_budget(offers, 0.5).has_value());
  EXPECT_EQ(cheapest(offers), 2U);
  EXPECT_EQ(most_accurate(offers), 1U);
}

/// A row with one error under dE and little under all else.
Row row(const std::string& name, Axis axis, double cpu, double dE, double spread = 0.1) {
  Row made;
  made.variant.name = name;
  made.variant.axis = axis;
  made.error = {dE, dE, spread, spread, spread, spread};
  made.noise.fill(0.05);
  made.cost = {.wall = cpu, .cpu = cpu, .cpu_low = cpu, .cpu_high = cpu, .setup = 0.5, .simulated = 10.0};
  return made;
}

/// 8 s, 2 s and 1 s per 10 units; the last one is 40 % off in the settled motion although its dE is small.
Study made_study() {
  Study study;
  study.rows = {row("scene as it stands", Axis::kScene, 8.0, 0.0), row("6 POM", Axis::kModes, 2.0, 0.4),
                row("2 POM", Axis::kModes, 1.0, 0.2, 40.0)};
  study.rows[1].variant.reduction = study.rows[2].variant.reduction = Reduction{};
  study.rows[1].basis_seconds = 30.0;
  return study;
}

TEST(Choices, WhatAgreesByChanceIsNotChosen) {
  const Study study = made_study();
  EXPECT_FALSE(is_alike(study.rows[2], 1.0));
  const Choice choice = choose(study, {.limit = 1.0, .duration = 10.0});
  EXPECT_EQ(choice.row, 1U);
  EXPECT_EQ(choice.sentence,
            "for dE under 1 % use 6 POM: 4 times faster than the scene as it stands (dE 0.4 ± 0.05 %)");
  EXPECT_EQ(recommendation(study, Measure::kDe, 1.0), choice.sentence);
}

TEST(Choices, WhatMayBeBeyondTheLimitIsSaidNotToBeAssured) {
  Study study = made_study();
  study.rows.erase(study.rows.begin());
  at(study.rows[0].error, Measure::kDe) = 0.76;
  at(study.rows[0].noise, Measure::kDe) = 0.83;
  EXPECT_EQ(recommendation(study, Measure::kDe, 1.0),
            "for dE under 1 % not assured by anything that was tried; nearest is 6 POM (dE 0.76 ± 0.83 %)");
  EXPECT_THROW((void)choose(study, {.limit = 1.0, .duration = 10.0}), InvalidInput);
}

TEST(Choices, TheSceneStandsWhereOthersAreHardlyFaster) {
  Study study = made_study();
  study.rows[1].cost.cpu = 7.9;
  EXPECT_EQ(choose(study, {.limit = 1.0, .duration = 10.0}).row, 0U);
  EXPECT_EQ(choose(study, {.limit = 1.0, .budget = 8.45, .duration = 10.0}).row, 1U) << "8.4 s against 8.5 s";
}

TEST(Choices, AllModesAreNoReduction) {
  Study study = made_study();
  study.rows[1].variant.scene.structure = fem::ChainOptions{.masses = 6};
  study.rows[1].variant.reduction = Reduction{.basis = scene::BasisChoice::kPom, .modes = 6};
  EXPECT_EQ(choose(study, {.limit = 1.0, .duration = 10.0}).row, 0U);
}

TEST(Choices, ABudgetCountsSetUpAndTheLengthOfTheRun) {
  // 20 units: 16.5, 4.5 and 2.5 s.
  const Study study = made_study();
  EXPECT_EQ(choose(study, {.budget = 17.0, .duration = 20.0}).row, 0U);
  EXPECT_EQ(choose(study, {.budget = 16.0, .duration = 20.0}).row, 2U) << "dE alone is asked for: 0.2 % beats 0.4 %";
  EXPECT_EQ(choose(study, {.limit = 1.0, .budget = 16.0, .duration = 20.0}).row, 1U);
}

TEST(Choices, WhatCannotBeHadNamesTheNearest) {
  const auto said = [](const Wish& wish) -> std::string {
    try {
      (void)choose(made_study(), wish);
    } catch (const InvalidInput& refusal) {
      return refusal.what();
    }
    return "";
  };
  EXPECT_NE(said({.budget = 1.0, .duration = 20.0}).find("the cheapest that exists: 2 POM, 2.5 s"), std::string::npos);
  EXPECT_NE(said({.limit = 0.01}).find("the most accurate that exists: scene as it stands"), std::string::npos);
  EXPECT_NE(said({.limit = 0.5, .budget = 1.0, .duration = 20.0}).find("within a budget of 1 s"), std::string::npos);
}

TEST(Choices, ABasisIsPaidForByTheTimeSaved) {
  // 6 s saved per 10 units, so 12 s per run of 20; 30 s for the basis and 0.5 s for the projection.
  const Study study = made_study();
  EXPECT_DOUBLE_EQ(break_even(study, study.rows[1], 20.0), 30.5 / 12.0);
  EXPECT_DOUBLE_EQ(speed_up(study, study.rows[1]), 4.0);
  EXPECT_EQ(break_even(study, study.rows[0], 20.0), std::numeric_limits<double>::infinity());
}

TEST(Judgements, AreNeededBeyondBoundAndScatterAndSpareWithinBoth) {
  const auto verdict = [](double spread, double noise) {
    Row without = row("without", Axis::kEffect, 4.0, 9.0, spread);
    at(without.noise, Measure::kSpread) = noise;
    at(without.error, Measure::kPoints) = at(without.error, Measure::kEnergy) = at(without.error, Measure::kStick) =
        kNone;
    return judge(without, {.question = Question::kStatistics, .bound = 1.0});
  };
  EXPECT_EQ(verdict(5.0, 1.0).verdict, Verdict::kNeeded);
  EXPECT_EQ(verdict(5.0, 3.0).verdict, Verdict::kUnclear);
  EXPECT_EQ(verdict(0.5, 3.0).verdict, Verdict::kUnclear);
  EXPECT_EQ(verdict(0.5, 0.4).verdict, Verdict::kSpare);
  EXPECT_EQ(verdict(kNone, kNone).verdict, Verdict::kUnclear) << "nothing was measured";
  EXPECT_EQ(verdict(5.0, 1.0).measure, Measure::kSpread);
  // The same row is 9 % off in dE: the other question has another answer, one measure may be a part of it.
  const Row without = row("without", Axis::kEffect, 4.0, 9.0, 0.5);
  EXPECT_EQ(judge(without, {.question = Question::kMotion, .bound = 1.0}).verdict, Verdict::kNeeded);
  EXPECT_EQ(judge(without, {.question = Question::kMotion, .bound = 1.0, .only = Measure::kSpread}).verdict,
            Verdict::kSpare);
  Row failed = row("without", Axis::kEffect, kNone, kNone);
  failed.failure = "no convergence";
  EXPECT_EQ(judge(failed, {}).verdict, Verdict::kFailed);
}

/// Effects without any work to do, and a study whose rows have the error that `error` gives a set.
class LeanScenes : public testing::Test {
 protected:
  Lean search(const std::function<double(const Variant&)>& error) {
    rows.clear();
    rounds = 0;
    const auto add = [&](const Variant& variant) {
      rows.push_back(row(variant.name, variant.axis, 1.0, error(variant)));
      rows.back().variant = variant;
    };
    for (std::size_t e = 0; e < effects.size(); ++e) add(without(scene, effects, {e}));
    for (;; ++rounds) {
      Lean lean = lean_scene(scene, effects, rows, {.question = Question::kMotion, .bound = 2.0});
      if (lean.wanted.empty()) return lean;
      for (const Variant& wanted : lean.wanted) add(wanted);
    }
  }

  static Effect effect(const std::string& name, const std::string& ladder = "") {
    return {.name = name, .change = [](const scene::Scene& s) { return s; }, .ladder = ladder};
  }

  scene::Scene scene = scene::parse_scene(tests::kTwoContacts);
  std::vector<Effect> effects = {effect("a"), effect("b"), effect("c"), effect("d"), effect("e")};
  std::vector<Row> rows;
  int rounds = 0;
};

/// Errors of effects a, b, ... that add up.
double sum_of(const Variant& variant, const std::map<char, double>& errors) {
  const std::string names = variant.name.substr(variant.name.find("without ") + 8);
  double sum = 0.0;
  for (const auto& [letter, error] : errors) sum += names.find(letter) == std::string::npos ? 0.0 : error;
  return sum;
}

TEST_F(LeanScenes, LeaveOutTheLeastFirstUntilTheBoundBreaks) {
  // By hand: c 0.1, e 0.4, a 0.7 make 1.2; b with 0.9 would make 2.1 and stays; d breaks the bound alone.
  const Lean lean = search([](const Variant& v) {
    return sum_of(v, {{'a', 0.7}, {'b', 0.9}, {'c', 0.1}, {'d', 3.0}, {'e', 0.4}});
  });
  EXPECT_EQ(lean.left_out, (std::vector<std::size_t>{0, 2, 4}));
  ASSERT_EQ(lean.steps.size(), 4U);
  EXPECT_EQ(lean.steps[0].effect, 2U);
  EXPECT_EQ(lean.steps[3].effect, 1U);
  EXPECT_FALSE(lean.steps[3].left_out);
  ASSERT_TRUE(lean.verified);
  EXPECT_EQ(rows[*lean.verified].variant.axis, Axis::kLean);
  EXPECT_TRUE(lean.put_back.empty());
}

TEST_F(LeanScenes, GoOnWhereTwoEffectsBreakTheBoundOnlyTogether) {
  // a and b change 0.1 and 0.2 alone and 5 together; c, d and e nothing that matters.
  const Lean lean = search([](const Variant& v) {
    const double both = sum_of(v, {{'a', 1.0}, {'b', 1.0}});
    return both == 2.0 ? 5.0 : sum_of(v, {{'a', 0.1}, {'b', 0.2}, {'c', 0.3}, {'d', 0.4}, {'e', 0.5}});
  });
  EXPECT_EQ(lean.left_out, (std::vector<std::size_t>{0, 2, 3, 4}));
}

TEST_F(LeanScenes, GiveBackWhatTheWholeCannotDoWithout) {
  // Measured once more with d, the last one left out, the whole is too far off; without c alone it is not.
  const Lean lean = search([](const Variant& v) {
    const bool too_far = v.axis == Axis::kLean && sum_of(v, {{'d', 1.0}}) > 0.0;
    return too_far ? 2.5 : sum_of(v, {{'a', 9.0}, {'b', 9.0}, {'c', 0.1}, {'d', 0.2}, {'e', 9.0}});
  });
  EXPECT_EQ(lean.left_out, std::vector<std::size_t>{2});
  EXPECT_EQ(lean.put_back, std::vector<std::size_t>{3});
}

TEST_F(LeanScenes, TakeTheFurthestStepOfALadderThatKeepsToTheBound) {
  effects = {effect("a", "steps"), effect("b", "steps"), effect("c", "steps"), effect("d"), effect("e")};
  const Lean lean = search([](const Variant& v) {
    return sum_of(v, {{'a', 0.1}, {'b', 0.3}, {'c', 1.5}, {'d', 0.6}, {'e', 5.0}});
  });
  EXPECT_EQ(lean.left_out, (std::vector<std::size_t>{1, 3})) << "b is further than a, c with d is too far";
  EXPECT_EQ(without(scene, effects, {0, 1, 3}).name, "without b, d");
}

TEST_F(LeanScenes, AreTheSceneItselfWhereNothingCanBeLeftOut) {
  const Lean lean = search([](const Variant&) { return 50.0; });
  EXPECT_TRUE(lean.left_out.empty());
  EXPECT_FALSE(lean.verified);
  EXPECT_EQ(rounds, 0);
}

}  // namespace
}  // namespace slipmode::trade
