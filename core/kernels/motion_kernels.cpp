// Built once for every width: see CMakeLists.txt beside it.

#include "core/kernels/internal/kernel_set.hpp"
#include "core/kernels/internal/lanes.hpp"

namespace slipmode::kernels::SLIPMODE_KERNEL_SET {
namespace {

/// e to this power is nothing beside 1, and its square no subnormal number.
constexpr double kGone = -300.0;
/// Past this exponent of growth a state is no longer of use; windows are shorter.
constexpr double kGrown = 300.0;
/// π/2 in three parts of 33 bits: products with integers below 2²⁰ are exact. Source: fdlibm, e_rem_pio2.c.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2ep-69;
constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;

/// Taylor's coefficients of (sin r − r)/(r z), (cos r − 1)/z, z = r², and (e^q − 1)/q, from the lowest power up.
constexpr double kSine[] = {-1.66666666666666666667e-1,  8.33333333333333333333e-3,  -1.98412698412698412698e-4,
                            2.75573192239858906526e-6,   -2.50521083854417187751e-8, 1.60590438368216145994e-10,
                            -7.64716373181981647590e-13, 2.81145725434552076320e-15};
constexpr double kCosine[] = {-0.5,
                              4.16666666666666666667e-2,
                              -1.38888888888888888889e-3,
                              2.48015873015873015873e-5,
                              -2.75573192239858906526e-7,
                              2.08767569878680989792e-9,
                              -1.14707455977297247139e-11,
                              4.77947733238738529744e-14};
constexpr double kGrowth[] = {1.0,
                              0.5,
                              1.0 / 6.0,
                              1.0 / 24.0,
                              1.0 / 120.0,
                              1.0 / 720.0,
                              1.0 / 5040.0,
                              1.0 / 40320.0,
                              1.0 / 362880.0,
                              1.0 / 3628800.0,
                              1.0 / 39916800.0,
                              1.0 / 479001600.0,
                              1.0 / 6227020800.0};

/// c₀ + c₁a + … + c₇a⁷ in pairs (Estrin's scheme): steps wait for four products, not for seven.
SLIPMODE_LANES_INLINE V8 series8(const double* c, V8 a, V8 a2, V8 a4) {
  const V8 p01 = fma8(broadcast8(c[1]), a, broadcast8(c[0])), p23 = fma8(broadcast8(c[3]), a, broadcast8(c[2]));
  const V8 p45 = fma8(broadcast8(c[5]), a, broadcast8(c[4])), p67 = fma8(broadcast8(c[7]), a, broadcast8(c[6]));
  return fma8(fma8(p67, a2, p45), a4, fma8(p23, a2, p01));
}

/// The nearest integer.
SLIPMODE_LANES_INLINE V8 nearest(V8 a) { return (a + broadcast8(kRounder)) - broadcast8(kRounder); }
/// a where the integer k is 0, else b.
SLIPMODE_LANES_INLINE V8 where_zero(V8 k, V8 a, V8 b) {
  const V8 beyond = abs8(k) - broadcast8(0.5);
  return where_positive(broadcast8(0.0) - beyond, a) + where_positive(beyond, b);
}

/// sin a and cos a − 1.
SLIPMODE_LANES_INLINE void turn(V8 a, V8& out_sine, V8& out_cosine_less) {
  const V8 one = broadcast8(1.0), two = broadcast8(2.0);
  // a = r + k π/2, |r| ≤ π/4.
  const V8 k = nearest(a * broadcast8(0.63661977236758134308));
  const V8 r = fnma8(k, broadcast8(kHalfPi3), fnma8(k, broadcast8(kHalfPi2), fnma8(k, broadcast8(kHalfPi1), a)));
  const V8 z = r * r;
  const V8 z2 = z * z, z4 = z2 * z2, by_z = series8(kSine, z, z2, z4), less = series8(kCosine, z, z2, z4) * z;
  const V8 sine = fma8(r * z, by_z, r), cosine = one + less;
  // k = 4m + quadrant.
  const V8 m = nearest(fma8(k, broadcast8(0.25), broadcast8(-0.375)));
  const V8 quadrant = fnma8(broadcast8(4.0), m, k);
  const V8 odd = abs8(fnma8(two, nearest(broadcast8(0.5) * k), k));
  const V8 sine_sign = fnma8(two, where_positive(quadrant - broadcast8(1.5), one), one);
  const V8 middle = where_positive(quadrant - broadcast8(0.5), where_positive(broadcast8(2.5) - quadrant, one));
  out_sine = sine_sign * where_zero(odd, sine, cosine);
  out_cosine_less = where_zero(k, less, fnma8(two, middle, one) * where_zero(odd, cosine, sine) - one);
}

/// e^a − 1 for a between kGone and kGrown.
SLIPMODE_LANES_INLINE V8 growth(V8 a) {
  // a = q + j ln 2, |q| ≤ ln 2 / 2.
  const V8 rounded = fma8(a, broadcast8(1.44269504088896340736), broadcast8(kRounder));
  const V8 j = rounded - broadcast8(kRounder);
  const V8 q = fnma8(j, broadcast8(kLn2Low), fnma8(j, broadcast8(kLn2High), a));
  const V8 q2 = q * q, q4 = q2 * q2;
  const V8 p89 = fma8(broadcast8(kGrowth[9]), q, broadcast8(kGrowth[8]));
  const V8 pab = fma8(broadcast8(kGrowth[11]), q, broadcast8(kGrowth[10]));
  const V8 above = fma8(broadcast8(kGrowth[12]), q4, fma8(pab, q2, p89));
  const V8 series = fma8(above, q4 * q4, series8(kGrowth, q, q2, q4)) * q;
  return where_zero(j, series, scale_by_bits(broadcast8(1.0) + series, rounded) - broadcast8(1.0));
}

/// e^{Gt} − I = straight I + across A, of eight pairs from i on.
SLIPMODE_LANES_INLINE void change(const MotionArrays& m, Index i, double t, V8& out_across, V8& out_straight) {
  const V8 time = broadcast8(t), one = broadcast8(1.0);
  const V8 power = min8(max8(load8(m.decay + i) * time, broadcast8(kGone)), broadcast8(kGrown));
  const V8 grown = growth(power);
  V8 sine, less;
  turn(load8(m.frequency + i) * time, sine, less);
  out_across = (one + grown) * sine;
  out_straight = fma8(grown, one + less, less);
}

}  // namespace

void changes(const MotionArrays& m, const double* times, Index count, double* out) {
  for (Index k = 0; k < count; ++k, out += 4 * m.np)
    for (Index i = 0; i < m.np; i += kLanes) {
      V8 across, straight;
      change(m, i, times[k], across, straight);
      const V8 own = across * load8(m.a11 + i);
      store8(out + i, straight + own);
      store8(out + m.np + i, across * load8(m.a12 + i));
      store8(out + 2 * m.np + i, across * load8(m.a21 + i));
      store8(out + 3 * m.np + i, straight - own);
    }
}

void caused(Index np, Index points, const double* a, const double* b, const double* u, const double* v, const double* w,
            double* out) {
  for (Index i = 0; i < np; i += kLanes) {
    const V8 own_a = load8(a + i), own_b = load8(b + i);
    V8 sum[8];
    for (V8& s : sum) s = broadcast8(0.0);
    for (Index l = 0; l < points; ++l) {
      const V8 moved = fma8(own_a, load8(u + np * l + i), own_b * load8(v + np * l + i));
#pragma GCC unroll 8
      for (int j = 0; j < 8; ++j) sum[j] = fma8(moved, broadcast8(w[8 * l + j]), sum[j]);
    }
    for (int j = 0; j < 8; ++j) store8(out + np * j + i, sum[j]);
  }
}

void weighted_products(Index np, const double* A, const double* B, const double* weight, double* out) {
  for (int column = 0; column < 8; ++column) {
    V8 sum[8];
    for (V8& s : sum) s = broadcast8(0.0);
    for (Index i = 0; i < np; i += kLanes) {
      const V8 weighted = load8(weight + i) * load8(B + np * column + i);
#pragma GCC unroll 8
      for (int row = 0; row < 8; ++row) sum[row] = fma8(load8(A + np * row + i), weighted, sum[row]);
    }
    for (int row = 0; row < 8; ++row) out[8 * column + row] += sum8(sum[row]);
  }
}

void free_motion(const MotionArrays& m, double t, const double* free, double* x) {
  const Index np = m.np;
  for (Index i = 0; i < np; i += kLanes) {
    V8 across, straight;
    change(m, i, t, across, straight);
    const V8 own = across * load8(m.a11 + i), f1 = load8(free + i), f2 = load8(free + np + i);
    const V8 by1 = fma8(straight + own, f1, across * load8(m.a12 + i) * f2);
    const V8 by2 = fma8(across * load8(m.a21 + i), f1, (straight - own) * f2);
    store8(x + i, load8(x + i) + by1);
    store8(x + np + i, load8(x + np + i) + by2);
  }
}

void pass(const ChangeArrays& m, double* x, double* free, double* out_size) {
  const Index np = m.np;
  for (Index i = 0; i < np; i += kLanes) {
    const V8 f1 = load8(free + i), f2 = load8(free + np + i);
    const V8 by1 = fma8(load8(m.d11 + i), f1, load8(m.d12 + i) * f2);
    const V8 by2 = fma8(load8(m.d21 + i), f1, load8(m.d22 + i) * f2);
    store8(x + i, load8(x + i) + by1);
    store8(x + np + i, load8(x + np + i) + by2);
    const V8 now1 = f1 + by1, now2 = f2 + by2;
    store8(free + i, now1);
    store8(free + np + i, now2);
    store8(out_size + i, fma8(load8(m.scale1 + i), abs8(now1), load8(m.scale2 + i) * abs8(now2)));
  }
}

}  // namespace slipmode::kernels::SLIPMODE_KERNEL_SET
