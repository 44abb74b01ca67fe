#include <slipmode/core/decompositions.hpp>
#include <slipmode/fem/beam.hpp>

#include <slipmode/fem/modes.hpp>
#include <slipmode/rom/reduce.hpp>
#include "random_model.hpp"

#include <gtest/gtest.h>
#include <complex>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using dynamics::State;
using tests::normal_matrix;

/// A beam whose modes have ratios of their own: M and K sparse, C dense and not proportional.
HybridSystem rubbed_beam(int elements) {
  const fem::Beam beam({.spans = {{.length = 0.4,
                                   .width = 0.0128,
                                   .thickness = 0.00086,
                                   .youngs_modulus = 128e9,
                                   .density = 7488.0,
                                   .elements = elements}},
                        .tip = {.mass = 0.0155, .inertia = 3e-6, .offset = 0.02, .extension = 0.064},
                        .damping = fem::ModalRatios{{0.01, 0.03, 0.02}}});
  return {beam.structure(),
          {{beam.displacement_row(0.464), friction::Coulomb{0.75, 0.55}, 0.345, 0.0, 0.0, "nub"}},
          friction::Belt::constant(0.1)};
}

/// wᵀ(K + iωC − ω²M)⁻¹w
std::complex<double> receptance(const HybridSystem& model, double omega) {
  using namespace std::complex_literals;
  const Eigen::VectorXcd w = model.contacts()[0].direction.cast<std::complex<double>>();
  const Eigen::MatrixXcd Z =
      (fem::to_dense(model.structure().K()) - omega * omega * fem::to_dense(model.structure().M()))
          .cast<std::complex<double>>() +
      1.0i * omega * fem::to_dense(model.structure().C()).cast<std::complex<double>>();
  return w.dot(Z.partialPivLu().solve(w));
}

TEST(BeamReduction, WithAllModesIsTheFullBeamUnderModalRatioDamping) {
  const HybridSystem full = rubbed_beam(12);
  ASSERT_FALSE(full.structure().rayleigh().has_value());
  Random random(81);
  // Natural modes, and any invertible change of variables: here lightly mixed natural modes.
  const pod::Basis lnm = lnm_basis(full.structure(), 24);
  const pod::Basis mixed =
      user_basis(lnm.vectors * (Eigen::MatrixXd::Identity(24, 24) + 0.05 * normal_matrix(random, 24, 24)));
  for (const pod::Basis& basis : {lnm, mixed}) {
    const HybridSystem model = reduce(full, basis);
    for (const double hz : {0.5, 12.0, 41.1, 300.0}) {
      const double omega = 2.0 * 3.141592653589793 * hz;
      const std::complex<double> expected = receptance(full, omega);
      EXPECT_LT(std::abs(receptance(model, omega) - expected), 1e-8 * std::abs(expected)) << hz;
    }
  }
}

TEST(BeamReduction, ModalRatiosStayDiagonalInNaturalModes) {
  // C = M Φ diag(2ζω) ΦᵀM, so ΦᵀCΦ = diag(2ζω); the last ratio holds for all further modes.
  const HybridSystem full = rubbed_beam(12);
  const fem::Modes modes = fem::natural_modes(full.structure(), 5);
  const Eigen::VectorXd expected =
      2.0 * modes.omega.cwiseProduct((Eigen::VectorXd(5) << 0.01, 0.03, 0.02, 0.02, 0.02).finished());
  const Eigen::MatrixXd C = fem::to_dense(reduce(full, lnm_basis(full.structure(), 5)).structure().C());
  EXPECT_LT((C - Eigen::MatrixXd(expected.asDiagonal())).norm(), 1e-9 * expected.norm());
}

TEST(BeamReduction, RestrictUndoesLiftForManyModes) {
  const HybridSystem full = rubbed_beam(80);
  pod::Basis basis = lnm_basis(full.structure(), 100);
  Random random(82);
  basis.mean = 1e-3 * basis.vectors * normal_matrix(random, 100, 1);
  const State reduced{
      0.25, normal_matrix(random, 100, 1), normal_matrix(random, 100, 1), {dynamics::ContactMode::kStick}};
  const State back = restrict_state(full.structure(), basis, lift(basis, reduced));
  EXPECT_LT((back.q - reduced.q).norm(), 1e-9 * reduced.q.norm());
  EXPECT_LT((back.v - reduced.v).norm(), 1e-9 * reduced.v.norm());
  const HybridSystem model = reduce(full, basis);
  EXPECT_EQ(model.size(), 100);
  // E(lift(s)) = E_reduced(s) + ½ q̄ᵀK q̄
  const double offset = 0.5 * basis.mean.dot(fem::multiply(full.structure().K(), basis.mean).col(0));
  const double lifted = full.energy(lift(basis, reduced));
  EXPECT_NEAR(model.energy(reduced) + offset, lifted, 1e-10 * lifted);
}

TEST(BeamReduction, AllModesGiveAStateBackWhereMetresAndRadiansAreFarApart) {
  // Elements of a few millimetres: masses of rotations are 1e-6 of those of displacements, and M as such has a
  // condition of 1e7. Restricted, a state came back with 5e-9 of itself missing.
  const HybridSystem full = rubbed_beam(80);
  Random random(83);
  const State state{0.0, normal_matrix(random, full.size(), 1), normal_matrix(random, full.size(), 1), {}};
  for (const pod::Basis& basis : {lnm_basis(full.structure(), full.size()), lnm_static_basis(full, full.size() - 1)}) {
    const State back = lift(basis, restrict_state(full.structure(), basis, state));
    EXPECT_LT((back.q - state.q).norm(), 1e-12 * state.q.norm());
    EXPECT_LT((back.v - state.v).norm(), 1e-12 * state.v.norm());
  }
}

TEST(BeamReduction, KeepsEverythingAContactHasButItsDirectionAndOffset) {
  const HybridSystem plain = rubbed_beam(10);
  friction::Contact contact = plain.contacts()[0];
  contact.law = friction::CompliantCoulomb{0.75, 0.55, 20e3};
  contact.normal_load = friction::NormalLoad(0.345, -1.54);
  contact.tilt = 0.005;
  contact.offset = 1e-4;
  const HybridSystem full(plain.structure(), {contact}, plain.drive());
  pod::Basis basis = lnm_basis(full.structure(), 3);
  basis.mean = Eigen::VectorXd::Constant(full.size(), 1e-3);
  const friction::Contact seen = reduce(full, basis).contacts()[0];
  EXPECT_EQ(std::get<friction::CompliantCoulomb>(seen.law).stiffness, 20e3);
  EXPECT_EQ(seen.normal_load.constant, 0.345);
  EXPECT_EQ(seen.normal_load.slope, -1.54);
  EXPECT_EQ(seen.tilt, 0.005);
  EXPECT_EQ(seen.name, "nub");
  // y = 1e-3 (1 + extension·1) in the mean: displacement and rotation of the end are both 1e-3.
  EXPECT_NEAR(seen.offset, 1e-4 + 1e-3 * 1.064, 1e-17);
  EXPECT_LT((seen.direction - basis.vectors.transpose() * contact.direction).norm(), 1e-15 * seen.direction.norm());
}

TEST(BeamReduction, ContactsKeepTheirOwnStatesThroughLiftAndRestrict) {
  const HybridSystem full = rubbed_beam(10);
  const pod::Basis basis = lnm_basis(full.structure(), 3);
  State reduced{0.0, Eigen::Vector3d(1e-3, 0.0, 2e-4), Eigen::Vector3d(0.1, 0.2, 0.0)};
  reduced.internal = Eigen::VectorXd::Constant(1, 4e-5);
  const State lifted = lift(basis, reduced);
  EXPECT_EQ(lifted.internal, reduced.internal);
  EXPECT_EQ(restrict_state(full.structure(), basis, lifted).internal, reduced.internal);
}

}  // namespace
}  // namespace slipmode::rom
