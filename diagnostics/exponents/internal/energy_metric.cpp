#include "diagnostics/exponents/internal/energy_metric.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/friction/engaged.hpp>

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {
namespace {

/// ω² of K against M = L Lᵀ, ascending.
Eigen::VectorXd squared_frequencies(const Eigen::MatrixXd& K, const Eigen::LLT<Eigen::MatrixXd>& mass) {
  const Eigen::MatrixXd half = mass.matrixL().solve(K);
  const Eigen::MatrixXd A = mass.matrixL().solve(Eigen::MatrixXd(half.transpose()));
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

/// The lowest frequency there is, squared: of the structure, else of the drive, else 1.
double lowest(const dynamics::HybridSystem& system, const Eigen::VectorXd& squares, double zero) {
  for (const double square : squares)
    if (square > zero) return square;
  const auto period = system.drive().period();
  constexpr double kTurn = 6.283185307179586;
  return period ? (kTurn / *period) * (kTurn / *period) : 1.0;
}

/// Square roots of what each of the contacts' own states weighs.
Eigen::VectorXd own_weights(const dynamics::HybridSystem& system) {
  Eigen::VectorXd weights(system.internal_size());
  Eigen::Index at = 0;
  for (const friction::Contact& contact : system.contacts()) {
    const friction::LawKind kind = friction::kind(contact.law);
    if (kind == friction::LawKind::kCompliant || kind == friction::LawKind::kBristle)
      weights[at++] = std::sqrt(friction::spring_stiffness(contact.law));
    if (!contact.normal_load.oscillator) continue;
    const friction::NormalOscillator& load = *contact.normal_load.oscillator;
    const double stiffness = load.support_stiffness + load.spring_stiffness;
    weights[at++] = std::sqrt(stiffness > 0.0 ? stiffness : load.mass);
    weights[at++] = std::sqrt(load.mass);
  }
  return weights;
}

}  // namespace

EnergyMetric::EnergyMetric(const dynamics::HybridSystem& system) : n_(system.size()), own_(own_weights(system)) {
  constexpr double kSingular = 1e-12;
  const Eigen::LLT<Eigen::MatrixXd> mass(fem::to_dense(system.structure().M()));
  Eigen::MatrixXd K = fem::to_dense(system.structure().K());
  Eigen::MatrixXd engaged = K;
  for (const friction::Contact& contact : system.contacts())
    engaged += friction::engaged_stiffness(contact.law) * contact.direction * contact.direction.transpose();
  const Eigen::VectorXd squares = squared_frequencies(K, mass), all = squared_frequencies(engaged, mass);
  const double zero = kSingular * std::max(all[n_ - 1], 0.0);
  fastest_ = std::sqrt(std::max(all[n_ - 1], lowest(system, all, zero)));
  if (squares[0] <= zero) K = engaged;
  if (squares[0] <= zero && all[0] <= zero) K += lowest(system, all, zero) * fem::to_dense(system.structure().M());

  const auto identity = Eigen::MatrixXd::Identity(n_, n_);
  const Eigen::LLT<Eigen::MatrixXd> stiffness(K);
  q_in_ = stiffness.matrixU();
  v_in_ = mass.matrixU();
  q_out_ = stiffness.matrixU().solve(identity);
  v_out_ = mass.matrixU().solve(identity);
}

Eigen::MatrixXd EnergyMetric::enter(const Eigen::MatrixXd& directions) const {
  Eigen::MatrixXd out(directions.rows(), directions.cols());
  out << q_in_ * directions.topRows(n_), v_in_ * directions.middleRows(n_, n_),
      own_.asDiagonal() * directions.bottomRows(own_.size());
  return out;
}

Eigen::MatrixXd EnergyMetric::leave(const Eigen::MatrixXd& coordinates) const {
  Eigen::MatrixXd out(coordinates.rows(), coordinates.cols());
  out << q_out_ * coordinates.topRows(n_), v_out_ * coordinates.middleRows(n_, n_),
      own_.cwiseInverse().asDiagonal() * coordinates.bottomRows(own_.size());
  return out;
}

}  // namespace slipmode::diagnostics
