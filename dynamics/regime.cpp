#include <slipmode/dynamics/regime.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/kernels/kernels.hpp>
#include "dynamics/internal/regime_build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// Frequencies below this share of the structure's fastest may be rounding of zero: a rigid-body motion.
constexpr double kPerhapsZero = 1e-12;
/// What sums of products round by, of their sizes.
constexpr double kNone = 64.0 * std::numeric_limits<double>::epsilon();
/// Of a state, that need no heap.
constexpr Eigen::Index kFewComponents = 64;

}  // namespace

Regime::Regime(const HybridSystem& system, const ModalModel& slipping, const std::vector<ContactRole>& contact_roles) {
  RegimeBuilder builder(system, slipping, contact_roles);
  builder.fill(*this);
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const double determinant = std::abs(pairs.g11(i) * pairs.g22(i) - pairs.g12(i) * pairs.g21(i));
    told_from_rounding &= std::sqrt(determinant) > kPerhapsZero * slipping.fastest;
  }
  motion = PairMotion(pairs, kPerhapsZero * slipping.fastest);
  rate = pairs.fastest > 0 ? pairs.fastest : slipping.fastest;
  if (slipping.floats()) rate = std::max(rate, slipping.pace());

  row1 = row;
  coefficient1 = coefficient;
  const auto derive = [&](Eigen::MatrixXd& rows, Eigen::MatrixXd& coefficients) {
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
      Eigen::VectorXd r = rows.col(c), k = coefficients.col(c);
      differentiate(r, k);
      rows.col(c) = r;
      coefficients.col(c) = k;
    }
  };
  derive(row1, coefficient1);
  row2 = row1;
  coefficient2 = coefficient1;
  derive(row2, coefficient2);
  prepare_bounds();
  builder.make_steady_forces(*this);
  prepare_lift(slipping);
}

void Regime::prepare_lift(const ModalModel& slipping) {
  if (!slipping.proportional || pairs.n == 0) return;
  const auto np = pairs.np, ns = slipping.np;
  const Eigen::MatrixXd rows = to_slipping.topRows(ns);
  Eigen::MatrixXd rates(ns, 2 * np);
  rates.leftCols(np) = rows.leftCols(np) * pairs.g11.asDiagonal();
  rates.leftCols(np) += rows.rightCols(np) * pairs.g21.asDiagonal();
  rates.rightCols(np) = rows.leftCols(np) * pairs.g12.asDiagonal();
  rates.rightCols(np) += rows.rightCols(np) * pairs.g22.asDiagonal();
  for (Eigen::Index j = 0; j < 2 * np; ++j) {
    const auto own = to_slipping.col(j).tail(ns);
    // A pair's coordinates are as large as its rate times a place: behind a stiff spring, far from the origin, they
    // would make a speed of what rows round by.
    if (!((rates.col(j) - own).norm() * pair_rate(j % np) <= kNone * slipping.fastest)) return;
  }
  to_displacements = rows;
}

void Regime::lift(const Eigen::VectorXd& x, const Eigen::VectorXd& inputs, Eigen::VectorXd& out_slipping) const {
  const kernels::Kernels& vector = kernels::kernels();
  const auto size = to_slipping.rows();
  out_slipping.setZero(size);
  if (to_displacements.size() == 0) {
    vector.product(to_slipping.data(), size, to_slipping.cols(), x.data(), out_slipping.data());
  } else {
    const auto np = pairs.np;
    alignas(64) std::array<double, kFewComponents> few;
    Eigen::VectorXd many;
    if (2 * np > kFewComponents) many.resize(2 * np);
    Eigen::Map<Eigen::VectorXd> moving(2 * np > kFewComponents ? many.data() : few.data(), 2 * np);
    moving.head(np) = pairs.g11.cwiseProduct(x.head(np)) + pairs.g12.cwiseProduct(x.tail(np));
    moving.tail(np) = pairs.g21.cwiseProduct(x.head(np)) + pairs.g22.cwiseProduct(x.tail(np));
    vector.two_products(to_displacements.data(), size / 2, 2 * np, x.data(), moving.data(), out_slipping.data(),
                        out_slipping.data() + size / 2);
  }
  vector.product(inputs_slipping.data(), size, inputs_slipping.cols(), inputs.data(), out_slipping.data());
}

void Regime::prepare_bounds() {
  const auto np = pairs.np, no = row.cols(), V = speed_input(), a = V + 1;
  scale1 = scale2 = pair_rate = Eigen::VectorXd::Zero(np);
  particular = Eigen::MatrixXd::Zero(2 * np, inputs());
  Eigen::MatrixXd polynomial_row = row;  // of components without scale
  weight = Eigen::MatrixXd::Zero(np, no);
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    Eigen::Matrix2d G;
    G << pairs.g11(i), pairs.g12(i), pairs.g21(i), pairs.g22(i);
    double lag = 0.0;  // of a damped rigid-body motion: x₁ + lag x₂ merely integrates the inputs
    if (pairs.proportional) {
      scale1(i) = pairs.omega(i);
      scale2(i) = pairs.omega(i) > 0 || pairs.damping(i) > 0 ? 1.0 : 0.0;
      pair_rate(i) = pairs.damping(i) / 2.0 + std::hypot(pairs.omega(i), pairs.damping(i) / 2.0);
    } else {
      const bool oscillates = pairs.g21(i) != 0.0;
      scale1(i) = oscillates || pairs.g11(i) != 0.0 ? 1.0 : 0.0;
      scale2(i) = oscillates || pairs.g22(i) != 0.0 ? 1.0 : 0.0;
      pair_rate(i) = oscillates ? std::hypot(pairs.g11(i), pairs.g12(i))
                                : std::max(std::abs(pairs.g11(i)), std::abs(pairs.g22(i)));
      growth = std::max({growth, pairs.g11(i), pairs.g22(i)});
    }
    if (scale1(i) == 0.0 && scale2(i) > 0.0) lag = -G(0, 1) / G(1, 1);
    // x_p = −G⁻¹ f − G⁻² ḟ − G⁻³ f̈ with f = B ι, ḟ = B_follows V + B_V a, f̈ = B_follows a.
    Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
    if (scale1(i) > 0 && scale2(i) > 0)
      inverse = G.inverse();
    else if (scale2(i) > 0)
      inverse(1, 1) = 1.0 / G(1, 1);
    else if (scale1(i) > 0)
      inverse(0, 0) = 1.0 / G(0, 0);
    const auto pair_of = [&](const auto& column) { return Eigen::Vector2d(column(i), column(np + i)); };
    const auto put = [&](Eigen::Index k, const Eigen::Vector2d& value) {
      particular(i, k) += value(0);
      particular(np + i, k) += value(1);
    };
    for (Eigen::Index k = 0; k < inputs(); ++k) put(k, -inverse * pair_of(B.col(k)));
    const Eigen::Vector2d held = pair_of(B_follows);
    put(V, -inverse * inverse * held);
    put(a, -inverse * inverse * pair_of(B.col(V)) - inverse * inverse * inverse * held);
    for (Eigen::Index c = 0; c < no; ++c) {
      weight(i, c) = std::hypot(scale1(i) > 0 ? row(i, c) / scale1(i) : 0.0,
                                scale2(i) > 0 ? (row(np + i, c) - lag * row(i, c)) / scale2(i) : 0.0);
      if (scale1(i) > 0) polynomial_row(i, c) = 0.0;
      if (scale2(i) > 0) polynomial_row(np + i, c) = lag * row(i, c);
    }
  }
  weight2 = pair_rate.cwiseAbs2().asDiagonal() * weight;
  weight3 = pair_rate.asDiagonal() * weight2;
  polynomial2 = polynomial3 = Eigen::MatrixXd::Zero(inputs(), no);
  for (Eigen::Index c = 0; c < no; ++c) {
    // What follows the inputs at once, and the components that merely integrate them.
    Eigen::VectorXd r = polynomial_row.col(c);
    Eigen::VectorXd k = coefficient.col(c) + particular.transpose() * (row.col(c) - r);
    differentiate(r, k);
    differentiate(r, k);
    polynomial2.col(c) = k;
    differentiate(r, k);
    polynomial3.col(c) = k;
  }
}

void Regime::advance_inputs(Eigen::VectorXd& inputs, double t) const {
  const Eigen::Index V = speed_input();
  const double way = t * (inputs(V) + 0.5 * t * inputs(V + 1));
  for (std::size_t c = 0; c < follows.size(); ++c)
    if (follows[c]) inputs(static_cast<Eigen::Index>(c)) += way;
  inputs(V) += t * inputs(V + 1);
}

double Regime::output(Eigen::Index k, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) const {
  return kernels::kernels().dot(row.col(k).data(), x.data(), x.size()) + coefficient.col(k).dot(inputs);
}

double Regime::held_force(Eigen::Index c, const Eigen::VectorXd& inputs) const {
  const double way = sticks(static_cast<int>(c)) ? inputs(c) : 0.0;
  double sum = steady_together(c) * way;
  for (Eigen::Index k = 0; k < inputs.size(); ++k)
    sum += steady_force(k, c) * (k < speed_input() && sticks(static_cast<int>(k)) ? inputs(k) - way : inputs(k));
  return sum;
}

void Regime::differentiate(Eigen::VectorXd& r, Eigen::VectorXd& k) const {
  const auto np = pairs.np;
  const Eigen::Index V = speed_input();
  // What an input does not move at once, it moves by what modes round by, beside which all else is nothing in a motion
  // that has just begun.
  Eigen::VectorXd next = B.transpose() * r;
  const double first = r.head(np).norm(), second = r.tail(np).norm();
  for (Eigen::Index i = 0; i < next.size(); ++i) {
    const auto of = B.col(i);
    if (std::abs(next(i)) <= kNone * (of.head(np).norm() * first + of.tail(np).norm() * second)) next(i) = 0.0;
  }
  for (std::size_t c = 0; c < follows.size(); ++c)
    if (follows[c]) next(V) += k(static_cast<Eigen::Index>(c));
  next(V + 1) += k(V);
  k = next;
  Eigen::VectorXd out(2 * np);
  out.head(np) = pairs.g11.cwiseProduct(r.head(np)) + pairs.g21.cwiseProduct(r.tail(np));
  out.tail(np) = pairs.g12.cwiseProduct(r.head(np)) + pairs.g22.cwiseProduct(r.tail(np));
  r = out;
}

double Regime::viscous_power(const Eigen::VectorXd& x, double drive_velocity) const {
  const double own = pairs.n > 0 ? pairs.viscous_power(x) : 0.0;
  return own + drive_velocity * (2.0 * viscous_cross.dot(x) + drive_velocity * viscous_drive);
}

}  // namespace slipmode::dynamics
