#pragma once

#include "core/v8.hpp"
#include "dynamics/step_tables.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

/// The inner loops of the collocation flow: fixed-size products on eight lanes, no allocation.
namespace slipmode::dynamics {

/// aᵀb over `size` entries, a multiple of 8, both aligned.
[[gnu::always_inline]] inline double dot_padded(const double* a, const double* b, Eigen::Index size) {
  V8 sum{};
  for (Eigen::Index i = 0; i < size; i += kLanes) sum += load8(a + i) * load8(b + i);
  return sum8(sum);
}

/// Σ_i column_i x_i for `count` columns of eight lanes.
[[gnu::always_inline]] inline V8 node_sums(const double* columns, const double* x, Eigen::Index count) {
  V8 a{}, b{}, c{}, d{};
  Eigen::Index i = 0;
  for (; i + 4 <= count; i += 4) {
    a += load8(columns + kLanes * i) * x[i];
    b += load8(columns + kLanes * (i + 1)) * x[i + 1];
    c += load8(columns + kLanes * (i + 2)) * x[i + 2];
    d += load8(columns + kLanes * (i + 3)) * x[i + 3];
  }
  for (; i < count; ++i) a += load8(columns + kLanes * i) * x[i];
  return (a + b) + (c + d);
}

/// y = A x for a column-major 8 x 8 matrix.
[[gnu::always_inline]] inline V8 matrix8_times(const double* A, const double* x) {
  V8 a = load8(A) * x[0], b = load8(A + 8) * x[1], c = load8(A + 16) * x[2], d = load8(A + 24) * x[3];
  a += load8(A + 32) * x[4];
  b += load8(A + 40) * x[5];
  c += load8(A + 48) * x[6];
  d += load8(A + 56) * x[7];
  return (a + b) + (c + d);
}

/// Below this ratio a Neumann series is shorter than elimination.
inline constexpr double kSmallRatio = 0.15;

/// Solves (I − A diag(d)) δ = r by Gauss-Jordan elimination over the lanes, or by a short Neumann series where A
/// diag(d) is small. False when a pivot vanishes.
/// @param norm      largest row sum of |A|
/// @param accuracy  relative error of δ that is allowed
[[gnu::always_inline]] inline bool solve_newton(const double* A, double norm, double accuracy, const V8& d, const V8& r,
                                                V8& out_delta) {
  alignas(64) double scaled[kNodes];
  const double ratio = max8(abs8(d)) * norm;
  if (ratio < kSmallRatio) {
    // δ = r + B(r + B(r + …)), B = A diag(d).
    V8 delta = r;
    for (double left = ratio; left > accuracy; left *= ratio) {
      store8(scaled, d * delta);
      delta = r + matrix8_times(A, scaled);
    }
    out_delta = delta;
    return true;
  }
  V8 column[kNodes + 1];
  alignas(64) double slope[kNodes];
  store8(slope, d);
  for (int j = 0; j < kNodes; ++j) {
    column[j] = -load8(A + kNodes * j) * slope[j];
    column[j][j] += 1.0;
  }
  column[kNodes] = r;
  // Two pivots at a time: the elimination is bound by the latency from one reciprocal to the next.
#pragma GCC unroll 4
  for (int k = 0; k < kNodes; k += 2) {
    V8 a = column[k], b = column[k + 1];
    const double a0 = a[k], a1 = a[k + 1], b0 = b[k], b1 = b[k + 1];
    const double determinant = a0 * b1 - a1 * b0;
    if (!(std::abs(determinant) > 1e-14)) return false;
    const double inverse = 1.0 / determinant;
    a[k] -= 1.0;
    b[k + 1] -= 1.0;
    const V8 first = (a * b1 - b * a1) * inverse, second = (b * a0 - a * b0) * inverse;
#pragma GCC unroll 9
    for (int j = k + 2; j <= kNodes; ++j) column[j] -= first * column[j][k] + second * column[j][k + 1];
  }
  out_delta = column[kNodes];
  return true;
}

/// Whether the constant load acts: on states it does, on their differences (tangent vectors) it does not.
enum class Load : bool { kLeftOut, kIncluded };

/// out = e^{Gh} x + load + response · forces.
template <Load load = Load::kIncluded>
void propagate(const Propagator& p, const double* x, const double* forces, int contacts, Eigen::Index np,
               double* out_x);

/// Below this phase (fastest rate times time) a Taylor series of twelve terms is exact to rounding.
inline constexpr double kTaylorPhase = 0.25;

/// Walks [0, tau] of a step of tabulated size in pieces that are tabulated steps too, halving down the table, until
/// what is left is short enough for a Taylor series.
/// @param whole  whole(level, forces): a tabulated step with these node values of the forces
/// @param rest   rest(level, forces, tau): the first tau of a tabulated step; last, not called when nothing is left
template <class Whole, class Rest>
void walk_pieces(const StepTables& tables, const double* forces, int level, double tau, Whole whole, Rest rest) {
  const int nc = tables.model().contacts;
  const auto map_nodes = [nc](const RadauTables::Matrix8& matrix, const double* from, double* to) {
    for (int c = 0; c < nc; ++c) store8(to + kNodes * c, matrix8_times(matrix.data(), from + kNodes * c));
  };
  alignas(64) double stack_forces[2 * kNodes * 4];
  Eigen::VectorXd heap;
  double* current = stack_forces;
  if (nc > 4) {
    heap.resize(2 * kNodes * nc);
    current = heap.data();
  }
  double* other = current + kNodes * nc;
  std::copy_n(forces, kNodes * nc, current);
  const RadauTables& nodes = radau();
  for (double h = tables.step(level); tau > 0.0; std::swap(current, other)) {
    if (tau >= h) return whole(level, current);
    if (tables.model().fastest * tau <= kTaylorPhase || level + 1 == StepTables::kLevels)
      return rest(level, current, tau);
    ++level;
    h /= 2.0;
    if (tau >= h) {
      map_nodes(nodes.left_half, current, other);
      whole(level, other);
      tau -= h;
      map_nodes(nodes.right_half, current, other);
    } else {
      map_nodes(nodes.left_half, current, other);
    }
  }
}

/// State at tau within a step of tabulated size whose forces are polynomials through the nodes.
template <Load load = Load::kIncluded>
void advance_within(const StepTables& tables, const double* x, const double* forces, int level, double tau,
                    double* out_x);

/// ∫ q̇ᵀCq̇ dt over a step, from the modal velocities at the points of the table's rule.
double viscous_loss(const StepTables& tables, int level, const double* x, const double* forces);

}  // namespace slipmode::dynamics
