#pragma once

#include <Eigen/Core>

namespace slipmode::dynamics {

/// A real matrix of even size as independent 2 x 2 blocks: A T = T G. A conjugate pair of eigenvalues σ ± iw gives the
/// block [σ w; −w σ], two real ones a diagonal block: in these coordinates free motion grows by e^{σt} and no more.
/// Rigid-body displacements, whose columns of A are zero, give eigenvalues that are 0 exactly, in one
/// block [0 s; 0 μ] with a decay μ of their speed, which may be 0. Block i acts on columns i and n + i of T.
struct PairForm {
  Eigen::VectorXd g11, g12, g21, g22;  ///< blocks [n]
  Eigen::MatrixXd T, T_inverse;        ///< [2n x 2n]
};

/// @param A  2n x 2n, balanced: its entries should be of the size of its eigenvalues
/// @throws NumericalFailure  when A is close to defective (condition number of the eigenvectors above 1e10) or the
///                           iteration does not converge
[[nodiscard]] PairForm pair_form(const Eigen::MatrixXd& A);

/// Adds a pair that the others drive and that does not act back, ż = A z + B x, as the last first and the last second
/// state. By itself: in one matrix with the others it would split a rigid-body motion into two slow exponentials.
/// @param form  of A_x, may be empty  @param B  [2 x 2n]
/// @throws NumericalFailure  when the pair resonates with another that drives it, or is critically damped
void add_driven_pair(PairForm& form, const Eigen::Matrix2d& A, const Eigen::MatrixXd& B);

/// State matrix [0 diag(ω); −diag(ω) −D] of the balanced state (ω η, η̇); rigid-body modes (ω = 0) use the smallest
/// scale that keeps it balanced.
struct BalancedState {
  Eigen::VectorXd scale;  ///< of η [n]
  Eigen::MatrixXd A;      ///< [2n x 2n]
};
/// @param coupling  rates by which other terms, still to be put into A, act on the displacements [n], or empty: a scale
///                  is at least that, or those terms would be large over a small scale
/// @param beside    fastest rate of pairs that are added later
[[nodiscard]] BalancedState balanced_state(const Eigen::VectorXd& omega, const Eigen::MatrixXd& damping,
                                           const Eigen::VectorXd& coupling = {}, double beside = 0.0);

/// Checks that a state turned into pairs and back is the same state.
/// @param scale  of the displacements in the balanced state [n]
/// @throws NumericalFailure  with the error: displacements and velocities over the fastest rate, relative
void check_pair_form(const PairForm& form, const Eigen::VectorXd& scale);

}  // namespace slipmode::dynamics
