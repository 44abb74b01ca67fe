#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_modes.hpp>
#include "fixtures/cantilever_beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace slipmode::fem {
namespace {

using fixtures::source_beam;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Eigen::VectorXd modal_ratios(const Structure& structure, const Modes& modes) {
  const Eigen::MatrixXd D = modes.shapes.transpose() * multiply(structure.C(), modes.shapes);
  return D.diagonal().cwiseQuotient(2.0 * modes.omega);
}

TEST(BeamDamping, WithOneRatioIsProportionalToStiffness) {
  BeamOptions options = source_beam(10);
  options.damping = ProportionalRatios{{{.ratio = 0.01, .frequency_hz = 17.0}}};
  const Beam beam(options);
  ASSERT_TRUE(beam.structure().rayleigh().has_value());
  EXPECT_EQ(beam.structure().rayleigh()->mass, 0.0);
  // ζ = bω/2 = 0.01 f/17
  const Modes modes = natural_modes(beam.structure(), 4);
  const Eigen::VectorXd ratios = modal_ratios(beam.structure(), modes);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double hz = modes.omega(i) / (2.0 * std::numbers::pi);
    EXPECT_NEAR(ratios(i), 0.01 * hz / 17.0, 1e-10);
  }
}

TEST(BeamDamping, WithTwoRatiosMeetsBoth) {
  BeamOptions options = source_beam(10);
  const Eigen::VectorXd hz = natural_modes(Beam(options).structure(), 4).omega / (2.0 * std::numbers::pi);
  options.damping =
      ProportionalRatios{{{.ratio = 0.01, .frequency_hz = hz(1)}, {.ratio = 0.015, .frequency_hz = hz(3)}}};
  const Beam beam(options);
  const Eigen::VectorXd ratios = modal_ratios(beam.structure(), natural_modes(beam.structure(), 4));
  EXPECT_NEAR(ratios(1), 0.01, 1e-10);
  EXPECT_NEAR(ratios(3), 0.015, 1e-10);
}

TEST(BeamDamping, ByModesGivesEachModeItsRatioAndCouplesNone) {
  for (const int elements : {2, 40, 100}) {
    for (const BeamTheory theory : {BeamTheory::kEulerBernoulli, BeamTheory::kTimoshenko}) {
      BeamOptions options = source_beam(elements);
      options.theory = theory;
      options.damping = ModalRatios{{0.01, 0.03, 0.005}};
      const Beam beam(options);
      const Modes modes = natural_modes(beam.structure());
      const Eigen::MatrixXd D = modes.shapes.transpose() * multiply(beam.structure().C(), modes.shapes);
      const Eigen::VectorXd ratios = modal_ratios(beam.structure(), modes);
      EXPECT_NEAR(ratios(0), 0.01, 1e-9 * 0.01);
      EXPECT_NEAR(ratios(1), 0.03, 1e-9 * 0.03);
      EXPECT_LT((ratios.tail(2 * elements - 2).array() - 0.005).abs().maxCoeff(), 1e-9 * 0.005);
      // the flow takes damping as proportional below 1e-12 of its norm
      EXPECT_LT((D - Eigen::MatrixXd(D.diagonal().asDiagonal())).norm(), 1e-13 * D.norm());
    }
  }
}

TEST(BeamDamping, ByEqualCoefficientsIsTheSameHoweverAsked) {
  BeamOptions options = source_beam(8);
  const double b = 2.0 * 0.02 / (2.0 * std::numbers::pi * 30.0);
  options.damping = Rayleigh{.mass = 0.0, .stiffness = b};
  const Beam by_coefficient(options);
  options.damping = ProportionalRatios{{{.ratio = 0.02, .frequency_hz = 30.0}}};
  const Beam by_ratio(options);
  const Eigen::MatrixXd C = to_dense(by_coefficient.structure().C());
  EXPECT_LT((C - to_dense(by_ratio.structure().C())).norm(), 1e-14 * C.norm());
}

TEST(BeamDamping, RefusesWhatWouldPumpEnergyIn) {
  const auto fails = [](const BeamDamping& damping, const char* message) {
    BeamOptions options = source_beam(10);
    options.damping = damping;
    EXPECT_THAT([&] { Beam beam(options); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  fails(ProportionalRatios{{{0.05, 10.0}, {0.001, 100.0}}}, "damps high modes negatively");
  fails(ProportionalRatios{{{0.001, 10.0}, {0.05, 20.0}}}, "damps the first mode negatively");
  fails(ProportionalRatios{{{0.01, 10.0}, {0.02, 10.0}}}, "two ratios at the same frequency, 10 Hz");
  fails(ProportionalRatios{}, "ratios at 0 frequencies; expected one (C = bK) or two");
  fails(ProportionalRatios{{{-0.01, 10.0}}}, "ratio = -0.01; expected a finite value >= 0");
  fails(ProportionalRatios{{{0.01, 0.0}}}, "frequency = 0 Hz; expected a finite value > 0");
  fails(Rayleigh{.mass = -1.0}, "mass coefficient = -1");
  fails(Rayleigh{.stiffness = kNaN}, "stiffness coefficient = nan");
  fails(ModalRatios{}, "no modal ratios");
  fails(ModalRatios{{0.01, -0.02}}, "modal ratio = -0.02");
}

TEST(BeamDamping, AllowsANegativeMassCoefficientThatLeavesEveryModeDamped) {
  // Ratios rising a little faster than frequency from mode 1 (2.1 Hz) on: a < 0, but a + bω₁² > 0.
  BeamOptions options = source_beam(10);
  options.damping = ProportionalRatios{{{0.001, 2.2}, {0.0101, 22.0}}};
  const Beam beam(options);
  ASSERT_TRUE(beam.structure().rayleigh().has_value());
  EXPECT_LT(beam.structure().rayleigh()->mass, 0.0);
  EXPECT_GT(modal_ratios(beam.structure(), natural_modes(beam.structure())).minCoeff(), 0.0);
}

TEST(BeamOptions, AreCheckedWithTheValueNamed) {
  const auto fails = [](const std::function<void(BeamOptions&)>& spoil, const char* message) {
    BeamOptions options = source_beam(4);
    options.theory = BeamTheory::kTimoshenko;
    spoil(options);
    EXPECT_THAT([&] { Beam beam(options); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  fails([](auto& o) { o.spans.clear(); }, "no spans; expected at least one");
  fails([](auto& o) { o.spans[0].length = 0.0; }, "span 1: length = 0; expected a finite value > 0 m");
  fails([](auto& o) { o.spans[0].length = kNaN; }, "span 1: length = nan");
  fails([](auto& o) { o.spans[0].width = -1.0; }, "span 1: width = -1");
  fails(
      [](auto& o) {
        o.spans.push_back(o.spans[0]);
        o.spans[1].thickness = -0.001;
      },
      "span 2: thickness = -0.001");
  fails([](auto& o) { o.spans[0].youngs_modulus = 0.0; }, "youngs_modulus = 0; expected a finite value > 0 Pa");
  fails([](auto& o) { o.spans[0].density = 0.0; }, "density = 0");
  fails([](auto& o) { o.spans[0].elements = 0; }, "span 1: elements = 0; expected at least 1");
  fails([](auto& o) { o.spans[0].poisson_ratio = 0.6; }, "poisson_ratio = 0.6; expected -1 < ratio <= 0.5");
  fails([](auto& o) { o.spans[0].shear_coefficient = 0.0; }, "shear_coefficient = 0");
  fails([](auto& o) { o.tip.mass = -1.0; }, "tip: mass = -1; expected a finite value >= 0 kg");
  fails([](auto& o) { o.tip.inertia = -1.0; }, "tip: inertia = -1");
  fails([](auto& o) { o.tip.offset = kNaN; }, "tip: offset = nan");
  fails([](auto& o) { o.tip.extension = -0.1; }, "tip: extension = -0.1");
}

TEST(BeamOptions, OfShearAreNotLookedAtWithoutShear) {
  BeamOptions options = source_beam(4);
  options.spans[0].poisson_ratio = 7.0;
  EXPECT_NO_THROW(Beam{options});
  EXPECT_THAT([&] { (void)theory_effects(options, 2); }, ThrowsMessage<InvalidInput>(HasSubstr("poisson_ratio = 7")));
}

TEST(Beam, NamesItsDegreesOfFreedomAndNodes) {
  BeamOptions options = source_beam(2);
  options.spans.push_back(options.spans[0]);
  options.spans[1].length = 0.1;
  options.spans[1].elements = 1;
  const Beam beam(options);
  EXPECT_EQ(beam.structure().dof_names(), (std::vector<std::string>{"y1", "theta1", "y2", "theta2", "y3", "theta3"}));
  EXPECT_EQ(beam.structure().units(), "SI");
  EXPECT_THAT(beam.nodes(), testing::ElementsAre(0.0, 0.2, 0.4, 0.5));
  EXPECT_EQ(beam.length(), 0.5);
}

TEST(BeamRows, RefusePositionsOffTheBeam) {
  BeamOptions options = source_beam(4);
  options.tip.extension = 0.076;
  const Beam beam(options);
  const auto fails = [](const std::function<void()>& call, const char* message) {
    EXPECT_THAT(call, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  fails([&] { (void)beam.displacement_row(-0.01); }, "displacement at x = -0.01 m; expected 0 <= x <= 0.476 m");
  fails([&] { (void)beam.displacement_row(0.48); }, "the end of the rigid extension");
  fails([&] { (void)beam.slope_row(kNaN); }, "slope at x = nan");
  fails([&] { (void)beam.curvature_row(1.0); }, "curvature at x = 1 m");
  fails([&] { (void)beam.strain_row(0.41); }, "strain at x = 0.41 m; expected 0 <= x <= 0.4 m (the end of the beam)");
  fails([&] { (void)beam.interpolate(Eigen::VectorXd::Zero(4), Eigen::VectorXd::Zero(5)); },
        "4 values and 5 slopes; expected 5 each");
  fails([&] { (void)beam.interpolate(Eigen::VectorXd::Constant(5, kNaN), Eigen::VectorXd::Zero(5)); }, "not finite");
  EXPECT_NO_THROW((void)beam.displacement_row(0.4 + 0.076 + 1e-16));  // sums that miss the end by rounding
  const Beam other(source_beam(5));
  fails([&] { (void)beam_shapes(beam, natural_modes(other.structure(), 2), Eigen::VectorXd::Zero(1)); },
        "modes of 10 degrees of freedom on a beam of 8");
  fails([&] { (void)theory_effects(options, 0); }, "0 modes asked; expected at least 1");
  fails([&] { (void)theory_effects(options, 9); }, "9 modes asked");
}

}  // namespace
}  // namespace slipmode::fem
