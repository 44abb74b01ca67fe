#include "dynamics/internal/pair_form.hpp"

#include <slipmode/core/coupled_parts.hpp>
#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/dense_lapack.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Above this condition number of its eigenvectors the matrix is treated as defective.
constexpr double kLargestCondition = 1e10;
/// Modes slower than this share of the fastest are scaled like it: their displacement needs no finer balance.
constexpr double kSmallestScale = 1e-8;

/// Largest error of a state that is turned into pairs and back.
constexpr double kLargestGap = 1e-7;

void check_condition(double condition) {
  if (!(condition < kLargestCondition))
    throw NumericalFailure("the damping makes two modes coincide (condition number of the eigenvectors " +
                               std::to_string(condition) +
                               ", at most 1e10 is workable): change the damping or a contact's stiffness slightly",
                           kNone, {}, condition);
}

/// A place that floats and a slow decay μ of its speed, as a mode each, would be the large summands v/μ of a small
/// displacement. As ẋ = a v, v̇ = μ v they are not. Takes out of `decaying` what is put so, `put(mode, a, summand)`: the
/// slowest whose a are apart. What of an a is along places put before goes into the mode's shape, as `summand` = that
/// over μ, if it is below one, and the place is the rest, at right angles to them; else all of a. Returns directions of
/// the places that are left, in columns.
/// @param drifts  a of every mode [places x modes]
template <class Put>
Eigen::MatrixXd put_floating(const Eigen::VectorXcd& values, const Eigen::MatrixXcd& drifts,
                             std::vector<Eigen::Index>& decaying, const Put& put) {
  constexpr double kApart = 1e-6;     // sine of the angle to those put before
  constexpr double kSlowest = 1e-30;  // of the balanced state's rates: as good as none
  const Eigen::Index places = drifts.rows();
  Eigen::MatrixXd reached(places, 0), left = Eigen::MatrixXd::Identity(places, places);
  while (reached.cols() < places) {
    double largest = 0.0;
    auto slowest = decaying.end();
    for (auto k = decaying.begin(); k != decaying.end(); ++k) {
      const Eigen::VectorXd a = drifts.col(*k).real();
      const double apart = (left.transpose() * a).norm(), size = apart / std::max(std::abs(values(*k)), kSlowest);
      if (apart <= kApart * a.norm() || size <= largest) continue;
      largest = size;
      slowest = k;
    }
    if (slowest == decaying.end()) break;
    Eigen::VectorXd a = drifts.col(*slowest).real();
    const Eigen::VectorXd own = left * (left.transpose() * a);
    Eigen::VectorXd summand = a - own;
    if (summand.norm() < std::abs(values(*slowest))) {
      summand /= values(*slowest).real();
      a = own;
    } else {
      summand.setZero();
    }
    put(*slowest, a, summand);
    decaying.erase(slowest);
    reached.conservativeResize(Eigen::NoChange, reached.cols() + 1);
    reached.rightCols<1>() = a / a.norm();
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(reached).householderQ();
    left = Q.rightCols(places - reached.cols());
  }
  return left;
}

/// `pair_form` of states that A couples.
PairForm coupled_pair_form(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows() / 2;
  PairForm form;
  for (auto* g : {&form.g11, &form.g12, &form.g21, &form.g22}) *g = Eigen::VectorXd::Zero(n);
  form.T.resize(2 * n, 2 * n);
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

  // Pairs of rows from large to small: QR then keeps the digits of the small eigenvalues. Rigid-body displacements are
  // taken out: rounding would leave their eigenvalues a little off zero.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n)), shifted, rest;
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const Eigen::VectorXd size =
      A.topRows(n).rowwise().lpNorm<Eigen::Infinity>().cwiseMax(A.bottomRows(n).rowwise().lpNorm<Eigen::Infinity>());
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) { return size(i) > size(j); });
  for (const Eigen::Index i : order) {
    (A.col(i).isZero(0.0) ? shifted : rest).push_back(i);
    rest.push_back(n + i);
  }
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(A(rest, rest)));
  if (solver.info() != Eigen::Success)
    throw NumericalFailure("eigenvalues of the damped structure did not converge", kNone, {}, kNone);
  const Eigen::VectorXcd& values = solver.eigenvalues();
  Eigen::MatrixXcd vectors = Eigen::MatrixXcd::Zero(2 * n, values.size());  // without the places of what floats
  vectors(rest, Eigen::all) = solver.eigenvectors();
  const Eigen::MatrixXcd drifts = A(shifted, rest) * vectors(rest, Eigen::all);  // how fast these move
  const auto moved = [&](Eigen::Index k) -> Eigen::VectorXcd {
    Eigen::VectorXcd vector = vectors.col(k);
    vector(shifted) = drifts.col(k) / values(k);
    return vector;
  };

  std::vector<Eigen::Index> decaying;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const auto mu = values(k);
    if (mu.imag() > 0) {
      const Eigen::VectorXcd vector = moved(k);
      put(vector.real(), vector.imag(), mu.real(), mu.imag(), -mu.imag(), mu.real());
    } else if (mu.imag() == 0) {
      decaying.push_back(k);
    }
  }
  const Eigen::MatrixXd places = put_floating(
      values, drifts, decaying, [&](Eigen::Index k, const Eigen::VectorXd& along, const Eigen::VectorXd& summand) {
        const double speed = along.norm();
        Eigen::VectorXd place = Eigen::VectorXd::Zero(2 * n), decay = vectors.col(k).real();
        place(shifted) = along / speed;
        decay(shifted) = summand;
        put(place, decay, 0.0, speed, 0.0, values(k).real());
      });

  struct Real {
    Eigen::VectorXd vector;
    double value;
  };
  std::vector<Real> reals;
  reals.reserve(decaying.size() + shifted.size());
  for (const Eigen::Index k : decaying) reals.push_back({moved(k).real(), values(k).real()});
  for (const auto& place : places.colwise()) {
    reals.push_back({Eigen::VectorXd::Zero(2 * n), 0.0});
    reals.back().vector(shifted) = place;
  }
  for (std::size_t k = 0; k + 1 < reals.size(); k += 2)
    put(reals[k].vector, reals[k + 1].vector, reals[k].value, 0.0, 0.0, reals[k + 1].value);

  const Eigen::VectorXd singular = singular_values(form.T, false).sigma;
  check_condition(singular(0) / singular(2 * n - 1));
  form.T_inverse = form.T.inverse();
  return form;
}

}  // namespace

PairForm pair_form(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows() / 2;
  PairForm form;
  for (auto* g : {&form.g11, &form.g12, &form.g21, &form.g22}) *g = Eigen::VectorXd::Zero(n);
  form.T = form.T_inverse = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (const Part& part : coupled_parts(A.topLeftCorner(n, n).cwiseAbs() + A.topRightCorner(n, n).cwiseAbs() +
                                        A.bottomLeftCorner(n, n).cwiseAbs() + A.bottomRightCorner(n, n).cwiseAbs())) {
    Part states = part;
    for (const Eigen::Index i : part) states.push_back(n + i);
    const PairForm own = coupled_pair_form(A(states, states));
    form.g11(part) = own.g11;
    form.g12(part) = own.g12;
    form.g21(part) = own.g21;
    form.g22(part) = own.g22;
    form.T(states, states) = own.T;
    form.T_inverse(states, states) = own.T_inverse;
  }
  return form;
}

void add_driven_pair(PairForm& form, const Eigen::Matrix2d& A, const Eigen::MatrixXd& B) {
  const Eigen::Index n = form.g11.size();
  const PairForm own = pair_form(A);
  // X with [x; X x] the motion of the pair under each of the others: A X − X G = −B T, two columns at a time.
  const Eigen::MatrixXd BT = B * form.T;
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(2, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector4d driven(BT(0, i), BT(1, i), BT(0, n + i), BT(1, n + i));
    if (driven.isZero(0.0)) continue;
    Eigen::Matrix4d S = Eigen::Matrix4d::Zero();
    S.topLeftCorner<2, 2>() = S.bottomRightCorner<2, 2>() = A;
    S.diagonal() -= Eigen::Vector4d(form.g11(i), form.g11(i), form.g22(i), form.g22(i));
    S.topRightCorner<2, 2>().diagonal().array() -= form.g21(i);
    S.bottomLeftCorner<2, 2>().diagonal().array() -= form.g12(i);
    const Eigen::JacobiSVD<Eigen::Matrix4d> svd(S, Eigen::ComputeFullU | Eigen::ComputeFullV);
    check_condition(svd.singularValues()(0) / svd.singularValues()(3));
    const Eigen::Vector4d x = -svd.matrixV() * (svd.matrixU().transpose() * driven).cwiseQuotient(svd.singularValues());
    for (Eigen::Index k = 0; k < 2; ++k) {
      X(k, i) = x(k);
      X(k, n + i) = x(k + 2);
    }
  }
  // The new states stand behind the first ones and behind the second ones.
  const auto widened = [n](const Eigen::MatrixXd& old, const Eigen::MatrixXd& rows, const Eigen::Matrix2d& corner) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * n + 2, 2 * n + 2);
    const auto of = [n](Eigen::Index k) { return k < n ? k : k + 1; };
    for (Eigen::Index j = 0; j < 2 * n; ++j) {
      for (Eigen::Index i = 0; i < 2 * n; ++i) out(of(i), of(j)) = old(i, j);
      out(n, of(j)) = rows(0, j);
      out(2 * n + 1, of(j)) = rows(1, j);
    }
    const std::array<Eigen::Index, 2> last{n, 2 * n + 1};
    out(last, last) = corner;
    return out;
  };
  form.T = widened(form.T, X, own.T);
  form.T_inverse = widened(form.T_inverse, -own.T_inverse * X * form.T_inverse, own.T_inverse);
  const auto append = [n](Eigen::VectorXd& g, const Eigen::VectorXd& value) {
    g.conservativeResize(n + 1);
    g(n) = value(0);
  };
  append(form.g11, own.g11);
  append(form.g12, own.g12);
  append(form.g21, own.g21);
  append(form.g22, own.g22);
}

void check_pair_form(const PairForm& form, const Eigen::VectorXd& scale) {
  const Eigen::Index n = scale.size();
  const double fastest = scale.maxCoeff();
  Eigen::MatrixXd gap = form.T * form.T_inverse - Eigen::MatrixXd::Identity(2 * n, 2 * n);
  gap.topRows(n).array().colwise() *= fastest / scale.array();
  gap.leftCols(n).array().rowwise() *= scale.transpose().array() / fastest;
  const double error = gap.cwiseAbs().maxCoeff();
  if (!(error <= kLargestGap))
    throw NumericalFailure(
        fmt::format(
            "modes of the damped structure give a state back with an error of {:.2g}, at most {:.0g} is workable: "
            "parts that float and hardly feel their damping; remove what no force reaches, or damp or hold it "
            "more",
            error, kLargestGap),
        kNone, {}, error);
}

BalancedState balanced_state(const Eigen::VectorXd& omega, const Eigen::MatrixXd& damping,
                             const Eigen::VectorXd& coupling, double beside) {
  const Eigen::Index n = omega.size();
  const Eigen::VectorXd rate = coupling.size() > 0 ? Eigen::VectorXd(omega.cwiseMax(coupling)) : omega;
  const double fastest = std::max({rate.maxCoeff(), damping.diagonal().maxCoeff(), beside});
  const double least = fastest > 0.0 ? kSmallestScale * fastest : 1.0;  // what floats beside nothing has no rate at all
  BalancedState state{rate.cwiseMax(least), Eigen::MatrixXd::Zero(2 * n, 2 * n)};
  state.A.topRightCorner(n, n).diagonal() = state.scale;
  state.A.bottomLeftCorner(n, n).diagonal() = -omega.cwiseAbs2().cwiseQuotient(state.scale);
  state.A.bottomRightCorner(n, n) = -damping;
  return state;
}

}  // namespace slipmode::dynamics
