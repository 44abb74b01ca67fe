#include <slipmode/rom/reduce.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include "rom/internal/check.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::rom {

namespace {

constexpr double kVisible = 1e-10;  // cosine between a contact's direction and the basis; below it is rounding

Eigen::MatrixXd project(const fem::Matrix& A, const Eigen::MatrixXd& Phi) {
  return Phi.transpose() * fem::multiply(A, Phi);
}

Eigen::MatrixXd project_symmetric(const fem::Matrix& A, const Eigen::MatrixXd& Phi) {
  const Eigen::MatrixXd projected = project(A, Phi);
  return 0.5 * (projected + projected.transpose());
}

std::string label(const friction::Contact& contact, std::size_t index) {
  return contact.name.empty() ? fmt::format("contact {} (from 1)", index + 1)
                              : fmt::format("contact '{}'", contact.name);
}

/// Every contact must have a component in the span of the basis, and those components must be independent: otherwise
/// sticking would ask the basis for a motion it does not hold.
void check_contacts(const std::vector<friction::Contact>& contacts, const Eigen::MatrixXd& Phi) {
  if (contacts.empty()) return;
  const Eigen::MatrixXd Q = orthonormal_columns(Phi);
  Eigen::MatrixXd seen(Phi.cols(), static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    auto column = seen.col(static_cast<Eigen::Index>(c));
    column = Q.transpose() * contacts[c].direction.normalized();
    const double cosine = column.norm();
    if (!(cosine >= kVisible)) {
      throw InvalidInput(
          fmt::format("reduce: {} is invisible to the basis of {} vectors: only {:.3g} of its direction lies "
                      "in their span, at least {:.0e} needed. Add vectors that move at the contact",
                      label(contacts[c], c), Phi.cols(), cosine, kVisible));
    }
    column /= cosine;
  }
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(seen).singularValues();
  const double independence = seen.cols() > seen.rows() ? 0.0 : sigma[sigma.size() - 1] / sigma[0];
  if (!(independence >= kVisible)) {
    throw InvalidInput(
        fmt::format("reduce: a basis of {} vectors cannot tell its {} contacts apart (smallest to largest "
                    "singular value of their projections {:.3g}, at least {:.0e} needed). Keep more vectors",
                    Phi.cols(), contacts.size(), independence, kVisible));
  }
}

std::vector<std::string> amplitude_names(Eigen::Index L) {
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= L; ++i) names.push_back(fmt::format("a{}", i));
  return names;
}

/// A motion that strains nothing must stay one: the projected K is rounded at the size of what cancelled in it, and
/// that may be far more than of its entries rounding is. Takes out what is left of such motions.
Eigen::MatrixXd without_rounding(Eigen::MatrixXd K, const Eigen::MatrixXd& M, const fem::Matrix& full,
                                 const Eigen::MatrixXd& Phi) {
  constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
  const auto magnitudes = [](const auto& m) -> fem::Matrix { return m.cwiseAbs().eval(); };
  const Eigen::MatrixXd size = project(std::visit(magnitudes, full), Phi.cwiseAbs());
  const Eigen::MatrixXd least = static_cast<double>(K.rows()) * kRounding * size.diagonal().asDiagonal();
  if (Eigen::LLT<Eigen::MatrixXd>(K - least).info() == Eigen::Success) return K;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);
  if (modes.info() != Eigen::Success) return K;
  for (const auto& shape : modes.eigenvectors().colwise()) {
    const Eigen::VectorXd force = K * shape, inertia = M * shape, sizes = shape.cwiseAbs();
    const double stiffness = shape.dot(force);
    if (!(std::abs(stiffness) <= kRounding * sizes.dot(size * sizes))) continue;
    K += stiffness * inertia * inertia.transpose() - inertia * force.transpose() - force * inertia.transpose();
  }
  return 0.5 * (K + K.transpose());
}

fem::Structure project_structure(const fem::Structure& full, const Eigen::MatrixXd& Phi) {
  const Eigen::MatrixXd projected = project_symmetric(full.M(), Phi);
  fem::Matrix K = without_rounding(project_symmetric(full.K(), Phi), projected, full.K(), Phi);
  fem::Matrix M = projected;
  const std::optional<fem::Rayleigh> rayleigh = full.rayleigh();
  if (rayleigh) return {std::move(M), *rayleigh, std::move(K), amplitude_names(Phi.cols()), full.units()};
  fem::Matrix C = full.has_symmetric_damping() ? project_symmetric(full.C(), Phi) : project(full.C(), Phi);
  return {std::move(M), std::move(C), std::move(K), amplitude_names(Phi.cols()), full.units()};
}

}  // namespace

dynamics::HybridSystem reduce(const dynamics::HybridSystem& full, const pod::Basis& basis) {
  check_basis(basis, full.size(), "reduce");
  check_contacts(full.contacts(), basis.vectors);
  const Eigen::MatrixXd& Phi = basis.vectors;
  const Eigen::VectorXd mean = mean_or_zero(basis);

  std::vector<friction::Contact> contacts = full.contacts();
  for (friction::Contact& contact : contacts) {
    contact.offset += contact.direction.dot(mean);
    contact.direction = (Phi.transpose() * contact.direction).eval();
  }
  Eigen::VectorXd residual = -fem::multiply(full.structure().K(), mean);
  if (full.load().size() > 0) residual += full.load();
  return {project_structure(full.structure(), Phi), std::move(contacts), full.drive(), Phi.transpose() * residual,
          Phi.transpose() * full.force_directions()};
}

}  // namespace slipmode::rom
