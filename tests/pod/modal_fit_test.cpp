#include <slipmode/core/decompositions.hpp>
#include <slipmode/pod/modal_fit.hpp>

#include <slipmode/core/errors.hpp>
#include "cantilever.hpp"
#include "known.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::pod {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using tests::gauges;
using tests::kGauges;
using tests::places;

const fem::Beam& beam() {
  static const fem::Beam shared(tests::with_tip_body(40));
  return shared;
}

TEST(ModalFit, StrainsGiveDisplacementsOfMotionWithinItsSpan) {
  Random random(5);
  for (const Eigen::Index k : {6, 4, 1}) {  // interpolation and least squares
    const ModalFunctions functions = natural_functions(beam(), k);
    const Eigen::MatrixXd q = functions.shapes * tests::normal_matrix(random, k, 9);
    const ModalFit fit(gauges(beam()), functions);
    const Ensemble strains{gauges(beam()).readings(q), {0, 4}};
    for (const SensorArray& at : {places(beam()), SensorArray(beam(), evenly_spaced(41, 0.464))}) {
      const Eigen::MatrixXd expected = at.readings(q);
      const Ensemble found = converted(strains, fit, at);
      EXPECT_LT((found.snapshots - expected).norm(), 1e-10 * expected.norm()) << k;
      EXPECT_LT((fit.transfer(at) * strains.snapshots - expected).norm(), 1e-10 * expected.norm()) << k;
      EXPECT_EQ(found.run_begin, strains.run_begin);
    }
    EXPECT_LT((fit.motion(strains.snapshots) - q).norm(), 1e-10 * q.norm());
  }
}

/// φ″L²  of a clamped-free beam without tip body at s = x/L, ∫φ² dx = L, φ(L) > 0. β L are the roots of
/// cos z cosh z = −1: Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1.
double curvature_of_mode(int mode, double s) {
  const double z = mode == 1 ? 1.875104068711961 : 4.694091132974175;
  const double sigma = (std::sinh(z) - std::sin(z)) / (std::cosh(z) + std::cos(z));
  const double sign = mode == 1 ? 1.0 : -1.0;
  return sign * z * z * (std::cosh(z * s) + std::cos(z * s) - sigma * (std::sinh(z * s) + std::sin(z * s)));
}

/// Amplitude that the first mode gets when the second moves and one gauge at x is read; both with φ(L) > 0.
double aliased_amplitude(double x, int elements) {
  const fem::Beam bare(tests::without_tip_body(elements));
  ModalFunctions two = natural_functions(bare, 2);
  const Eigen::VectorXd tip = bare.displacement_row(0.4);
  for (Eigen::Index j = 0; j < 2; ++j) two.shapes.col(j) *= tip.dot(two.shapes.col(j)) > 0.0 ? 1.0 : -1.0;
  const SensorArray gauge(bare, {{SensorKind::kStrain, x}});
  return ModalFit(gauge, {two.shapes.leftCols(1), "first mode"}).amplitudes(gauge.readings(two.shapes.col(1)))(0, 0);
}

TEST(ModalFit, AliasesModeTwoIntoModeOneByTheRatioOfCurvatures) {
  // Motion φ2 reads as φ1 with amplitude φ2″(x)/φ1″(x). The curvature of cubic elements of length h errs at a node by
  // h² y⁗/12 + O(h⁴); gauges stand on nodes, so two meshes extrapolate to O(h⁴), here below (β2 h)⁴/4 = 3e-6.
  for (const double x : kGauges) {
    const double expected = curvature_of_mode(2, x / 0.4) / curvature_of_mode(1, x / 0.4);
    const double coarse = aliased_amplitude(x, 80);
    const double fine = aliased_amplitude(x, 160);
    EXPECT_NEAR((4.0 * fine - coarse) / 3.0, expected, 3e-6) << x;
    EXPECT_NEAR((coarse - expected) / (fine - expected), 4.0, 0.1) << x;
  }
}

TEST(ModalFit, AliasesHigherModesToTheLeastSquaresSolution) {
  // Normal equations, solved in a way of their own: Fᵀ(s − F a) = 0.
  const SensorArray sensors = gauges(beam());
  const ModalFunctions eight = natural_functions(beam(), 8);
  for (const Eigen::Index k : {6, 3}) {
    const ModalFunctions functions{eight.shapes.leftCols(k), "natural modes"};
    const Eigen::MatrixXd F = sensors.readings(functions.shapes);
    const Eigen::MatrixXd outside = sensors.readings(eight.shapes.rightCols(2));
    const Eigen::MatrixXd a = ModalFit(sensors, functions).amplitudes(outside);
    const Eigen::MatrixXd expected = (F.transpose() * F).ldlt().solve(F.transpose() * outside);
    EXPECT_LT((a - expected).norm(), 1e-9 * expected.norm());
    EXPECT_GT(a.norm(), 0.1);  // aliasing is not small: that is the point
  }
}

TEST(ModalFit, PolynomialsFitPolynomialShapesExactly) {
  const SensorArray sensors(beam(), evenly_spaced(6, 0.4));
  const SensorArray nodes(beam(), evenly_spaced(40, 0.4));
  const ModalFit fit(sensors, polynomial_functions(beam(), 5));
  const std::vector<std::vector<double>> shapes = {
      {0.0, 0.0, 2.0, -1.0}, {0.0, 0.0, 0.0, 0.0, 1.0, -0.5}, {0.0, 0.0, 1.0, -3.0, 2.0, 0.5, -0.7}};
  for (const auto& c : shapes) {
    const Eigen::VectorXd found = nodes.readings(fit.motion(sensors.readings(tests::polynomial(beam(), c))));
    for (Eigen::Index i = 0; i < 40; ++i) {
      const double s = static_cast<double>(i + 1) / 40.0;
      double expected = 0.0;
      for (std::size_t p = 0; p < c.size(); ++p) expected += c[p] * std::pow(s, static_cast<double>(p));
      EXPECT_NEAR(found[i], expected, 1e-11);
    }
  }
}

TEST(ModalFit, PolynomialsHoldTheClampWhateverIsRead) {
  // y(x)/x → 0 as x → 0: at 1e-6 of the length the slope is of the order of 1e-6 of the motion's.
  const SensorArray sensors(beam(), evenly_spaced(4, 0.4));
  const Eigen::VectorXd q =
      ModalFit(sensors, polynomial_functions(beam(), 4)).motion(Eigen::Vector4d(1.0, 1.0, 1.0, 1.0));
  EXPECT_LT(std::abs(beam().slope_row(4e-7).dot(q)), 1e-4 * q.lpNorm<Eigen::Infinity>());
}

TEST(ModalFit, TakesSensorsOfBothKinds) {
  Random random(6);
  std::vector<Sensor> both = sensors_at(SensorKind::kStrain, std::span(kGauges).first(3));
  both.push_back({SensorKind::kDisplacement, 0.4});
  both.push_back({SensorKind::kDisplacement, 0.2});
  const SensorArray sensors(beam(), both);
  const ModalFunctions functions = natural_functions(beam(), 4);
  const ModalFit fit(sensors, functions);
  const Eigen::MatrixXd a = tests::normal_matrix(random, 4, 3);
  EXPECT_LT((fit.amplitudes(sensors.readings(functions.shapes * a)) - a).norm(), 1e-10 * a.norm());
  EXPECT_LT(fit.condition(), 1e3);  // strains are 1e-3 of displacements: unscaled it is beyond that
}

TEST(ModalFit, ConditionBoundsWhatNoiseDoes) {
  // |δa|/|a| ≤ condition · |δs|/|s| for scaled amplitudes; equality is reached for the worst noise, so a bad placement
  // must show a larger figure: all gauges within 5 mm against S4's.
  const std::vector<double> close = {0.050, 0.051, 0.052, 0.053, 0.054, 0.055};
  const SensorArray bunched(beam(), sensors_at(SensorKind::kStrain, close));
  const double good = ModalFit(gauges(beam()), natural_functions(beam(), 3)).condition();
  const double bad = ModalFit(bunched, natural_functions(beam(), 3)).condition();
  EXPECT_LT(good, 5.0);
  EXPECT_GT(bad, 1e3 * good);
}

TEST(ModalFit, ConditionIsThatOfTheScaledNormalEquations) {
  // κ² is the ratio of the eigenvalues of DFᵀFD, D scaling its diagonal to 1; the figures are those of
  // docs/theory/modal-functions.md, section 2.
  fem::BeamOptions options = tests::without_tip_body(80);
  options.tip = {.mass = 0.0155147, .extension = 0.064};
  const fem::Beam source(options);
  const ModalFunctions six = natural_functions(source, 6);
  for (const auto& [sensors, documented] : {std::pair{gauges(source), 4.82}, std::pair{places(source), 408.0}}) {
    const Eigen::MatrixXd F = sensors.readings(six.shapes);
    const Eigen::MatrixXd normal = F.colwise().normalized().transpose() * F.colwise().normalized();
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal).eigenvalues();
    const double condition = ModalFit(sensors, six).condition();
    EXPECT_NEAR(condition / std::sqrt(values[5] / values[0]), 1.0, 1e-8);
    EXPECT_NEAR(condition / documented, 1.0, 2e-3);
  }
}

TEST(ModalFit, RefusesWhatSensorsCannotTellApart) {
  const SensorArray six = gauges(beam());
  EXPECT_THAT([&] { (void)ModalFit(six, natural_functions(beam(), 7)); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("more modal functions than 6 sensors can tell apart"),
                                                HasSubstr("7 natural modes"))));
  ModalFunctions twice = natural_functions(beam(), 3);
  twice.shapes.col(2) = 2.0 * twice.shapes.col(0);
  EXPECT_THAT([&] { (void)ModalFit(six, twice); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("singular fit"), HasSubstr("condition number"))));
  ModalFunctions unseen = natural_functions(beam(), 2);
  unseen.shapes.col(1).setZero();
  EXPECT_THAT([&] { (void)ModalFit(six, unseen); },
              ThrowsMessage<InvalidInput>(HasSubstr("no sensor reads anything of function 2")));
}

TEST(ModalFit, RefusesSizesThatDoNotFit) {
  const SensorArray six = gauges(beam());
  const fem::Beam other(tests::without_tip_body(10));
  EXPECT_THROW((void)ModalFit(six, natural_functions(other, 2)), InvalidInput);
  EXPECT_THROW((void)ModalFit(six, natural_functions(beam(), 2)).amplitudes(Eigen::VectorXd::Zero(5)), InvalidInput);
  EXPECT_THROW((void)natural_functions(beam(), 0), InvalidInput);
  EXPECT_THROW((void)natural_functions(beam(), 81), InvalidInput);
  EXPECT_THROW((void)polynomial_functions(beam(), 0), InvalidInput);
}

}  // namespace
}  // namespace slipmode::pod
