#include <slipmode/diagnostics/validation/verdict.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/farthest_dof.hpp>
#include <slipmode/rom/reduce.hpp>
#include "fixtures/clearance_scenes.hpp"
#include "models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace slipmode::diagnostics {
namespace {

ModelVerdictOptions short_verdict() {
  return {.tangent = {.transient = 3000.0, .duration = 2000.0, .exponents = 3}, .samples = 4000, .references = 500};
}

TEST(FarthestDof, IsMostLinksAwayFromEveryContact) {
  EXPECT_EQ(farthest_dof(tests::chain10(0.2)), 0);  // the contact is on the last mass
  const fem::Structure chain = fem::chain({.masses = 5});
  const auto contact = [](Eigen::Index at) {
    return friction::Contact{.direction = fixtures::unit(5, at), .law = friction::Coulomb{0.3, 0.2}};
  };
  EXPECT_EQ(farthest_dof({chain, {contact(0), contact(4)}, friction::Belt::constant(0.2)}), 2);
  EXPECT_EQ(farthest_dof({chain, {}, friction::Belt::constant(0.2)}), 0);
}

TEST(ModelVerdict, AllModesAreTheFullModelUntilChaosPartsThem) {
  const dynamics::HybridSystem full = tests::chain10(0.2);
  const pod::Basis all = rom::lnm_basis(full.structure(), 10);
  const dynamics::State start =
      dynamics::simulate(full, sliding_equilibrium(full), {.duration = 9000.0, .flow = {.audit = false}}).final_state;
  const VerdictTable table = model_verdict(full, start, {{"10 LNMs", all}},
                                           {.tangent = {.transient = 0.0, .duration = 200.0, .exponents = 3},
                                            .sample = 0.1,
                                            .samples = 4000,
                                            .references = 1000});
  ASSERT_EQ(table.models.size(), 2U);
  EXPECT_EQ(table.channel, 0);
  const ModelFindings& a = table.models[0];
  const ModelFindings& b = table.models[1];
  EXPECT_EQ(a.name, "full");
  EXPECT_EQ(b.name, "10 LNMs");
  EXPECT_EQ(b.modes, 10);
  EXPECT_TRUE(a.failure.empty() && b.failure.empty());
  ASSERT_EQ(a.exponents.nats.size(), 3);
  // Three exponents tell the dimension only where their sum is below zero, which so short a stretch leaves to chance.
  EXPECT_EQ(std::isnan(a.kaplan_yorke.value), a.exponents.nats.sum() >= 0.0);
  EXPECT_EQ(a.record.size(), 4000);
  // The flow's tolerance of 1e-9, grown by e^(0.0135 · 400) and the kicks of 80 events: below 1e-4.
  EXPECT_LT((a.record - b.record).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_NEAR(a.stick_fraction.value, b.stick_fraction.value, 1e-4);
  EXPECT_LT(b.spectrum_distance.value, 1e-3);
  EXPECT_GT(a.spectrum_distance.value, 1e-3);  // its halves are 200 different units each
  EXPECT_EQ(a.delay.value, b.delay.value);
  // Where no dimension qualifies in so short a record there is none for either.
  EXPECT_TRUE(a.embedding.value == b.embedding.value ||
              (std::isnan(a.embedding.value) && std::isnan(b.embedding.value)));
  EXPECT_GT(a.stick_fraction.value, 0.3);
  EXPECT_LT(a.stick_fraction.value, 0.8);
  EXPECT_NEAR(a.stick_fraction.value, 0.5 * (a.stick_fraction.halves[0] + a.stick_fraction.halves[1]), 1e-12);
}

TEST(ModelVerdict, SameBytesForAnyNumberOfThreads) {
  const dynamics::HybridSystem full = tests::chain10(0.2);
  const pod::Basis basis = rom::lnm_basis(full.structure(), 6);
  ModelVerdictOptions options = short_verdict();
  options.tangent.duration = 400.0;
  options.parallel.threads = 1;
  const VerdictTable one = model_verdict(full, full.rest(), {{"6 LNMs", basis}}, options);
  options.parallel.threads = 2;
  const VerdictTable two = model_verdict(full, full.rest(), {{"6 LNMs", basis}}, options);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one.models[i].exponents.rates, two.models[i].exponents.rates);
    EXPECT_EQ(one.models[i].record, two.models[i].record);
    EXPECT_EQ(one.models[i].notes, two.models[i].notes);
    EXPECT_EQ(one.models[i].delay.value, two.models[i].delay.value);
    EXPECT_EQ(one.models[i].spectrum_distance.value, two.models[i].spectrum_distance.value);
  }
}

TEST(ModelVerdict, PeriodicMotionHasWhatItHasAndNotesOnTheRest) {
  // A driven train on a periodic orbit: all exponents negative, dimension 0; neighbour searches may find nothing.
  const dynamics::HybridSystem train = fixtures::backlash_train(1.2);
  const double period = *train.drive().period();
  const VerdictTable table =
      model_verdict(train, train.rest(), {},
                    {.tangent = {.transient = 3000.0 * period, .duration = 200.0 * period, .interval = period},
                     .sample = period / 16.0,
                     .samples = 2048,
                     .references = 300});
  const ModelFindings& found = table.models.front();
  EXPECT_LT(found.exponents.nats[0], 0.0);
  EXPECT_EQ(found.kaplan_yorke.value, 0.0);
  EXPECT_EQ(found.kaplan_yorke.spread(), 0.0);
  EXPECT_NEAR(found.spectrum_distance.value, 0.0, 1e-6);  // both halves are the same 64 periods
  EXPECT_EQ(found.stick_fraction.value, 0.0);
}

TEST(ModelVerdict, AModelThatCannotBeIsALine) {
  const dynamics::HybridSystem full = tests::chain10(0.2);
  pod::Basis blind = rom::user_basis(Eigen::MatrixXd::Identity(10, 3));  // no vector moves the driven mass
  ModelVerdictOptions options = short_verdict();
  options.tangent.duration = 100.0;
  const VerdictTable table = model_verdict(full, full.rest(), {{"blind", blind}}, options);
  EXPECT_FALSE(table.models[1].failure.empty());
  EXPECT_TRUE(table.models[0].failure.empty());
}

TEST(ModelVerdict, RefusesOptionsOutOfRange) {
  const dynamics::HybridSystem full = tests::chain10(0.2);
  EXPECT_THROW((void)model_verdict(full, full.rest(), {}, {.sample = 0.0}), InvalidInput);
  EXPECT_THROW((void)model_verdict(full, full.rest(), {}, {.samples = 100}), InvalidInput);
  EXPECT_THROW((void)model_verdict(full, full.rest(), {}, {.channel = 10}), InvalidInput);
  const StopFlag stop = true;
  EXPECT_THROW((void)model_verdict(full, full.rest(), {}, {.parallel = {.stop = &stop}}), Interrupted);
}

}  // namespace
}  // namespace slipmode::diagnostics
