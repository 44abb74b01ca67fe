#include <slipmode/rom/reduce.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/friction/places.hpp>
#include "rom/internal/check.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <algorithm>
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

/// Every contact must have a component in the span of the basis, and those that stick rigidly at different places must
/// be independent: otherwise sticking would ask the basis for a motion it does not hold.
void check_contacts(const std::vector<friction::Contact>& contacts, const Eigen::MatrixXd& Phi) {
  if (contacts.empty()) return;
  const Eigen::MatrixXd Q = orthonormal_columns(Phi);
  Eigen::MatrixXd seen(Phi.cols(), 0);
  for (const std::vector<std::size_t>& place : friction::by_place(contacts)) {
    const std::size_t c = place.front();
    Eigen::VectorXd column = Q.transpose() * contacts[c].direction.normalized();
    const double cosine = column.norm();
    if (!(cosine >= kVisible)) {
      throw InvalidInput(
          fmt::format("reduce: {} is invisible to the basis of {} vectors: only {:.3g} of its direction lies "
                      "in their span, at least {:.0e} needed. Add vectors that move at the contact",
                      label(contacts[c], c), Phi.cols(), cosine, kVisible));
    }
    const auto is_rigid = [&](std::size_t i) { return friction::sticks_rigidly(friction::kind(contacts[i].law)); };
    if (std::ranges::none_of(place, is_rigid)) continue;
    seen.conservativeResize(Eigen::NoChange, seen.cols() + 1);
    seen.rightCols(1) = column / cosine;
  }
  if (seen.cols() == 0) return;
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(seen).singularValues();
  const double independence = seen.cols() > seen.rows() ? 0.0 : sigma[sigma.size() - 1] / sigma[0];
  if (!(independence >= kVisible)) {
    throw InvalidInput(fmt::format(
        "reduce: a basis of {} vectors cannot tell {} contacts that stick apart (smallest to largest "
        "singular value of their projections {:.3g}, at least {:.0e} needed). Keep more vectors: {} or more by "
        "reduction.modes",
        Phi.cols(), seen.cols(), independence, kVisible, std::max<Eigen::Index>(Phi.cols() + 1, seen.cols())));
  }
}

std::vector<std::string> amplitude_names(Eigen::Index L) {
  std::vector<std::string> names;
  for (Eigen::Index i = 1; i <= L; ++i) names.push_back(fmt::format("a{}", i));
  return names;
}

constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();

/// What is more than this share is no rounding, however soft the softest motion.
constexpr double kMostTurned = 1e-9;

/// What a projected matrix is summed from, and rounds by: |Φ|ᵀ|A||Φ|.
Eigen::MatrixXd sizes(const fem::Matrix& A, const Eigen::MatrixXd& Phi) {
  const auto magnitudes = [](const auto& m) -> fem::Matrix { return m.cwiseAbs().eval(); };
  return project(std::visit(magnitudes, A), Phi.cwiseAbs());
}

/// Motions that strain nothing, to the rounding of a projected K, and how far rounding may have turned them.
struct Unstrained {
  Eigen::MatrixXd shapes;  ///< orthonormal in M
  double turned = 0.0;
};

Unstrained unstrained(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M, const Eigen::MatrixXd& size) {
  const Eigen::MatrixXd least = static_cast<double>(K.rows()) * kRounding * size.diagonal().asDiagonal();
  if (Eigen::LLT<Eigen::MatrixXd>(K - least).info() == Eigen::Success) return {};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(K, M);
  if (modes.info() != Eigen::Success) return {};
  std::vector<Eigen::Index> found;
  double largest = 0.0, softest = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < K.rows(); ++k) {
    const Eigen::VectorXd shape = modes.eigenvectors().col(k), magnitude = shape.cwiseAbs();
    const double stiffness = shape.dot(K * shape), summed = magnitude.dot(size * magnitude);
    largest = std::max(largest, summed);
    if (std::abs(stiffness) <= kRounding * summed)
      found.push_back(k);
    else
      softest = std::min(softest, stiffness);
  }
  return {modes.eigenvectors()(Eigen::all, found), std::min(kRounding * (1.0 + largest / softest), kMostTurned)};
}

/// A with nothing left along these shapes. What no term of it couples stays apart, exactly.
/// @param size  see sizes()
Eigen::MatrixXd without(const Eigen::MatrixXd& A, const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& M,
                        const Eigen::MatrixXd& size) {
  // They are all there is: what rounding would leave has nothing beside it to be small to.
  if (shapes.cols() == A.cols()) return Eigen::MatrixXd::Zero(A.rows(), A.cols());
  const Eigen::MatrixXd inertia = M * shapes, right = A - (A * shapes) * inertia.transpose();
  return (size.array() > 0.0).select(right - inertia * (shapes.transpose() * right), 0.0);
}

/// Those of the motions, turned among themselves, that nothing damps either.
Eigen::MatrixXd undamped(const Unstrained& free, const Eigen::MatrixXd& C, const Eigen::MatrixXd& size) {
  const Eigen::MatrixXd own = free.shapes.transpose() * C * free.shapes;
  const Eigen::MatrixXd shapes =
      free.shapes * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(own + own.transpose()).eigenvectors();
  std::vector<Eigen::Index> found;
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    const double rounding = free.turned * (size * shapes.col(k).cwiseAbs()).norm();
    if ((C * shapes.col(k)).norm() <= rounding && (C.transpose() * shapes.col(k)).norm() <= rounding)
      found.push_back(k);
  }
  return shapes(Eigen::all, found);
}

/// Motions that strain nothing, and those that nothing damps, must stay such: projected matrices are rounded at the
/// size of what cancels in them, which may be far more than of their entries rounding is.
fem::Structure project_structure(const fem::Structure& full, const Eigen::MatrixXd& Phi) {
  const Eigen::MatrixXd M = project_symmetric(full.M(), Phi);
  Eigen::MatrixXd K = project_symmetric(full.K(), Phi);
  const Eigen::MatrixXd stiffness_size = sizes(full.K(), Phi);
  const Unstrained free = unstrained(K, M, stiffness_size);
  if (free.shapes.cols() > 0) {
    K = without(K, free.shapes, M, stiffness_size);
    K = (0.5 * (K + K.transpose())).eval();
  }
  const std::optional<fem::Rayleigh> rayleigh = full.rayleigh();
  if (rayleigh) return {M, *rayleigh, std::move(K), amplitude_names(Phi.cols()), full.units()};
  const bool symmetric = full.has_symmetric_damping();
  Eigen::MatrixXd C = symmetric ? project_symmetric(full.C(), Phi) : project(full.C(), Phi);
  if (free.shapes.cols() > 0) {
    const Eigen::MatrixXd damping_size = sizes(full.C(), Phi);
    C = without(C, undamped(free, C, damping_size), M, damping_size);
    if (symmetric) C = (0.5 * (C + C.transpose())).eval();
  }
  return {M, std::move(C), std::move(K), amplitude_names(Phi.cols()), full.units()};
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
