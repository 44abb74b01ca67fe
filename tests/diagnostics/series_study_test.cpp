#include <slipmode/diagnostics/series/series_study.hpp>

#include <slipmode/core/errors.hpp>
#include "fixtures/test_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

/// Greatest distance of the section's instants from where sin t rises through zero, t = 2πk.
double crossing_error(int order, double interval) {
  const auto series = fixtures::sine(static_cast<Eigen::Index>(100.0 / interval), interval);
  const SectionPoints cut = section(series, {.embedding = {.dimension = 2, .lag = 3}, .level = 0.0, .order = order});
  double error = 0.0;
  for (Eigen::Index k = 0; k < cut.time.size(); ++k) {
    error = std::max(
        error, std::abs(cut.time(k) - 2.0 * std::numbers::pi * std::round(cut.time(k) / (2.0 * std::numbers::pi))));
  }
  return error;
}

// A polynomial of degree p misses by O(interval^(p + 1)); at a zero of sine the even derivatives vanish, and symmetric
// nodes of odd degree keep the order p + 1 there.
TEST(Section, ConvergesWithTheOrderOfItsPolynomials) {
  for (const int order : {1, 3, 5}) {
    const double rate = std::log2(crossing_error(order, 0.4) / crossing_error(order, 0.2));
    EXPECT_GT(rate, order + 0.5) << order;
  }
  EXPECT_LT(crossing_error(5, 0.1), 1e-9);
}

TEST(Section, TakesAllDelayCoordinatesAtOneInstant) {
  const double interval = 0.05;
  const auto series = fixtures::sine(4000, interval);
  const SectionPoints down =
      section(series, {.embedding = {.dimension = 3, .lag = 7}, .cut = Cut::kDownward, .level = 0.2});
  ASSERT_GT(down.time.size(), 20);
  for (Eigen::Index k = 0; k < down.time.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(down.points(c, k), std::sin(down.time(k) + 7.0 * c * interval), 1e-9);
    }
    EXPECT_LT(std::cos(down.time(k)), 0.0);
  }
  EXPECT_NEAR(down.mean_return, 2.0 * std::numbers::pi, 1e-8);
  EXPECT_LT(down.return_error, 1e-8);
}

TEST(Section, FindsMaximaBetweenSamples) {
  const SectionPoints tops = section(fixtures::sine(3000, 0.1), {.embedding = {.dimension = 1}, .cut = Cut::kMaximum});
  ASSERT_GT(tops.time.size(), 40);
  for (Eigen::Index k = 0; k < tops.time.size(); ++k) {
    EXPECT_NEAR(tops.points(0, k), 1.0, 1e-8);
    EXPECT_NEAR(std::fmod(tops.time(k), 2.0 * std::numbers::pi), 0.5 * std::numbers::pi, 1e-5);
  }
}

// Once per period a periodic record is one point; the second tone of a torus goes round a circle.
TEST(Section, StrobesADrivenRecord) {
  const SectionPoints one =
      section(fixtures::sine(3000, 0.1), {.cut = Cut::kStrobe, .period = 2.0 * std::numbers::pi, .phase = 0.25});
  EXPECT_NEAR(one.time(0), 0.5 * std::numbers::pi, 1e-12);
  EXPECT_LT((one.points.colwise() - one.points.col(0)).cwiseAbs().maxCoeff(), 1e-7);
  const SectionPoints circle =
      section(fixtures::two_torus(3000, 0.1), {.cut = Cut::kStrobe, .period = 2.0 * std::numbers::pi});
  const Eigen::ArrayXd phase = std::numbers::sqrt2 * circle.time.array();
  EXPECT_LT((circle.points.row(0).transpose().array() - 0.5 * phase.sin()).abs().maxCoeff(), 1e-6);
}

TEST(Section, RefusesWhatItCannotCut) {
  const auto series = fixtures::sine(100, 0.1);
  EXPECT_THROW((void)section(series, {.order = 2}), InvalidInput);
  EXPECT_THROW((void)section(series, {.cut = Cut::kStrobe}), InvalidInput);
  EXPECT_THROW((void)section(series, {.embedding = {.dimension = 20, .lag = 10}}), InvalidInput);
}

// A sine of 40 samples per period in two dimensions is a circle: x_i and x_j are near when i − j is near a multiple of
// the period, at every i. So whole diagonals recur, and the rate is the number of those gaps over 40.
TEST(Recurrence, OfACircleIsWholeDiagonals) {
  const double interval = 2.0 * std::numbers::pi / 40.0;
  // The chord of two intervals is 2 sin(interval) < 4 sin(interval/2) = 0.314, that of three 0.467: gaps within two of
  // a multiple of 40 recur, five in forty.
  const Recurrence plot = recurrence(fixtures::sine(1010, interval), {.embedding = {.dimension = 2, .lag = 10},
                                                                      .metric = Norm::kEuclidean,
                                                                      .radius = 4.0 * std::sin(interval / 2.0) + 1e-6,
                                                                      .window = 19});
  EXPECT_EQ(plot.points, 1000);
  // All but one pair: the outermost diagonal, 999 points apart, is a single point.
  EXPECT_NEAR(plot.determinism, 1.0 - 1.0 / static_cast<double>(plot.pairs.cols()), 1e-12);
  EXPECT_NEAR(plot.rate, 5.0 / 40.0, 0.01);
  EXPECT_EQ(plot.longest, 1000 - 38);
}

// In dimension 1 recurrences of independent samples are independent from one point of a diagonal to the next: one is
// on a line of two or more unless both neighbours miss, 1 − (1 − rate)². The share scatters by 0.0017 over seeds
// (measured over 20); four of it are allowed.
TEST(Recurrence, OfIndependentSamplesLinesUpByChanceOnly) {
  const Recurrence plot =
      recurrence(fixtures::white_noise(2000, 5), {.embedding = {.dimension = 1}, .rate = 0.05, .window = 1});
  EXPECT_NEAR(plot.rate, 0.05, 1e-4);
  EXPECT_NEAR(plot.determinism, 1.0 - std::pow(1.0 - plot.rate, 2), 0.0068);
}

TEST(Recurrence, RefusesWhatMakesNoPlot) {
  const auto series = fixtures::sine(500, 0.1);
  EXPECT_THROW((void)recurrence(series, {.rate = 0.0}), InvalidInput);
  EXPECT_THROW((void)recurrence(series, {.shortest = 1}), InvalidInput);
  EXPECT_THROW((void)recurrence(series, {.stride = 10}), InvalidInput);
}

// Lorenz: largest exponent 0.9056, correlation dimension 2.06 (accepted values; tolerances of the tools' own tests).
TEST(StudySeries, OfLorenzAgreesWithTheAcceptedValues) {
  const SeriesStudy study = study_series(fixtures::lorenz(12000, 0.05));
  EXPECT_TRUE(study.failures.empty());
  ASSERT_TRUE(study.verdict && study.divergence && study.wolf && study.kantz && study.correlation && study.section &&
              study.recurrence && study.surrogates && study.spectrum && study.cao && study.autocorrelation);
  EXPECT_EQ(study.verdict->motion, SeriesMotion::kChaotic) << study.verdict->reason;
  EXPECT_NEAR(study.divergence->exponent, 0.9056, 0.15);
  EXPECT_NEAR(study.correlation->dimension, 2.06, 0.15);
  EXPECT_GE(study.dimension.value, 3);
  EXPECT_LE(study.delay.lowest, study.delay.samples);
  EXPECT_GE(study.delay.highest, study.delay.samples);
  // Four times what lines up by chance, 1 − 0.95².
  EXPECT_GT(study.recurrence->determinism, 0.4);
  EXPECT_EQ(study.wolf->others.size(), 2U);
  EXPECT_GE(study.wolf->error, study.wolf->chosen.error);
}

TEST(StudySeries, LeavesExponentsOfAPeriodicRecordOutAndSaysSo) {
  const SeriesStudy study = study_series(fixtures::sine(3000, 0.1));
  EXPECT_EQ(study.verdict->motion, SeriesMotion::kPeriodic);
  EXPECT_FALSE(study.wolf || study.divergence || study.kantz || study.jacobians || study.correlation);
  EXPECT_EQ(study.failures.size(), 6U);
  EXPECT_NEAR(study.peak, 1.0 / (2.0 * std::numbers::pi), study.peak_error);
  EXPECT_NEAR(study.section->mean_return, 2.0 * std::numbers::pi, 1e-8);
}

TEST(StudySeries, UsesWhatWasGivenAndRunsWhatWasNamed) {
  const SeriesStudy study = study_series(fixtures::roessler(3000, 0.3),
                                         {.tools = {SeriesTool::kWolf}, .delay = 4, .dimension = 4, .window = 25});
  ASSERT_TRUE(study.wolf);
  EXPECT_EQ(study.wolf->chosen.settings.embedding.dimension, 4);
  EXPECT_EQ(study.wolf->chosen.settings.embedding.lag, 4);
  EXPECT_EQ(study.wolf->chosen.settings.window, 25);
  EXPECT_EQ(study.delay.origin, "given");
  EXPECT_FALSE(study.verdict || study.false_neighbours || study.recurrence);
  EXPECT_TRUE(study.information.empty());
}

TEST(StudySeries, OfARecordTooShortSaysTheLeastThatWouldDo) {
  try {
    (void)study_series(fixtures::lorenz(400, 0.05), {.delay = 20, .dimension = 16});
    FAIL() << "expected a refusal";
  } catch (const InvalidInput& refusal) {
    // Span 15·20, twice the window of a twentieth of the record, and a hundred.
    EXPECT_NE(std::string(refusal.what()).find("at least 440 samples, found 400"), std::string::npos) << refusal.what();
  }
  EXPECT_THROW((void)study_series(fixtures::lorenz(60, 0.05)), InvalidInput);
  // What a short record does allow is given.
  const SeriesStudy shorter = study_series(fixtures::lorenz(700, 0.05));
  EXPECT_FALSE(shorter.verdict);
  EXPECT_TRUE(shorter.false_neighbours && shorter.wolf && shorter.recurrence);
}

TEST(StudySeries, IsTheSameForAnyNumberOfThreads) {
  StudyOptions options{.tools = {SeriesTool::kFalseNeighbours, SeriesTool::kDivergence, SeriesTool::kDimension},
                       .references = 1000};
  options.run.threads = 1;
  const SeriesStudy one = study_series(fixtures::roessler(3000, 0.3), options);
  options.run.threads = 3;
  const SeriesStudy three = study_series(fixtures::roessler(3000, 0.3), options);
  EXPECT_EQ(one.false_neighbours->share, three.false_neighbours->share);
  EXPECT_EQ(one.divergence->exponent, three.divergence->exponent);
  EXPECT_EQ(one.correlation->C, three.correlation->C);
}

}  // namespace
}  // namespace slipmode::diagnostics
