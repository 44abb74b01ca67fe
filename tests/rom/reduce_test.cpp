#include <slipmode/core/decompositions.hpp>
#include <slipmode/rom/reduce.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/simulate.hpp>
#include <slipmode/fem/chain.hpp>
#include <slipmode/fem/modes.hpp>
#include "random_model.hpp"

#include <gtest/gtest.h>
#include <numbers>
#include <string>

namespace slipmode::rom {
namespace {

using dynamics::HybridSystem;
using fem::to_dense;
using tests::normal_matrix;
using tests::random_basis;
using tests::random_system;

HybridSystem chain_on_belt(const fem::ChainOptions& options, Eigen::Index at) {
  friction::Contact contact{Eigen::VectorXd::Unit(options.masses, at), friction::Coulomb{0.4, 0.2}, 3.0};
  return {fem::chain(options), {contact}, friction::Belt::constant(0.2)};
}

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no InvalidInput was thrown";
}

TEST(Reduce, MatchesAProjectionDoneByHand) {
  // M = diag(1, 2, 3), unit springs, wall on the left; φ1 = (1, 2, 3), φ2 = (1, 0, −1), q̄ = (1, 1, 2). By hand:
  // Kφ1 = (0, 0, 1), Kφ2 = (2, 0, −1), Kq̄ = (1, −1, 1).
  const fem::Structure structure = fem::chain({.masses = 3, .mass = {1.0, 2.0, 3.0}, .damping = 0.5});
  const friction::Contact contact{Eigen::Vector3d::Unit(2), friction::Coulomb{0.4, 0.2}, 3.0, 0.5, 0.0, "pad"};
  const HybridSystem full(structure, {contact}, friction::Belt::constant(0.2), Eigen::Vector3d(0.5, 0.0, 0.25));
  const Eigen::MatrixXd Phi = (Eigen::MatrixXd(3, 2) << 1, 1, 2, 0, 3, -1).finished();
  const HybridSystem reduced = reduce(full, user_basis(Phi, Eigen::Vector3d(1.0, 1.0, 2.0)));

  EXPECT_EQ(to_dense(reduced.structure().M()), (Eigen::Matrix2d() << 36, -8, -8, 4).finished());
  EXPECT_EQ(to_dense(reduced.structure().K()), (Eigen::Matrix2d() << 3, -1, -1, 3).finished());
  EXPECT_EQ(to_dense(reduced.structure().C()), (Eigen::Matrix2d() << 1.5, -0.5, -0.5, 1.5).finished());
  EXPECT_EQ(reduced.contacts()[0].direction, Eigen::Vector2d(3.0, -1.0));
  EXPECT_EQ(reduced.contacts()[0].offset, 2.5);             // wᵀq̄ + 0.5
  EXPECT_EQ(reduced.load(), Eigen::Vector2d(-0.75, 0.25));  // Φᵀ(p − Kq̄)
  EXPECT_EQ(reduced.contacts()[0].name, "pad");
  EXPECT_EQ(reduced.structure().dof_names(), (std::vector<std::string>{"a1", "a2"}));
  EXPECT_EQ(reduced.structure().units(), structure.units());
}

TEST(Reduce, RayleighDampingKeepsItsCoefficients) {
  const HybridSystem full = chain_on_belt({.masses = 8, .damping = 0.006, .mass_damping = 0.01}, 7);
  const fem::Structure reduced = reduce(full, lnm_basis(full.structure(), 3)).structure();
  ASSERT_TRUE(reduced.rayleigh().has_value());
  EXPECT_EQ(reduced.rayleigh()->mass, 0.01);
  EXPECT_EQ(reduced.rayleigh()->stiffness, 0.006);
}

TEST(Reduce, GeneralDampingIsProjected) {
  Random random(51);
  const Eigen::MatrixXd C = tests::random_definite(random, 4, 2, 0.0);
  const fem::Structure chain = fem::chain({.masses = 4});
  const HybridSystem full(fem::Structure(chain.M(), fem::Matrix(C), chain.K()),
                          {{Eigen::VectorXd::Unit(4, 3), friction::Coulomb{0.4, 0.2}}}, friction::Belt::constant(0.2));
  const pod::Basis basis = random_basis(random, 4, 2);
  const Eigen::MatrixXd expected = basis.vectors.transpose() * C * basis.vectors;
  EXPECT_LT((to_dense(reduce(full, basis).structure().C()) - expected).cwiseAbs().maxCoeff(), 1e-14 * expected.norm());
}

TEST(Reduce, KeepsTheSkewPartOfDamping) {
  const Eigen::MatrixXd C{{0.0994, -0.033}, {-0.024, 0.0884}};  // S1 (6) in power-conjugate form
  const fem::Structure structure(Eigen::MatrixXd{{1.21, 0.36}, {0.36, 1.0}}, C,
                                 Eigen::MatrixXd(Eigen::MatrixXd::Zero(2, 2)));
  const friction::Contact contact{Eigen::Vector2d::Unit(0), friction::Clearance{{}, friction::Stop{1.0, 0.0, 1.0}}};
  const HybridSystem full(structure, {contact}, friction::Force{});
  const Eigen::MatrixXd Phi{{1.0, 2.0}, {-1.0, 1.0}};
  const fem::Structure reduced = reduce(full, user_basis(Phi)).structure();
  EXPECT_FALSE(reduced.has_symmetric_damping());
  EXPECT_TRUE(to_dense(reduced.C()).isApprox(Phi.transpose() * C * Phi, 1e-15));
}

TEST(Reduce, TwiceEqualsOnceWithTheProductBasis) {
  Random random(52);
  const HybridSystem full = random_system(random, 9);
  const pod::Basis first = random_basis(random, 9, 6);
  const pod::Basis second = random_basis(random, 6, 3);
  const HybridSystem twice = reduce(reduce(full, first), second);
  const HybridSystem once =
      reduce(full, user_basis(first.vectors * second.vectors, first.mean + first.vectors * second.mean));
  const auto differ = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).norm() / b.norm(); };
  EXPECT_LT(differ(to_dense(twice.structure().M()), to_dense(once.structure().M())), 1e-13);
  EXPECT_LT(differ(to_dense(twice.structure().C()) + to_dense(twice.structure().K()),
                   to_dense(once.structure().C()) + to_dense(once.structure().K())),
            1e-13);
  EXPECT_LT(differ(twice.load(), once.load()), 1e-13);
  EXPECT_LT(differ(twice.contacts()[0].direction, once.contacts()[0].direction), 1e-13);
  EXPECT_NEAR(twice.contacts()[0].offset, once.contacts()[0].offset, 1e-12);
}

TEST(Reduce, NaturalModesBecomeSingleOscillators) {
  const HybridSystem full = chain_on_belt({.masses = 10}, 9);
  const pod::Basis lnm = lnm_basis(full.structure(), 4);
  const fem::Structure reduced = reduce(full, lnm).structure();
  EXPECT_LT((to_dense(reduced.M()) - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), 1e-13);
  for (Eigen::Index k = 0; k < 4; ++k) {
    // Fixed-free chain: ω_k = 2 sin((2k − 1) π / (2 (2N + 1))).
    const double omega = 2.0 * std::sin(static_cast<double>(2 * k + 1) * std::numbers::pi / 42.0);
    EXPECT_NEAR(to_dense(reduced.K())(k, k), omega * omega, 1e-13);
  }
  EXPECT_EQ(lnm.kind, pod::BasisKind::kLnm);
  EXPECT_EQ(lnm.mean, Eigen::VectorXd::Zero(10));
  EXPECT_THROW((void)lnm_basis(full.structure(), 0), InvalidInput);
  EXPECT_THROW((void)lnm_basis(full.structure(), 11), InvalidInput);
}

TEST(Reduce, RestsWhereThePotentialEnergyIsLeastInTheBasis) {
  // Lifted equilibrium: Φᵀ(K q − p) = 0, and exactly K⁻¹p when that lies in q̄ + span Φ.
  Random random(53);
  for (int trial = 0; trial < 20; ++trial) {
    HybridSystem full = random_system(random, 7);
    pod::Basis basis = random_basis(random, 7, 3);
    const Eigen::MatrixXd K = to_dense(full.structure().K()) + Eigen::MatrixXd::Identity(7, 7);
    full = HybridSystem(fem::Structure(full.structure().M(), full.structure().C(), fem::Matrix(K)), full.contacts(),
                        full.drive(), full.load());
    const Eigen::VectorXd exact = K.llt().solve(full.load());
    const auto rest_of = [&](const pod::Basis& b) -> Eigen::VectorXd {
      const HybridSystem reduced = reduce(full, b);
      const Eigen::VectorXd a = to_dense(reduced.structure().K()).llt().solve(reduced.load());
      return lift(b, {0.0, a, Eigen::VectorXd::Zero(3)}).q;
    };
    EXPECT_LT((basis.vectors.transpose() * (K * rest_of(basis) - full.load())).norm(), 1e-11 * K.norm());
    basis.mean = exact + basis.vectors * Eigen::Vector3d(0.3, -2.0, 1.0);
    EXPECT_LT((rest_of(basis) - exact).norm(), 1e-11);
  }
}

// Two masses on a spring of their own, the only mode kept the one that leaves it as it is. A stiffness of 1e-64 was
// left, and a load of 1e-20 beside it: a place of equilibrium at 1e44, from which the motion was a difference.
TEST(Reduce, LeavesNoStiffnessWhereOnlyRigidMotionsAreKept) {
  Random random(59);
  for (int trial = 0; trial < 200; ++trial) {
    const double k = std::exp(3.0 * random.normal());
    const fem::Structure pair(Eigen::Vector2d(std::exp(random.normal()), std::exp(random.normal())).asDiagonal(),
                              Eigen::Matrix2d::Zero(), k * Eigen::Matrix2d{{1.0, -1.0}, {-1.0, 1.0}});
    const HybridSystem full(pair, {{Eigen::VectorXd::Unit(2, 0), friction::Coulomb{0.4, 0.2}}},
                            friction::Belt::constant(0.2));
    pod::Basis basis = lnm_basis(pair, 1);
    EXPECT_EQ(to_dense(reduce(full, basis).structure().K())(0, 0), 0.0) << trial;
    const double scale = std::exp(random.normal());  // any length, and turned by rounding
    basis.vectors.col(0) << scale / 3.0, scale / 3.0 * (1.0 + 4e-16);
    EXPECT_EQ(to_dense(reduce(full, basis).structure().K())(0, 0), 0.0) << trial;
  }
}

// A mass on a spring of its own beside a chain that floats: what takes the rounding of the chain's rigid motion out of
// K left 1e-33 between them, by which the mass, at rest on a stop, rattled without end (random scene 1930: 6326).
TEST(Reduce, KeepsApartWhatNothingCouples) {
  Random random(61);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Index n = 7, alone = trial % n;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd mass(n);
    for (double& m : mass) m = std::exp(random.normal());
    K(alone, alone) = std::exp(random.normal());
    for (Eigen::Index i = 0, last = -1; i < n; ++i) {
      if (i == alone) continue;
      if (last >= 0) {
        const double k = std::exp(random.normal());
        K(i, i) += k, K(last, last) += k, K(i, last) -= k, K(last, i) -= k;
      }
      last = i;
    }
    const fem::Structure parts{fem::Matrix(Eigen::MatrixXd(mass.asDiagonal())), fem::Matrix(Eigen::MatrixXd(0.1 * K)),
                               fem::Matrix(K)};
    const HybridSystem full(parts, {{Eigen::VectorXd::Unit(n, alone), friction::Coulomb{0.4, 0.2}}},
                            friction::Belt::constant(0.2));
    pod::Basis basis = random_basis(random, n, n);
    basis.vectors.row(alone).setZero();
    basis.vectors.col(alone) = Eigen::VectorXd::Unit(n, alone);
    const HybridSystem reduced = reduce(full, basis);
    for (const fem::Matrix* A : {&reduced.structure().K(), &reduced.structure().C()})
      EXPECT_EQ((to_dense(*A).col(alone).array() != 0.0).count(), 1) << trial;
  }
}

TEST(Reduce, EnergyOfTheLiftedStateDiffersByAConstant) {
  Random random(54);
  const HybridSystem full = random_system(random, 8);
  const pod::Basis basis = random_basis(random, 8, 5);
  const HybridSystem reduced = reduce(full, basis);
  const double constant = full.energy({0.0, basis.mean, Eigen::VectorXd::Zero(8)});  // ½ q̄ᵀKq̄ − pᵀq̄
  for (int trial = 0; trial < 10; ++trial) {
    const dynamics::State state{0.0, normal_matrix(random, 5, 1), normal_matrix(random, 5, 1)};
    const double expected = reduced.energy(state) + constant;
    EXPECT_NEAR(full.energy(lift(basis, state)), expected, 1e-12 * std::abs(expected) + 1e-11);
  }
}

TEST(Reduce, NamesAContactTheBasisCannotSee) {
  // Second mode of three equal masses between walls: (1, 0, −1), a node at the middle.
  const HybridSystem full = chain_on_belt({.masses = 3, .right_fixed = true}, 1);
  pod::Basis basis = lnm_basis(full.structure(), 3);
  basis.vectors = basis.vectors.col(1).eval();
  const std::string message = message_of([&] { (void)reduce(full, basis); });
  EXPECT_NE(message.find("contact 1 (from 1) is invisible"), std::string::npos) << message;
}

TEST(Reduce, NamesContactsTheBasisCannotTellApart) {
  const fem::Structure chain = fem::chain({.masses = 4});
  const HybridSystem full(chain,
                          {{Eigen::VectorXd::Unit(4, 3), friction::Coulomb{0.4, 0.2}},
                           {Eigen::VectorXd::Unit(4, 1), friction::Coulomb{0.4, 0.2}}},
                          friction::Belt::constant(0.2));
  const std::string message = message_of([&] { (void)reduce(full, lnm_basis(chain, 1)); });
  EXPECT_NE(message.find("cannot tell 2 contacts that stick apart"), std::string::npos) << message;
  EXPECT_EQ(reduce(full, lnm_basis(chain, 2)).size(), 2);
}

// One mode moves both contacts alike. That is no contradiction but where both stick rigidly.
TEST(Reduce, TellsApartOnlyContactsThatStickRigidly) {
  const friction::Stop stop{.stiffness = 2.0, .gap = 0.1};
  for (const friction::Law& law :
       {friction::Law(friction::TanhRegularised{0.4, 0.2, 8.0, 0.05}),
        friction::Law(friction::CompliantCoulomb{0.4, 0.2, 3.0}), friction::Law(friction::Dahl{0.3, 5.0}),
        friction::Law(friction::Clearance{.left = stop, .right = stop})}) {
    SCOPED_TRACE(friction::law_words()[law.index()]);
    const HybridSystem full(fem::chain({.masses = 4}),
                            {{Eigen::VectorXd::Unit(4, 3), law}, {Eigen::VectorXd::Unit(4, 1), law}},
                            friction::Belt::constant(0.2));
    const HybridSystem reduced = reduce(full, lnm_basis(full.structure(), 1));
    dynamics::State start = reduced.rest();
    start.q[0] = 10.0;
    const dynamics::Trajectory run = dynamics::simulate(reduced, start, {.duration = 60.0});
    EXPECT_LT(run.audit.residual(), 1e-11);
    const std::size_t fewest = friction::kind(law) == friction::LawKind::kSmooth ? 0 : 5;
    EXPECT_GE(run.events.size(), fewest);
  }
}

TEST(Reduce, TakesSeveralContactsAtOnePlaceForOne) {
  // Two Jenkins elements side by side are one of their sums, in a reduced model as in the full one.
  const auto on = [](const std::vector<std::pair<double, double>>& elements) {
    std::vector<friction::Contact> contacts;
    for (const auto& [limit, stiffness] : elements)
      contacts.push_back({Eigen::VectorXd::Unit(4, 3), friction::CompliantCoulomb{limit, limit, stiffness}});
    return HybridSystem(fem::chain({.masses = 4}), contacts, friction::Belt::constant(0.2));
  };
  const HybridSystem parts = on({{0.1, 0.4}, {0.15, 0.6}}), whole = on({{0.25, 1.0}});
  for (const Eigen::Index modes : {1, 2, 4}) {
    const auto end = [&](const HybridSystem& full) {
      const HybridSystem reduced = reduce(full, lnm_basis(full.structure(), modes));
      return dynamics::simulate(reduced, reduced.rest(), {.duration = 60.0}).final_state;
    };
    const dynamics::State a = end(parts), b = end(whole);
    EXPECT_LT((a.q - b.q).norm() + (a.v - b.v).norm(), 1e-11) << modes;
  }
}

TEST(Reduce, RefusesBasesThatDoNotFitWithTheFigure) {
  const HybridSystem full = chain_on_belt({.masses = 4}, 3);
  pod::Basis basis;
  basis.vectors = Eigen::MatrixXd::Identity(5, 2);
  EXPECT_NE(message_of([&] { (void)reduce(full, basis); }).find("5 x 2"), std::string::npos);
  basis.vectors = Eigen::MatrixXd::Identity(4, 2);
  basis.mean = Eigen::VectorXd::Zero(3);
  EXPECT_NE(message_of([&] { (void)reduce(full, basis); }).find("mean has 3"), std::string::npos);

  Eigen::MatrixXd nearly(4, 2);
  nearly << 1, 1, 1, 1, 1, 1, 1, 1 + 1e-9;
  const std::string message = message_of([&] { (void)user_basis(nearly); });
  EXPECT_NE(message.find("linearly dependent"), std::string::npos) << message;
  EXPECT_NE(message.find("e-10"), std::string::npos) << message;  // the measured ratio: 1e-9·√3/8 ≈ 2.2e-10

  EXPECT_THROW((void)user_basis(Eigen::MatrixXd(4, 0)), InvalidInput);
  EXPECT_THROW((void)user_basis(Eigen::MatrixXd::Zero(4, 1)), InvalidInput);
  EXPECT_THROW((void)user_basis(Eigen::MatrixXd::Constant(4, 1, std::nan(""))), InvalidInput);
  EXPECT_NO_THROW((void)user_basis(Eigen::MatrixXd(Eigen::Vector4d(1e-30, 1.0, 1e30, 2.0).asDiagonal())));
}

}  // namespace
}  // namespace slipmode::rom
