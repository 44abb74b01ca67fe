// Built once for every width: see CMakeLists.txt beside it.

#include "core/kernels/internal/kernel_set.hpp"
#include "core/kernels/internal/lanes.hpp"

namespace slipmode::kernels::SLIPMODE_KERNEL_SET {
namespace {

constexpr int kNodes = 8;
constexpr int kNewtonLimit = 12;
/// Below this ratio a Neumann series is shorter than elimination.
constexpr double kSmallRatio = 0.15;
/// Further changes with the first one's inverse are made as long as each is this much smaller than the last.
constexpr double kChordRatio = 0.05;
/// A trial may follow the law past zero sliding speed this far, in units of 1/α; beyond, e^{−αs} runs away.
constexpr double kClip = -1.4;
/// Speeds that change by less than this, in units of 1/α, leave the law's slopes what they were.
constexpr double kSameSlope = 0.1;
/// Changes below this share of the speeds at play are rounding.
constexpr double kUnmoved = 1e-14;
constexpr double kSingular = 1e-14;
/// What the solution of a step's Newton equations may leave of the right side.
constexpr double kSolved = 1e-8;

alignas(64) constexpr double kUnit[kNodes][kNodes] = {
    {1, 0, 0, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0},
    {0, 0, 0, 0, 1, 0, 0, 0}, {0, 0, 0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 1}};

SLIPMODE_LANES_INLINE V8 sum_columns(const double* columns, const double* x, Index count, V8 start) {
  V8 a = start, b = broadcast8(0.0), c = b, d = b;
  Index i = 0;
  for (; i + 4 <= count; i += 4, columns += 4 * kLanes) {
    a = fma8(load8(columns), broadcast8(x[i]), a);
    b = fma8(load8(columns + kLanes), broadcast8(x[i + 1]), b);
    c = fma8(load8(columns + 2 * kLanes), broadcast8(x[i + 2]), c);
    d = fma8(load8(columns + 3 * kLanes), broadcast8(x[i + 3]), d);
  }
  for (; i < count; ++i, columns += kLanes) a = fma8(load8(columns), broadcast8(x[i]), a);
  return (a + b) + (c + d);
}

/// The same over the n pairs of a state, without its padding.
SLIPMODE_LANES_INLINE V8 sum_pairs(const double* columns, const double* x, Index n, Index np, V8 start) {
  return sum_columns(columns + kLanes * np, x + np, n, sum_columns(columns, x, n, start));
}

SLIPMODE_LANES_INLINE V8 matrix_times(const double* A, const double* x) {
  V8 a = load8(A) * broadcast8(x[0]), b = load8(A + 8) * broadcast8(x[1]);
  V8 c = load8(A + 16) * broadcast8(x[2]), d = load8(A + 24) * broadcast8(x[3]);
  a = fma8(load8(A + 32), broadcast8(x[4]), a);
  b = fma8(load8(A + 40), broadcast8(x[5]), b);
  c = fma8(load8(A + 48), broadcast8(x[6]), c);
  d = fma8(load8(A + 56), broadcast8(x[7]), d);
  return (a + b) + (c + d);
}

SLIPMODE_LANES_INLINE V8 matrix_times(const double* A, V8 x) {
  alignas(64) double lanes[kNodes];
  store8(lanes, x);
  return matrix_times(A, lanes);
}

/// (I − A diag(d))⁻¹ = diag(1/scale) columns, by elimination two columns at a time without a division: what a pair of
/// columns is divided by is kept for each row.
struct Inverse {
  V8 column[kNodes];
  V8 over_scale;

  SLIPMODE_LANES_INLINE V8 times(const Inverse& of, V8 r) {
    V8 a = of.column[0] * splat<0>(r), b = of.column[1] * splat<1>(r);
    V8 c = of.column[2] * splat<2>(r), d = of.column[3] * splat<3>(r);
    a = fma8(of.column[4], splat<4>(r), a);
    b = fma8(of.column[5], splat<5>(r), b);
    c = fma8(of.column[6], splat<6>(r), c);
    d = fma8(of.column[7], splat<7>(r), d);
    return ((a + b) + (c + d)) * of.over_scale;
  }
};

template <int k, int j>
SLIPMODE_LANES_INLINE void eliminate_from(V8 (&column)[kNodes], V8 determinant, V8 first, V8 second) {
  if constexpr (j < kNodes) {
    if constexpr (j != k && j != k + 1) {
      const V8 on_first = splat<k>(column[j]), on_second = splat<k + 1>(column[j]);
      column[j] = fnma8(second, on_second, fnma8(first, on_first, determinant * column[j]));
    }
    eliminate_from<k, j + 1>(column, determinant, first, second);
  }
}

/// @param scale      of each row; @param untouched  that of the rows of this and later pairs
template <int k>
SLIPMODE_LANES_INLINE void eliminate(V8 (&column)[kNodes], V8& scale, V8 untouched, V8& smallest) {
  if constexpr (k < kNodes) {
    const V8 a = column[k], b = column[k + 1], unit_a = load8(kUnit[k]), unit_b = load8(kUnit[k + 1]);
    const V8 a0 = splat<k>(a), a1 = splat<k + 1>(a), b0 = splat<k>(b), b1 = splat<k + 1>(b);
    const V8 determinant = fnma8(a1, b0, a0 * b1);
    const V8 less_a = a - unit_a, less_b = b - unit_b;
    const V8 first = fnma8(less_b, a1, less_a * b1), second = fnma8(less_a, b0, less_b * a0);
    eliminate_from<k, 0>(column, determinant, first, second);
    column[k] = untouched * (determinant * unit_a - first);
    column[k + 1] = untouched * (determinant * unit_b - second);
    // Rows of the pair take its determinant for their scale, all others are multiplied by it.
    const V8 pair = unit_a + unit_b;
    scale = determinant * (fnma8(pair, scale, scale) + pair);
    smallest = min8(smallest, abs8(determinant));
    eliminate<k + 2>(column, scale, untouched * determinant, smallest);
  }
}

/// False when a pivot vanishes.
SLIPMODE_LANES_INLINE bool invert(const double* A, V8 d, Inverse& out) {
  alignas(64) double slope[kNodes];
  store8(slope, d);
  for (int j = 0; j < kNodes; ++j) out.column[j] = fnma8(load8(A + kNodes * j), broadcast8(slope[j]), load8(kUnit[j]));
  const V8 one = broadcast8(1.0);
  V8 scale = one, smallest = one;
  eliminate<0>(out.column, scale, one, smallest);
  out.over_scale = one / scale;
  return least(smallest) > kSingular;
}

SLIPMODE_LANES_INLINE V8 free_velocity(const Trial& t) { return sum_pairs(t.free, t.x, t.n, t.np, load8(t.load)); }

}  // namespace

double dot(const double* a, const double* b, Index size) {
  V8 first = broadcast8(0.0), second = first;
  Index i = 0;
  for (; i + 2 * kLanes <= size; i += 2 * kLanes) {
    first = fma8(load8(a + i), load8(b + i), first);
    second = fma8(load8(a + i + kLanes), load8(b + i + kLanes), second);
  }
  if (i < size) first = fma8(load8(a + i), load8(b + i), first);
  return sum8(first + second);
}

double product_integral(const ProductRule& rule, const double* a, const double* b, double b_start) {
  const V8 of_a = load8(a), of_b = load8(b);
  const double by_nodes = sum8((load8(rule.weight) * of_a) * of_b);
  return by_nodes + sum8(load8(rule.last_of_a) * of_a) * (b_start - sum8(load8(rule.start_of_b) * of_b));
}

void add_scaled(double a, const double* x, double* y, Index size) {
  const V8 factor = broadcast8(a);
  for (Index i = 0; i < size; i += kLanes) store8(y + i, fma8(factor, load8(x + i), load8(y + i)));
}

void node_sums(const double* columns, const double* x, Index count, const double* start, double* out) {
  store8(out, sum_columns(columns, x, count, start != nullptr ? load8(start) : broadcast8(0.0)));
}

void matrix8(const double* A, const double* x, double* out) { store8(out, matrix_times(A, x)); }

bool solve_nodes(const double* A, const double* d, const double* r, double* out_delta) {
  Inverse inverse;
  const V8 slope = load8(d), right = load8(r);
  if (!invert(A, slope, inverse)) return false;
  const V8 delta = Inverse::times(inverse, right);
  store8(out_delta, delta);
  // Without pivots, where A d is large and negative, elimination may leave no digit.
  const V8 left = delta - matrix_times(A, slope * delta) - right;
  return largest(abs8(left)) <= kSolved * largest(abs8(right));
}

bool solve_stribeck(const Trial& t) {
  const V8 free = free_velocity(t), drive = load8(t.drive);
  const V8 sign = broadcast8(t.sign), kinetic = broadcast8(t.kinetic), drop = broadcast8(t.drop);
  const V8 steepness = broadcast8(t.alpha * t.sign), alpha = broadcast8(t.alpha), clip = broadcast8(kClip);
  V8 guess;
  if (t.ahead != nullptr) {  // the sliding speed continues better than the force
    const V8 speed = max8(sign * (drive - matrix_times(t.ahead, t.velocity)), broadcast8(0.0));
    guess = sign * fma8(drop, exp8(broadcast8(0.0) - alpha * speed), kinetic);
  } else {
    guess = load8(t.forces);
  }
  V8 v = free + matrix_times(t.kernel, guess);
  const double allowed = t.force_error * (t.kinetic + t.drop), accuracy = __builtin_sqrt(t.force_error);
  Inverse inverse;
  bool inverted = false, series = false;
  double steepest = 0.0, ratio = 0.0, last = 0.0;
  for (int iteration = 0; iteration < kNewtonLimit; ++iteration) {
    const V8 scaled = steepness * (drive - v);
    const V8 e = drop * exp8(broadcast8(0.0) - max8(scaled, clip));
    const V8 lambda = sign * (kinetic + e);
    const V8 slope = where_positive(scaled - clip, alpha * e);
    const V8 residual = (free + matrix_times(t.kernel, lambda)) - v;
    if (!inverted) {
      steepest = largest(slope);
      ratio = steepest * t.kernel_norm;
      series = ratio < kSmallRatio;
      if (!series && !invert(t.kernel, slope, inverse)) return false;
    }
    V8 delta = residual;
    if (series) {
      // δ = r + B(r + B(r + …)), B = A diag(slope).
      for (double left = ratio; left > accuracy; left *= ratio)
        delta = residual + matrix_times(t.kernel, slope * delta);
    } else {
      delta = Inverse::times(inverse, residual);
    }
    v = v + delta;
    const double change = largest(abs8(delta));
    if (!(change < __builtin_huge_val())) return false;
    // The law's second derivative is α slope: what its linearisation leaves out. The changes after one inversion shrink
    // by a constant factor.
    const double left = inverted ? change * change / last : 0.0;
    const bool slopes_hold = t.alpha * change < kSameSlope;
    if ((slopes_hold && steepest * (0.5 * t.alpha * change * change + left) < allowed) ||
        change < kUnmoved * largest(max8(abs8(v), abs8(drive)))) {
      store8(t.forces, fma8(slope, delta, lambda));
      store8(t.velocity, v);
      return true;
    }
    inverted = !series && (!inverted || change < kChordRatio * last);
    last = change;
  }
  return false;
}

void solve_stick(const Trial& t, const double* inverse) {
  const V8 drive = load8(t.drive);
  store8(t.forces, matrix_times(inverse, drive - free_velocity(t)));
  store8(t.velocity, drive);
}

void solve_sliding(const Trial& t) { store8(t.velocity, free_velocity(t) + matrix_times(t.kernel, t.forces)); }

void two_dots(const double* a, const double* b, const double* x, double& out_a, double& out_b) {
  const V8 values = load8(x);
  out_a = sum8(load8(a) * values);
  out_b = sum8(load8(b) * values);
}

double speed_guard(const double* bernstein, const double* by_start, double start, double sign, const double* drive,
                   const double* velocity, double* out) {
  const V8 speed = broadcast8(sign) * (load8(drive) - load8(velocity));
  const V8 coefficients = fma8(broadcast8(start), load8(by_start), matrix_times(bernstein, speed));
  store8(out, coefficients);
  return least(coefficients);
}

double force_guard(const double* bernstein, const double* forces, double* out) {
  const V8 coefficients = matrix_times(bernstein, forces);
  store8(out, coefficients);
  return largest(abs8(coefficients));
}

void propagate(const StepArrays& s, const double* x, const double* forces, double* out_x) {
  const Index np = s.np;
  for (Index i = 0; i < np; i += kLanes) {
    const V8 x1 = load8(x + i), x2 = load8(x + np + i);
    V8 y1 = load8(s.e11 + i) * x1, z1 = load8(s.e12 + i) * x2;
    V8 y2 = load8(s.e21 + i) * x1, z2 = load8(s.e22 + i) * x2;
    if (s.load != nullptr) {
      y1 = y1 + load8(s.load + i);
      y2 = y2 + load8(s.load + np + i);
    }
    const double* response = s.response + i;
    int j = 0;
    for (; j + 2 <= s.columns; j += 2, response += 4 * np) {
      const V8 even = broadcast8(forces[j]), odd = broadcast8(forces[j + 1]);
      y1 = fma8(load8(response), even, y1);
      y2 = fma8(load8(response + np), even, y2);
      z1 = fma8(load8(response + 2 * np), odd, z1);
      z2 = fma8(load8(response + 3 * np), odd, z2);
    }
    if (j < s.columns) {
      const V8 last = broadcast8(forces[j]);
      y1 = fma8(load8(response), last, y1);
      y2 = fma8(load8(response + np), last, y2);
    }
    store8(out_x + i, y1 + z1);
    store8(out_x + np + i, y2 + z2);
  }
}

double loss(const LossArrays& f, const double* x, const double* forces) {
  const Index np = f.np;
  V8 by_state = broadcast8(0.0), by_force = by_state;
  for (Index i = 0; i < np; i += kLanes) {
    const V8 x1 = load8(x + i), x2 = load8(x + np + i);
    by_state = fma8(x1, fma8(load8(f.s11 + i), x1, load8(f.s12 + i) * x2), by_state);
    by_state = fma8(x2, load8(f.s22 + i) * x2, by_state);
  }
  if (f.linear != nullptr)
    for (Index i = 0; i < 2 * np; i += kLanes) by_state = fma8(load8(f.linear + i), load8(x + i), by_state);
  for (int c = 0; c < f.contacts; ++c) {
    V8 power = sum_pairs(f.by_force + kNodes * 2 * np * c, x, f.n, np, load8(f.load + kNodes * c));
    for (int d = 0; d < f.contacts; ++d)
      power = power + matrix_times(f.kernel + kNodes * kNodes * (f.contacts * c + d), forces + kNodes * d);
    by_force = fma8(load8(forces + kNodes * c), power, by_force);
  }
  return sum8(by_state) + sum8(by_force) + f.constant;
}

namespace {

/// 1/(k + 1)!.
struct OverFactorials {
  double of[kMostTerms] = {};
  constexpr OverFactorials() {
    double factorial = 1.0;
    for (int k = 0; k < kMostTerms; ++k) of[k] = 1.0 / (factorial *= k + 1);
  }
};
constexpr OverFactorials kOverFactorial;

/// ∫₀¹ sᵏ sˡ ds / l!, for k < 8.
struct PowerProducts {
  double of[kNodes][kMoments] = {};
  constexpr PowerProducts() {
    for (int k = 0; k < kNodes; ++k) {
      double factorial = 1.0;
      for (int l = 0; l < kMoments; factorial *= ++l) of[k][l] = 1.0 / (factorial * (k + l + 1));
    }
  }
};
constexpr PowerProducts kProducts;

/// Terms of Taylor's series of eight pairs, one after another: each(k, x₁⁽ᵏ⁺¹⁾τᵏ⁺¹, x₂⁽ᵏ⁺¹⁾τᵏ⁺¹) for k = 0 … terms − 1.
template <class Each>
SLIPMODE_LANES_INLINE void taylor_terms(const PairArrays& m, Index i, V8 y1, V8 y2, const double* coefficient,
                                        double tau, int terms, const Each& each) {
  const Index np = m.np;
  const V8 by = broadcast8(tau);
  const V8 g11 = load8(m.g11 + i) * by, g12 = load8(m.g12 + i) * by;
  const V8 g21 = load8(m.g21 + i) * by, g22 = load8(m.g22 + i) * by;
  double factorial = 1.0;
  for (int k = 0; k < terms; ++k) {
    V8 next1 = fma8(g11, y1, g12 * y2), next2 = fma8(g21, y1, g22 * y2);
    if (m.load != nullptr && k == 0) {
      next1 = fma8(load8(m.load + i), by, next1);
      next2 = fma8(load8(m.load + np + i), by, next2);
    }
    if (k < m.powers)
      for (int c = 0; c < m.contacts; ++c) {
        const double* b = m.input + 2 * np * c;
        const V8 force = broadcast8(coefficient[kNodes * c + k] * factorial);
        next1 = fma8(load8(b + i), force, next1);
        next2 = fma8(load8(b + np + i), force, next2);
      }
    y1 = next1;
    y2 = next2;
    factorial *= k + 1;
    each(k, y1, y2);
  }
}

}  // namespace

void taylor(const PairArrays& m, const double* x, const double* coefficient, double tau, int terms, double* out_x) {
  for (Index i = 0; i < m.np; i += kLanes) {
    const V8 y1 = load8(x + i), y2 = load8(x + m.np + i);
    V8 sum1 = y1, sum2 = y2;
    taylor_terms(
        m, i, y1, y2, coefficient, tau, terms, [&](int k, V8 term1, V8 term2) __attribute__((always_inline)) {
          const V8 share = broadcast8(kOverFactorial.of[k]);
          sum1 = fma8(share, term1, sum1);
          sum2 = fma8(share, term2, sum2);
        });
    store8(out_x + i, sum1);
    store8(out_x + m.np + i, sum2);
  }
}

namespace {

/// See Kernels::taylor_work. @param kStates  the states at the rule's points are asked for, else the loss
template <bool kStates>
SLIPMODE_LANES_INLINE Work series_work(const PairArrays& m, const double* velocity_row, const double* damping,
                                       const double* x, const double* coefficient, double tau, int terms,
                                       const SeriesRule& rule, const double* moments, double* out_x) {
  const Index np = m.np;
  const int own = m.contacts - m.given;
  V8 contact = broadcast8(0.0), force = contact, loss = contact;
  for (Index i = 0; i < np; i += kLanes) {
    const V8 y1 = load8(x + i), y2 = load8(x + np + i);
    V8 place[kWorkPoints], speed[kWorkPoints];
    for (int p = 0; p < kWorkPoints; ++p) {
      place[p] = y1;
      speed[p] = y2;
    }
    const auto add = [&](int c, int l, V8 term1, V8 term2, V8& sum) __attribute__((always_inline)) {
      const double* row = velocity_row + 2 * np * c + i;
      sum = fma8(broadcast8(moments[kMoments * c + l]), fma8(load8(row), term1, load8(row + np) * term2), sum);
    };
    const auto add_contacts = [&](int l, V8 term1, V8 term2) __attribute__((always_inline)) {
      for (int c = 0; c < own; ++c) add(c, l, term1, term2, contact);
      for (int c = own; c < m.contacts; ++c) add(c, l, term1, term2, force);
    };
    add_contacts(0, y1, y2);
    taylor_terms(
        m, i, y1, y2, coefficient, tau, terms, [&](int k, V8 term1, V8 term2) __attribute__((always_inline)) {
          for (int p = 0; p < kWorkPoints; ++p) {
            const V8 by = broadcast8(rule.at_node[k][p]);
            if constexpr (kStates) place[p] = fma8(by, term1, place[p]);
            speed[p] = fma8(by, term2, speed[p]);
          }
          add_contacts(k + 1, term1, term2);
        });
    if constexpr (kStates) {
      for (int p = 0; p < kWorkPoints; ++p) {
        store8(out_x + 2 * np * p + i, place[p]);
        store8(out_x + 2 * np * p + np + i, speed[p]);
      }
    } else {
      V8 squares = broadcast8(0.0);
      for (int p = 0; p < kWorkPoints; ++p) squares = fma8(broadcast8(rule.weight[p]) * speed[p], speed[p], squares);
      loss = fma8(load8(damping + i), squares, loss);
    }
  }
  return {sum8(contact), sum8(force), tau * sum8(loss)};
}

}  // namespace

Work taylor_work(const PairArrays& m, const double* velocity_row, const double* damping, const double* x,
                 const double* coefficient, double tau, int terms, const SeriesRule& rule, double* out_moments,
                 double* out_x) {
  for (int c = 0; c < m.contacts; ++c)  // ∫ λ sˡ ds/l!, times τ
    for (int l = 0; l <= terms; l += kLanes) {
      V8 sum = broadcast8(0.0);
      for (int k = 0; k < m.powers; ++k)
        sum = fma8(load8(kProducts.of[k] + l), broadcast8(coefficient[kNodes * c + k]), sum);
      store8(out_moments + kMoments * c + l, sum);
    }
  if (damping == nullptr)
    return series_work<true>(m, velocity_row, damping, x, coefficient, tau, terms, rule, out_moments, out_x);
  return series_work<false>(m, velocity_row, damping, x, coefficient, tau, terms, rule, out_moments, out_x);
}

}  // namespace slipmode::kernels::SLIPMODE_KERNEL_SET
