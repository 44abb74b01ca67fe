#include <slipmode/fem/beam_modes.hpp>
#include "fixtures/cantilever_beam.hpp"

#include <gtest/gtest.h>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>

namespace slipmode::fem {
namespace {

using fixtures::source_beam;
using fixtures::stocky_beam;

struct Section {
  double bending, shear;
};

Section section(const BeamSpan& span) {
  const double area = span.width * span.thickness;
  return {span.youngs_modulus * area * span.thickness * span.thickness / 12.0,
          span.shear_coefficient * span.youngs_modulus / (2.0 * (1.0 + span.poisson_ratio)) * area};
}

Eigen::VectorXd solve(const Beam& beam, const Eigen::VectorXd& force) {
  return Eigen::SimplicialLDLT<SparseMatrix>(to_sparse(beam.structure().K())).solve(force);
}

TEST(BeamStatics, TipDeflectionIsExactForAnyElementNumberAndSlenderness) {
  // PL³/3EI + PL/κGA: no locking
  for (const double slenderness : {2.0, 20.0, 1e3, 1e5}) {
    for (const int elements : {1, 2, 7}) {
      BeamOptions options = stocky_beam(elements);
      options.spans[0].thickness = options.spans[0].length / slenderness;
      const Beam beam(options);
      const double L = beam.length();
      const auto [bending, shear] = section(options.spans[0]);
      const Eigen::VectorXd w = beam.displacement_row(L);
      const double expected = L * L * L / (3.0 * bending) + L / shear;
      EXPECT_NEAR(w.dot(solve(beam, w)), expected, 1e-11 * expected) << slenderness << ", " << elements;
    }
  }
}

TEST(BeamStatics, EulerBernoulliLeavesShearOut) {
  BeamOptions options = stocky_beam(3);
  options.theory = BeamTheory::kEulerBernoulli;
  const Beam beam(options);
  const Eigen::VectorXd w = beam.displacement_row(beam.length());
  const double expected = std::pow(beam.length(), 3) / (3.0 * section(options.spans[0]).bending);
  EXPECT_NEAR(w.dot(solve(beam, w)), expected, 1e-12 * expected);
}

TEST(BeamStatics, RowsGiveTheClosedFormOfAnEndLoadEverywhere) {
  // y = P (Lx²/2 − x³/6)/EI + Px/κGA, y′ = P (Lx − x²/2)/EI + P/κGA, θ′ = P (L − x)/EI
  const BeamOptions options = stocky_beam(5);
  const Beam beam(options);
  const double L = beam.length();
  const auto [bending, shear] = section(options.spans[0]);
  const Eigen::VectorXd q = solve(beam, beam.displacement_row(L));
  for (const double x : {0.0, 0.013, 0.1, 0.25, 0.3, 0.417, 0.5}) {
    const double y = L * x * x / 2.0 - x * x * x / 6.0;
    EXPECT_NEAR(beam.displacement_row(x).dot(q), y / bending + x / shear, 1e-12 * L * L * L / bending);
    EXPECT_NEAR(beam.slope_row(x).dot(q), (L * x - x * x / 2.0) / bending + 1.0 / shear, 1e-12 * L * L / bending);
    EXPECT_NEAR(beam.curvature_row(x).dot(q), (L - x) / bending, 1e-11 * L / bending);
    EXPECT_NEAR(beam.strain_row(x).dot(q), 0.05 * (L - x) / bending, 1e-11 * 0.05 * L / bending);
  }
}

TEST(BeamStatics, AForceAtTheExtensionsEndActsOnDisplacementAndRotation) {
  // P at L + ℓ: force P and moment Pℓ at the tip. Deflection under it, P (L³/3 + L²ℓ + Lℓ²)/EI, is the work's check.
  BeamOptions options = source_beam(4);
  options.tip.extension = 0.076;
  const Beam beam(options);
  const double L = beam.length(), l = options.tip.extension, bending = section(options.spans[0]).bending;
  EXPECT_DOUBLE_EQ(beam.reach(), 0.476);
  const Eigen::VectorXd w = beam.displacement_row(beam.reach());
  const Eigen::VectorXd q = solve(beam, w);
  const double deflection = (L * L * L / 3.0 + L * L * l + L * l * l) / bending;
  EXPECT_NEAR(w.dot(q), deflection, 1e-12 * deflection);
  const double rotation = (L * L / 2.0 + L * l) / bending;
  EXPECT_NEAR(beam.slope_row(0.45).dot(q), rotation, 1e-12 * rotation);
  EXPECT_NEAR(beam.slope_row(L).dot(q), rotation, 1e-12 * rotation);
  EXPECT_EQ(beam.curvature_row(0.45).norm(), 0.0);
  EXPECT_NEAR(beam.displacement_row(0.43).dot(q), beam.displacement_row(L).dot(q) + 0.03 * beam.slope_row(L).dot(q),
              1e-12 * deflection);
}

TEST(BeamRows, AtASteppedNodeAreTheMeanOfBothSides) {
  BeamOptions options = source_beam(4);
  options.spans.push_back(options.spans[0]);
  options.spans[1].thickness *= 2.0;  // eight times as stiff
  const Beam beam(options);
  const Eigen::VectorXd q = solve(beam, beam.displacement_row(beam.length()));
  const double moment = 0.4, left = moment / section(options.spans[0]).bending;  // P = 1, 0.4 m from its load
  EXPECT_NEAR(beam.curvature_row(0.4).dot(q), (left + left / 8.0) / 2.0, 1e-10 * left);
  EXPECT_NEAR(beam.strain_row(0.4).dot(q), 0.00043 * (left + left / 4.0) / 2.0, 1e-10 * 0.00043 * left);
  EXPECT_NEAR(beam.curvature_row(0.4 - 1e-6).dot(q), left, 1e-5 * left);
  EXPECT_NEAR(beam.curvature_row(0.4 + 1e-6).dot(q), left / 8.0, 1e-5 * left);
}

TEST(BeamRows, ReproduceAnInterpolatedCubicExactly) {
  const Beam beam(source_beam(7));
  const auto count = static_cast<Eigen::Index>(beam.nodes().size());
  ASSERT_EQ(count, 8);
  const Eigen::Map<const Eigen::VectorXd> x(beam.nodes().data(), count);
  const Eigen::VectorXd q =
      beam.interpolate(x.array().square() * (3.0 - x.array()), 6.0 * x.array() - 3.0 * x.array().square());
  for (const double at : {0.0, 0.033, 0.2, 0.31, 0.4}) {
    EXPECT_NEAR(beam.displacement_row(at).dot(q), at * at * (3.0 - at), 1e-15);
    EXPECT_NEAR(beam.slope_row(at).dot(q), 6.0 * at - 3.0 * at * at, 1e-13);
    EXPECT_NEAR(beam.curvature_row(at).dot(q), 6.0 - 6.0 * at, 1e-11);
  }
}

TEST(BeamMass, OfTheTipBodyIsThatOfARigidBody) {
  // The mass matrices with and without the body differ by the body's kinetic energy, here for translation and for
  // rotation about x = 0.
  BeamOptions with = source_beam(6, 0.5), without = source_beam(6, 0.0);
  with.tip.inertia = 0.003;
  with.tip.offset = 0.07;
  const Beam a(with), b(without);
  const Eigen::MatrixXd difference = to_dense(a.structure().M()) - to_dense(b.structure().M());
  const auto n = difference.rows();
  Eigen::VectorXd translation = Eigen::VectorXd::Zero(n), rotation = translation;
  for (Eigen::Index node = 1; node < static_cast<Eigen::Index>(a.nodes().size()); ++node) {
    translation(2 * node - 2) = 1.0;
    rotation(2 * node - 2) = a.nodes()[static_cast<std::size_t>(node)];
    rotation(2 * node - 1) = 1.0;
  }
  const double arm = 0.4 + 0.07;
  EXPECT_NEAR(translation.dot(difference * translation), 0.5, 1e-15);
  EXPECT_NEAR(translation.dot(difference * rotation), 0.5 * arm, 1e-15);
  EXPECT_NEAR(rotation.dot(difference * rotation), 0.003 + 0.5 * arm * arm, 1e-15);
}

TEST(BeamMass, OfOneElementIsThatOfARigidBarWhenItMovesAsOne) {
  // translation, translation-rotation and rotation about the left end: ρAl, ρAl²/2, ρAl³/3 + ρIl
  for (const bool rotary : {false, true}) {
    const detail::BeamElement element{.length = 0.3,
                                      .bending = 5.0,
                                      .mass = 2.0,
                                      .half_thickness = 0.01,
                                      .shear = 400.0,
                                      .rotary = rotary ? 0.04 : 0.0};
    const Eigen::Matrix4d M = detail::element_mass(element);
    const Eigen::Vector4d translation(1.0, 0.0, 1.0, 0.0), rotation(0.0, 1.0, 0.3, 1.0);
    EXPECT_NEAR(translation.dot(M * translation), 0.6, 1e-14);
    EXPECT_NEAR(translation.dot(M * rotation), 0.09, 1e-14);
    EXPECT_NEAR(rotation.dot(M * rotation), 0.018 + (rotary ? 0.012 : 0.0), 1e-14);
    const Eigen::Matrix4d K = detail::element_stiffness(element);
    EXPECT_LT((K * translation).norm(), 1e-12 * K.norm());
    EXPECT_LT((K * rotation).norm(), 1e-12 * K.norm());
  }
}

TEST(BeamMass, OfHermiteElementsIsTheTabulatedOne) {
  // Przemieniecki (11.29): ρAl/420 [156 22l 54 −13l; 4l² 13l −3l²; 156 −22l; 4l²]
  const double l = 0.3;
  const Eigen::Matrix4d M = detail::element_mass({.length = l, .bending = 1.0, .mass = 420.0 / l});
  Eigen::Matrix4d expected;
  expected << 156, 22 * l, 54, -13 * l, 22 * l, 4 * l * l, 13 * l, -3 * l * l, 54, 13 * l, 156, -22 * l, -13 * l,
      -3 * l * l, -22 * l, 4 * l * l;
  EXPECT_LT((M - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BeamShapes, ConvergeToTheModesInValueSlopeAndCurvature) {
  // φ = cosh βx − cos βx − σ (sinh βx − sin βx), ∫φ² = L, so the mass-normalised shape is φ/√(ρAL)
  const double beta_l = 7.854757438237613;  // third mode, Blevins table 8-1
  const double sigma = 0.999224496517;      // (cosh βL + cos βL)/(sinh βL + sin βL)
  const auto errors = [&](int elements) {
    const Beam beam(source_beam(elements, 0.0));
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(41, 0.0, 0.4);
    const BeamShapes shapes = beam_shapes(beam, natural_modes(beam.structure(), 3), x);
    const double beta = beta_l / 0.4, scale = 1.0 / std::sqrt(7488.0 * 0.0128 * 0.00086 * 0.4);
    const double sign = shapes.displacement(40, 2) > 0.0 ? 1.0 : -1.0;  // φ₃(L) = 2
    Eigen::Vector3d worst = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double z = beta * x(i), c = std::cosh(z), s = std::sinh(z);
      const double y = c - std::cos(z) - sigma * (s - std::sin(z));
      const double slope = s + std::sin(z) - sigma * (c - std::cos(z));
      const double curvature = c + std::cos(z) - sigma * (s + std::sin(z));
      worst(0) = std::max(worst(0), std::abs(sign * shapes.displacement(i, 2) - scale * y));
      worst(1) = std::max(worst(1), std::abs(sign * shapes.slope(i, 2) / beta - scale * slope));
      worst(2) = std::max(worst(2), std::abs(sign * shapes.curvature(i, 2) / (beta * beta) - scale * curvature));
    }
    return Eigen::Vector3d(worst / scale);
  };
  // x lies on nodes of all three: value and slope of fourth order there, curvature of second
  const Eigen::Vector3d at_40 = errors(40), at_80 = errors(80), at_160 = errors(160);
  EXPECT_NEAR(std::log2(at_40(0) / at_80(0)), 4.0, 0.1);
  EXPECT_NEAR(std::log2(at_40(1) / at_80(1)), 4.0, 0.1);
  EXPECT_NEAR(std::log2(at_40(2) / at_80(2)), 2.0, 0.1);
  EXPECT_NEAR(std::log2(at_80(2) / at_160(2)), 2.0, 0.05);
}

}  // namespace
}  // namespace slipmode::fem
