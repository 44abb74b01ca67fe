// Snapshots over many decades, bases near singular, stability of reduced models.
#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/pod/pod.hpp>
#include <slipmode/rom/reduce.hpp>
#include "selftest/cases.hpp"
#include "selftest/small_systems.hpp"

#include <algorithm>
#include <bit>

namespace slipmode::selftest {
namespace {

using friction::Belt;
using friction::Coulomb;

/// Sylvester's Hadamard matrix of order 16, without its constant row: rows of mean zero, orthogonal, all entries ±1.
Eigen::MatrixXd hadamard() {
  Eigen::MatrixXd H(15, 16);
  for (int i = 1; i < 16; ++i)
    for (int j = 0; j < 16; ++j) H(i - 1, j) = std::popcount(static_cast<unsigned>(i & j)) % 2 == 0 ? 1.0 : -1.0;
  return H;
}

/// Nine singular values 2^(−7k), over 17 decades.
Eigen::VectorXd decades() {
  Eigen::VectorXd sigma(9);
  for (int k = 0; k < 9; ++k) sigma(k) = std::ldexp(1.0, -7 * k);
  return sigma;
}

/// Dofs that each carry one singular value: exact by construction, nothing rounds.
double graded_error() {
  pod::Ensemble ensemble;
  ensemble.snapshots = decades().asDiagonal() * hadamard().topRows(9);
  const Eigen::VectorXd found = pod::pod(ensemble, {.rank_tolerance = 1e-20}).singular_values;
  return (found - decades()).cwiseQuotient(decades()).cwiseAbs().maxCoeff();
}

/// All dofs carry all singular values: the smallest one, of the largest, that is still right within 10 %.
double smallest_seen(pod::PodMethod method) {
  Eigen::MatrixXd mix = hadamard().leftCols(15);  // not orthogonal: one column is left out
  mix = Eigen::HouseholderQR<Eigen::MatrixXd>(mix).householderQ();
  pod::Ensemble ensemble;
  ensemble.snapshots = mix.leftCols(9) * decades().asDiagonal() * hadamard().topRows(9);
  const Eigen::VectorXd found = pod::pod(ensemble, {.method = method, .rank_tolerance = 1e-20}).singular_values;
  double smallest = 1.0;
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(9, found.size()); ++k)
    if (std::abs(found(k) / decades()(k) - 1.0) < 0.1) smallest = decades()(k);
  return smallest;
}

double few_snapshots() {
  Random random(7);
  pod::Ensemble ensemble;
  ensemble.snapshots.resize(200, 5);
  for (double& x : ensemble.snapshots.reshaped()) x = random.normal();
  const pod::PodResult result = pod::pod(ensemble);
  if (result.rank != 4) return 1.0;
  const Eigen::MatrixXd& phi = result.basis.vectors;
  return (phi.transpose() * phi - Eigen::MatrixXd::Identity(phi.cols(), phi.cols())).cwiseAbs().maxCoeff();
}

double constant_snapshots() {
  return refused<InvalidInput>(
      [] { static_cast<void>(pod::pod({.snapshots = Eigen::MatrixXd::Constant(4, 9, 0.3)})); });
}

dynamics::State start_of_chain() {
  return {0.0, Eigen::VectorXd::LinSpaced(10, -0.4, 0.8), Eigen::VectorXd::LinSpaced(10, 0.3, -0.6)};
}

/// Full model beside the one reduced on all modes of `vectors`, at the end of 60 units.
double all_modes_distance(const Eigen::MatrixXd& vectors) {
  const auto full = uniform_chain(10, Coulomb{0.4, 0.2}, 0.2);
  const pod::Basis basis = rom::user_basis(vectors, Eigen::VectorXd::Constant(10, 0.3));
  const dynamics::HybridSystem reduced = rom::reduce(full, basis);
  const dynamics::State start = start_of_chain();
  const auto a = dynamics::simulate(full, start, {.duration = 60.0}).final_state;
  const auto b =
      dynamics::simulate(reduced, rom::restrict_state(full.structure(), basis, start), {.duration = 60.0}).final_state;
  return (rom::lift(basis, b).q - a.q).cwiseAbs().maxCoeff();
}

/// Orthonormal columns but for the last, which lies within `gap` of the first.
Eigen::MatrixXd nearly_singular(double gap) {
  Random random(11);
  Eigen::MatrixXd vectors(10, 10);
  for (double& x : vectors.reshaped()) x = random.normal();
  vectors = Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(vectors).householderQ());
  vectors.col(9) = vectors.col(0) + gap * vectors.col(9);
  return vectors;
}

double invisible_contact() {
  return refused<InvalidInput>([] {
    static_cast<void>(
        rom::reduce(uniform_chain(10, Coulomb{0.4, 0.2}, 0.2), rom::user_basis(Eigen::MatrixXd::Identity(10, 9))));
  });
}

/// Largest real part of the eigenvalues of M q̈ + C q̇ + K q = 0, of the largest modulus.
double growth(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C, const Eigen::MatrixXd& K) {
  const Eigen::Index n = M.rows();
  const Eigen::LLT<Eigen::MatrixXd> mass(M);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -mass.solve(K);
  A.bottomRightCorner(n, n) = -mass.solve(C);
  const Eigen::VectorXcd values = Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
  return values.real().maxCoeff() / values.cwiseAbs().maxCoeff();
}

/// Over reduced models of random chains on random bases: slip, rigid stick, stick behind a contact spring.
double largest_growth(int bases) {
  double worst = -1.0;
  for (int i = 0; i < bases; ++i) {
    Random random = Random::stream(3, static_cast<std::uint64_t>(i));
    const int n = 2 + static_cast<int>(random.uniform() * 7.0), L = 1 + static_cast<int>(random.uniform() * n);
    fem::ChainOptions options{.masses = n, .mass = {}, .stiffness = {}, .damping = random.uniform(0.0, 2.0)};
    for (int k = 0; k < n; ++k) {
      options.mass.push_back(random.uniform(0.3, 3.0));
      options.stiffness.push_back(random.uniform(0.1, 5.0));
    }
    Eigen::MatrixXd phi(n, L);
    for (double& x : phi.reshaped()) x = random.normal();
    const dynamics::HybridSystem full(fem::chain(options), {{Eigen::VectorXd::Unit(n, n - 1), Coulomb{0.4, 0.2}, 1.0}},
                                      Belt::constant(0.2));
    const dynamics::HybridSystem reduced = rom::reduce(full, rom::user_basis(phi));
    const Eigen::MatrixXd M = fem::to_dense(reduced.structure().M()), C = fem::to_dense(reduced.structure().C()),
                          K = fem::to_dense(reduced.structure().K());
    const Eigen::VectorXd& w = reduced.contacts().front().direction;
    worst = std::max(worst, growth(M, C, K));
    worst = std::max(worst, growth(M, C, K + random.uniform(1.0, 1e4) * w * w.transpose()));
    if (L == 1) continue;
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(Eigen::MatrixXd(w)).householderQ();
    const Eigen::MatrixXd Z = Q.rightCols(L - 1);
    worst = std::max(worst, growth(Z.transpose() * M * Z, Z.transpose() * C * Z, Z.transpose() * K * Z));
  }
  return worst;
}

}  // namespace

std::vector<ExtremeCase> reduction_cases() {
  const char* smallest = "smallest singular value right within 10 %, of the largest";
  const char* exact = "full and reduced after 60 units, distance";
  return {
      {"17 decades, one per dof", "singular values by SVD, relative error", 1e-14, graded_error},
      {"17 decades, mixed, SVD", smallest, 1e-14, [] { return smallest_seen(pod::PodMethod::kQrSvd); }},
      {"17 decades, mixed, covariance", smallest, 1e-6, [] { return smallest_seen(pod::PodMethod::kCovariance); }},
      {"5 snapshots of 200 dofs", "orthonormality of its 4 modes", 1e-13, few_snapshots},
      {"constant snapshots", "a clear failure", 0.0, constant_snapshots},
      {"all modes, LNM", exact, 1e-10,
       [] { return all_modes_distance(rom::lnm_basis(uniform_chain(10, Coulomb{}, 0.0).structure(), 10).vectors); }},
      {"all modes, columns 1e-3 apart", exact, 1e-8, [] { return all_modes_distance(nearly_singular(1e-3)); }},
      {"all modes, columns 1e-5 apart", exact, 1e-3, [] { return all_modes_distance(nearly_singular(1e-5)); }},
      {"columns 1e-9 apart", "a clear failure", 0.0,
       [] { return refused<InvalidInput>([] { static_cast<void>(all_modes_distance(nearly_singular(1e-9))); }); }},
      {"a contact the basis cannot see", "a clear failure", 0.0, invisible_contact},
      {"10,000 random bases", "largest Re/|eigenvalue| in slip, stick, sprung stick", 1e-13,
       [] { return largest_growth(10000); }},
  };
}

}  // namespace slipmode::selftest
