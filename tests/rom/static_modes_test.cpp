#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kL = 0.4, kExtension = 0.064;
constexpr double kEI = 128e9 * 0.0128 * 0.00086 * 0.00086 * 0.00086 / 12.0;

fem::Beam beam(int elements) {
  return fem::Beam({.spans = {{.length = kL,
                               .width = 0.0128,
                               .thickness = 0.00086,
                               .youngs_modulus = 128e9,
                               .density = 7488.0,
                               .elements = elements}},
                    .tip = {.mass = 0.0155, .inertia = 3e-6, .offset = 0.02, .extension = kExtension}});
}

HybridSystem rubbed(const fem::Beam& beam, const std::vector<double>& at) {
  std::vector<friction::Contact> contacts;
  for (const double x : at) contacts.push_back({beam.displacement_row(x), friction::Coulomb{0.4, 0.2}, 0.3});
  return {beam.structure(), contacts, friction::Belt::constant(0.1)};
}

/// Displacement of the contact per unit of a constant force there, λ w: w_rᵀK_r⁻¹w_r.
double static_compliance(const HybridSystem& model) {
  const Eigen::VectorXd& w = model.contacts()[0].direction;
  return w.dot(fem::to_dense(model.structure().K()).ldlt().solve(w));
}

TEST(StaticModes, MakeTheTipsStaticDeflectionExactWithAnyNumberOfNaturalModes) {
  // P L³/(3EI): Euler-Bernoulli; cubic elements are exact at nodes under end loads.
  const HybridSystem full = rubbed(beam(20), {kL});
  for (const Eigen::Index count : {0, 1, 2, 5, 15}) {
    EXPECT_NEAR(static_compliance(reduce(full, lnm_static_basis(full, count))) / (kL * kL * kL / (3.0 * kEI)), 1.0,
                1e-9)
        << count;
  }
  const double without = static_compliance(reduce(full, lnm_basis(full.structure(), 2)));
  EXPECT_LT(without, 0.9999 * kL * kL * kL / (3.0 * kEI));
}

TEST(StaticModes, MakeTheDeflectionAtARigidExtensionExact) {
  // Force P and moment P l at L: y + l θ = P (L³/3 + l L² + l² L)/EI.
  const double expected = (kL * kL * kL / 3.0 + kExtension * kL * kL + kExtension * kExtension * kL) / kEI;
  const HybridSystem full = rubbed(beam(20), {kL + kExtension});
  for (const Eigen::Index count : {0, 3, 8}) {
    EXPECT_NEAR(static_compliance(reduce(full, lnm_static_basis(full, count))) / expected, 1.0, 1e-9) << count;
  }
}

TEST(StaticModes, OfAChainAreStraightLines) {
  // Unit springs from a wall: a unit force on the last mass moves mass i by i.
  const fem::Structure chain = fem::chain({.masses = 5});
  const pod::Basis basis = lnm_static_basis(chain, Eigen::VectorXd::Unit(5, 4), 0);
  const Eigen::VectorXd line = Eigen::VectorXd::LinSpaced(5, 1.0, 5.0);
  EXPECT_LT((basis.vectors - line.normalized()).norm(), 1e-14);
  EXPECT_EQ(basis.kind, pod::BasisKind::kLnmStatic);
}

TEST(StaticModes, TruncatedToLVectorsKeepStaticAndLowestNaturalModes) {
  const fem::Beam cantilever = beam(15);
  const HybridSystem full = rubbed(cantilever, {kL, 0.2});
  const pod::Basis ten = lnm_static_basis(full, 8);
  const fem::Matrix& M = full.structure().M();
  EXPECT_LT((ten.vectors.transpose() * fem::multiply(M, ten.vectors) - Eigen::MatrixXd::Identity(10, 10)).norm(),
            1e-11);
  for (const Eigen::Index L : {2, 3, 6}) {
    const Eigen::MatrixXd six = lnm_static_basis(full, L - 2).vectors;
    EXPECT_LT(pod::subspace_angles(ten.truncated(L).vectors, six, M).maxCoeff(), 1e-9) << L;
  }
  EXPECT_LT(pod::subspace_angles(ten.vectors, lnm_basis(full.structure(), 8).vectors, M).maxCoeff(), 1e-9);
}

TEST(StaticModes, SpanTheResidualAttachmentMode) {
  // Σ_{k>count} φ_k φ_kᵀw/ω_k², summed from all natural modes.
  const HybridSystem full = rubbed(beam(10), {kL});
  const fem::Modes all = fem::natural_modes(full.structure());
  const Eigen::VectorXd amplitudes =
      (all.shapes.transpose() * full.contacts()[0].direction).array() / all.omega.array().square();
  const Eigen::MatrixXd residual = all.shapes.rightCols(20 - 3) * amplitudes.tail(20 - 3);
  EXPECT_LT(pod::subspace_angles(lnm_static_basis(full, 3).vectors, residual, full.structure().M())[0], 1e-6);
}

TEST(StaticModes, RefuseRigidBodiesAndBadSizes) {
  const fem::Structure loose = fem::chain({.masses = 4, .left_fixed = false});
  EXPECT_THAT([&] { (void)lnm_static_basis(loose, Eigen::VectorXd::Unit(4, 3), 2); },
              ThrowsMessage<InvalidInput>(HasSubstr("K is singular (at least 1 rigid-body mode(s))")));
  const fem::Structure chain = fem::chain({.masses = 4});
  EXPECT_THAT([&] { (void)lnm_static_basis(chain, Eigen::VectorXd::Unit(4, 3), 4); },
              ThrowsMessage<InvalidInput>(HasSubstr("4 natural modes asked beside 1 static ones of 4")));
  EXPECT_THROW((void)lnm_static_basis(chain, Eigen::VectorXd::Unit(4, 3), -1), InvalidInput);
  EXPECT_THROW((void)lnm_static_basis(chain, Eigen::VectorXd::Unit(3, 2), 1), InvalidInput);
  EXPECT_THAT([&] { (void)lnm_static_basis(chain, Eigen::MatrixXd::Ones(4, 2), 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("vector 2 (from 1) depends")));
  const HybridSystem alone(chain, {}, friction::Belt::constant(0.1));
  EXPECT_THAT([&] { (void)lnm_static_basis(alone, 1); }, ThrowsMessage<InvalidInput>(HasSubstr("no contacts")));
}

}  // namespace
}  // namespace slipmode::rom
