#pragma once

#include <slipmode/dynamics/modal_model.hpp>

#include <Eigen/Core>

namespace slipmode::dynamics {

/// (iω − G)⁻¹ of a model's pairs on columns of inputs [2np x m]: rows of the model times it are receptances,
/// uᵀ(iω − G)⁻¹b = uᵀ(K + iωC − ω²M)⁻¹b of the structure. On a natural frequency without damping a pair's answer has no
/// bound, though contacts may give it one: it is taken next to it, half of 1.5e-8 of ω away, where that and what
/// rounding takes of contacts' small differences weigh the same. Cost O(n m).
/// @param omega  > 0 [rad/s]
[[nodiscard]] Eigen::MatrixXcd pair_receptances(const ModalModel& model, double omega, const Eigen::MatrixXcd& inputs);

}  // namespace slipmode::dynamics
