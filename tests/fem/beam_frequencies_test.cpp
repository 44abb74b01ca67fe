#include <slipmode/fem/beam_modes.hpp>
#include "fem/arpack_modes.hpp"
#include "fixtures/cantilever_beam.hpp"
#include "fixtures/cantilever_transfer.hpp"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

namespace slipmode::fem {
namespace {

using fixtures::analytic;
using fixtures::source_beam;
using fixtures::stocky_beam;

Eigen::VectorXd frequencies_hz(const BeamOptions& options, Eigen::Index count,
                               EigenMethod method = EigenMethod::kAutomatic) {
  return natural_modes(Beam(options).structure(), count, method).omega / (2.0 * std::numbers::pi);
}

void expect_relative(const Eigen::VectorXd& found, const std::vector<double>& expected, double tolerance) {
  ASSERT_EQ(static_cast<std::size_t>(found.size()), expected.size());
  for (Eigen::Index i = 0; i < found.size(); ++i) {
    const double value = expected[static_cast<std::size_t>(i)];
    EXPECT_NEAR(found(i), value, tolerance * value) << "mode " << i + 1;
  }
}

double relative_error(const BeamOptions& options, Eigen::Index mode, double expected) {
  return frequencies_hz(options, mode)(mode - 1) / expected - 1.0;
}

TEST(CantileverFixture, AgreesWithPublishedRootsAndWithTransferMatrices) {
  // β L of the clamped-free beam: Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1
  const fixtures::Cantilever unit{1.0L, 1.0L, 1.0L};
  const double roots[] = {1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839};
  const auto hz = unit.frequencies_hz(5);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(std::sqrt(2.0 * std::numbers::pi * hz[i]), roots[i], 1e-8);
  }
  // both theories, a tip body with every term
  BeamOptions options = stocky_beam(1);
  options.tip = {.mass = 3.0, .inertia = 0.01, .offset = 0.04};
  for (const bool full : {false, true}) {
    const auto beam = analytic(options.spans[0], options.tip, full, full);
    const auto direct = beam.frequencies_hz(4);
    const auto transferred = fixtures::SteppedCantilever{{beam}}.frequencies_hz(4, 20.0);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(direct[i], transferred[i], 1e-11 * direct[i]);
  }
}

TEST(BeamFrequencies, OfTheSourcesBeamAreItsTranscendentalOnes) {
  // from an earlier independent solution of the transcendental equations, to its printed digits
  const double with_tip[] = {2.1009, 17.3296, 52.8822, 108.390, 184.017, 279.779};
  const double without[] = {3.58989, 22.4974, 62.9935, 123.442, 204.059, 304.828};
  const double last_digit[] = {1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3};
  for (const bool tip : {true, false}) {
    const BeamOptions options = source_beam(160, tip ? 0.0155147 : 0.0);
    const auto exact = analytic(options.spans[0], options.tip, false, false).frequencies_hz(6);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(exact[i], tip ? with_tip[i] : without[i], 0.51 * last_digit[i]);
    }
    expect_relative(frequencies_hz(options, 6), exact, 1e-7);
  }
}

TEST(BeamFrequencies, ConvergeWithTheFourthPowerOfTheElementLength) {
  const BeamOptions coarse = source_beam(10);
  const auto exact = analytic(coarse.spans[0], coarse.tip, false, false).frequencies_hz(6);
  for (const Eigen::Index mode : {3, 6}) {
    const double f = exact[static_cast<std::size_t>(mode - 1)];
    const double at_20 = relative_error(source_beam(20), mode, f);
    const double at_40 = relative_error(source_beam(40), mode, f);
    const double at_80 = relative_error(source_beam(80), mode, f);
    EXPECT_GT(at_80, 0.0);  // consistent mass: from above
    EXPECT_NEAR(std::log2(at_20 / at_40), 4.0, 0.05);
    EXPECT_NEAR(std::log2(at_40 / at_80), 4.0, 0.05);
    // leading term of the Hermite element's dispersion, (βh)⁴/1440 in the frequency
    const double beta_h = std::sqrt(2.0 * std::numbers::pi * f) *
                          std::pow(static_cast<double>(analytic(coarse.spans[0], coarse.tip, false, false).mass /
                                                       analytic(coarse.spans[0], coarse.tip, false, false).bending),
                                   0.25) *
                          0.01;
    EXPECT_NEAR(at_40, std::pow(beta_h, 4) / 1440.0, 0.1 * at_40);
  }
  EXPECT_NEAR(relative_error(source_beam(40), 6, exact[5]), 2e-5, 2e-6);
}

TEST(BeamFrequencies, CountATipBodysInertiaAndOffset) {
  BeamOptions options = source_beam(160);
  options.tip.inertia = 2e-5;
  options.tip.offset = 0.03;
  expect_relative(frequencies_hz(options, 6), analytic(options.spans[0], options.tip, false, false).frequencies_hz(6),
                  1e-7);
  options.tip.offset = -0.03;  // inward
  expect_relative(frequencies_hz(options, 6), analytic(options.spans[0], options.tip, false, false).frequencies_hz(6),
                  1e-7);
}

TEST(BeamFrequencies, OfTimoshenkoAreThoseOfItsOwnEquation) {
  const auto check = [](const BeamOptions& options, int count, double tolerance) {
    expect_relative(frequencies_hz(options, count),
                    analytic(options.spans[0], options.tip, true, true).frequencies_hz(count), tolerance);
  };
  BeamOptions thin = source_beam(160);
  thin.theory = BeamTheory::kTimoshenko;
  check(thin, 6, 1e-6);
  BeamOptions stocky = stocky_beam(160);
  check(stocky, 5, 2e-4);
  stocky.tip = {.mass = 4.0, .inertia = 0.02, .offset = 0.05};
  check(stocky, 4, 2e-4);
}

TEST(BeamFrequencies, OfTimoshenkoConvergeWithTheSquareOfTheElementLength) {
  // The shear force varies within an element by ρAω²y h, the shear angle does not: an error of second order in h, of
  // about ρω²/(κG) h²/24, which vanishes for thin beams (docs/theory/beam.md).
  const auto exact = analytic(stocky_beam(1).spans[0], stocky_beam(1).tip, true, true).frequencies_hz(4);
  for (const Eigen::Index mode : {1, 2, 4}) {
    const double f = exact[static_cast<std::size_t>(mode - 1)];
    const double at_40 = relative_error(stocky_beam(40), mode, f);
    const double at_80 = relative_error(stocky_beam(80), mode, f);
    const double at_160 = relative_error(stocky_beam(160), mode, f);
    EXPECT_NEAR(std::log2(at_40 / at_80), 2.0, 0.03);
    EXPECT_NEAR(std::log2(at_80 / at_160), 2.0, 0.03);
  }
}

TEST(BeamFrequencies, OfTimoshenkoTendToEulerBernoulliWithTheSquareOfTheThickness) {
  // Shear and rotary inertia enter by h²/L² at fixed mode; the frequency itself is removed by the ratio.
  const auto change = [](double thickness) {
    BeamOptions options = source_beam(40, 0.0);
    options.spans[0].thickness = thickness;
    return theory_effects(options, 3)[2];
  };
  const TheoryEffect thick = change(0.004), thin = change(0.002);
  EXPECT_NEAR(std::log2(thick.shear_change / thin.shear_change), 2.0, 0.01);
  EXPECT_NEAR(std::log2(thick.rotary_change / thin.rotary_change), 2.0, 0.01);
  EXPECT_NEAR(std::log2(thick.timoshenko_change / thin.timoshenko_change), 2.0, 0.01);
}

TEST(BeamFrequencies, ShearAloneVanishesWithTheFirstPowerOfItsStiffness) {
  const auto change = [](double coefficient) {
    BeamOptions options = stocky_beam(20);
    options.spans[0].shear_coefficient = coefficient;
    return theory_effects(options, 2)[1].shear_change;
  };
  EXPECT_NEAR(change(1e3) / change(1e4), 10.0, 0.01);
  EXPECT_NEAR(change(1e4) / change(1e5), 10.0, 0.001);
}

TEST(TheoryEffects, AreThoseOfTheCharacteristicEquations) {
  BeamOptions options = stocky_beam(200);
  options.tip = {.mass = 2.0, .inertia = 0.004, .offset = 0.02};
  const auto effects = theory_effects(options, 3);
  const auto exact = [&](bool shear, bool rotary) {
    return analytic(options.spans[0], options.tip, shear, rotary).frequencies_hz(3);
  };
  const auto neither = exact(false, false), shear = exact(true, false), rotary = exact(false, true),
             both = exact(true, true);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(effects[i].euler_bernoulli_hz, neither[i], 1e-7 * neither[i]);
    EXPECT_NEAR(effects[i].shear_hz, shear[i], 3e-5 * shear[i]);
    EXPECT_NEAR(effects[i].rotary_hz, rotary[i], 3e-5 * rotary[i]);
    EXPECT_NEAR(effects[i].timoshenko_hz, both[i], 3e-5 * both[i]);
    EXPECT_NEAR(effects[i].shear_change, shear[i] / neither[i] - 1.0, 3e-5);
    EXPECT_NEAR(effects[i].rotary_change, rotary[i] / neither[i] - 1.0, 3e-5);
    EXPECT_NEAR(effects[i].timoshenko_change, both[i] / neither[i] - 1.0, 3e-5);
    EXPECT_LT(effects[i].timoshenko_change, effects[i].shear_change);
    EXPECT_LT(effects[i].shear_change, effects[i].rotary_change);
    EXPECT_LT(effects[i].rotary_change, 0.0);
  }
}

TEST(BeamFrequencies, DoNotDependOnHowOneSpanIsSplit) {
  const BeamOptions whole = source_beam(40);
  BeamOptions split = whole;
  split.spans.assign(2, whole.spans[0]);
  split.spans[0].length = 0.1;
  split.spans[0].elements = 10;
  split.spans[1].length = 0.3;
  split.spans[1].elements = 30;
  const Eigen::VectorXd one = frequencies_hz(whole, 6), two = frequencies_hz(split, 6);
  EXPECT_LT((one.array() / two.array() - 1.0).abs().maxCoeff(), 1e-9);
}

TEST(BeamFrequencies, OfASteppedBeamAreThoseOfTransferMatrices) {
  BeamOptions options = source_beam(80);
  options.spans.push_back({.length = 0.15,
                           .width = 0.02,
                           .thickness = 0.0005,
                           .youngs_modulus = 70e9,
                           .density = 2700.0,
                           .elements = 60,
                           .poisson_ratio = 0.33});
  options.tip.offset = 0.01;
  options.tip.inertia = 1e-6;
  for (const BeamTheory theory : {BeamTheory::kEulerBernoulli, BeamTheory::kTimoshenko}) {
    options.theory = theory;
    const bool full = theory == BeamTheory::kTimoshenko;
    const fixtures::SteppedCantilever exact{
        {analytic(options.spans[0], {}, full, full), analytic(options.spans[1], options.tip, full, full)}};
    expect_relative(frequencies_hz(options, 5), exact.frequencies_hz(5, 0.1), 1e-6);
  }
}

TEST(BeamFrequencies, FromLanczosOfBothLibrariesAndFromDenseFactorsAgree) {
  const BeamOptions options = source_beam(40);
  const Eigen::VectorXd dense = frequencies_hz(options, 10, EigenMethod::kDense);
  const Eigen::VectorXd spectra = frequencies_hz(options, 10, EigenMethod::kSpectra);
  const Eigen::VectorXd arpack = arpack_modes(Beam(options).structure(), 10).omega / (2.0 * std::numbers::pi);
  for (const Eigen::VectorXd& lanczos : {spectra, arpack}) {
    EXPECT_LT((lanczos.array() / dense.array() - 1.0).abs().maxCoeff(), 2e-9);
  }
  const Beam beam(options);
  const Structure& structure = beam.structure();
  const Modes a = natural_modes(structure, 10, EigenMethod::kDense);
  const Modes b = natural_modes(structure, 10, EigenMethod::kSpectra);
  EXPECT_LT((a.shapes - b.shapes).cwiseAbs().maxCoeff() / a.shapes.cwiseAbs().maxCoeff(), 1e-8);
}

TEST(BeamFrequencies, OfTwoToTwoThousandElementsKeepTheDigitsDocumented) {
  const BeamOptions options = source_beam(2);
  const auto exact = analytic(options.spans[0], options.tip, false, false).frequencies_hz(3);
  EXPECT_NEAR(relative_error(options, 1, exact[0]), 5.5e-5, 5e-6);  // discretisation: Ritz from above
  // Rounding of K grows like the element number's fourth power at worst; table in docs/theory/beam.md.
  EXPECT_NEAR(relative_error(source_beam(300), 1, exact[0]), 0.0, 1e-6);
  EXPECT_NEAR(relative_error(source_beam(1000), 1, exact[0]), 0.0, 1e-5);
  EXPECT_NEAR(relative_error(source_beam(2000), 1, exact[0]), 0.0, 1e-4);
  EXPECT_NEAR(relative_error(source_beam(2000), 3, exact[2]), 0.0, 1e-6);
}

}  // namespace
}  // namespace slipmode::fem
