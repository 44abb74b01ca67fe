#pragma once

#include <slipmode/dynamics/regime.hpp>

#include <Eigen/Core>

namespace slipmode::dynamics {

/// Of free motion ẋ_f = G x_f in a regime: ∫ x_fᵀQ x_f dt = [x_fᵀY x_f] with GᵀY + YG = Q, for the contacts' work and
/// the viscous loss. Made when first asked for; where none is `found`, an integral has no such form. Source:
/// docs/theory/compliant-contacts.md, section 4.
[[nodiscard]] const RegimeForms& quadratic_forms(const RegimeTables& tables, const ModalModel& slipping);

/// Whether each pair decays fast enough for its forms to keep their digits. @param rate  decays are compared with
/// [1/s]; 0: each with its pair's own
[[nodiscard]] bool decays(const ModalModel& pairs, double rate);

/// xᵀY x by Y's lower triangle, off-diagonal entries doubled.
[[nodiscard]] double quadratic(const Eigen::MatrixXd& Y, const Eigen::VectorXd& x);

/// Energy of free motion, contacts' springs included [J]. @param lifted  its state in the slipping model
[[nodiscard]] double free_energy(const Regime& regime, const ModalModel& slipping, const Eigen::VectorXd& lifted,
                                 const Eigen::VectorXd& free);

/// Block i of G.
[[nodiscard]] Eigen::Matrix2d block(const ModalModel& pairs, Eigen::Index i);

}  // namespace slipmode::dynamics
