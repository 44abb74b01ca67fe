#include "dynamics/pair_form.hpp"

#include "core/decompositions.hpp"
#include "core/errors.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Above this condition number of its eigenvectors the matrix is treated as defective.
constexpr double kLargestCondition = 1e10;
/// Modes slower than this share of the fastest are scaled like it: their displacement needs no finer balance.
constexpr double kSmallestScale = 1e-8;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PairForm pair_form(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows() / 2;
  // Pairs of rows from large to small: QR then keeps the digits of the small eigenvalues.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n)), rows;
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const Eigen::VectorXd size =
      A.topRows(n).rowwise().lpNorm<Eigen::Infinity>().cwiseMax(A.bottomRows(n).rowwise().lpNorm<Eigen::Infinity>());
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) { return size(i) > size(j); });
  for (const Eigen::Index i : order) rows.insert(rows.end(), {i, n + i});
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(A(rows, rows)));
  if (solver.info() != Eigen::Success)
    throw NumericalFailure("eigenvalues of the damped structure did not converge", kNaN, {}, kNaN);
  PairForm form;
  for (auto* g : {&form.g11, &form.g12, &form.g21, &form.g22}) *g = Eigen::VectorXd::Zero(n);
  form.T.resize(2 * n, 2 * n);
  const auto& values = solver.eigenvalues();
  Eigen::MatrixXcd vectors(2 * n, 2 * n);
  vectors(rows, Eigen::all) = solver.eigenvectors();
  Eigen::Index pair = 0;
  const auto put = [&](const Eigen::VectorXd& first, const Eigen::VectorXd& second, double a, double b, double c,
                       double d) {
    form.T.col(pair) = first;
    form.T.col(n + pair) = second;
    form.g11(pair) = a;
    form.g12(pair) = b;
    form.g21(pair) = c;
    form.g22(pair) = d;
    ++pair;
  };
  std::optional<Eigen::Index> unpaired_real;
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    const auto mu = values(k);
    if (mu.imag() > 0) {
      put(vectors.col(k).real(), vectors.col(k).imag(), mu.real(), mu.imag(), -mu.imag(), mu.real());
    } else if (mu.imag() == 0 && unpaired_real) {
      const auto j = *unpaired_real;
      put(vectors.col(j).real(), vectors.col(k).real(), values(j).real(), 0.0, 0.0, mu.real());
      unpaired_real.reset();
    } else if (mu.imag() == 0) {
      unpaired_real = k;
    }
  }
  const Eigen::VectorXd singular = Eigen::BDCSVD<Eigen::MatrixXd>(form.T).singularValues();
  const double condition = singular(0) / singular(2 * n - 1);
  if (!(condition < kLargestCondition))
    throw NumericalFailure("the damping makes two modes coincide (condition number of the eigenvectors " +
                               std::to_string(condition) +
                               ", at most 1e10 is workable): change the damping or a contact's stiffness slightly",
                           kNaN, {}, condition);
  form.T_inverse = form.T.inverse();
  return form;
}

BalancedState balanced_state(const Eigen::VectorXd& omega, const Eigen::MatrixXd& damping) {
  const Eigen::Index n = omega.size();
  const double fastest = std::max({omega.maxCoeff(), damping.diagonal().maxCoeff(), 1e-300});
  BalancedState state{omega.cwiseMax(kSmallestScale * fastest), Eigen::MatrixXd::Zero(2 * n, 2 * n)};
  state.A.topRightCorner(n, n).diagonal() = state.scale;
  state.A.bottomLeftCorner(n, n).diagonal() = -omega.cwiseAbs2().cwiseQuotient(state.scale);
  state.A.bottomRightCorner(n, n) = -damping;
  return state;
}

}  // namespace slipmode::dynamics
