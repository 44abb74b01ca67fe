// Built once for every width: see CMakeLists.txt beside it.

#include "dynamics/kernels/internal/kernel_set.hpp"
#include "dynamics/kernels/internal/lanes.hpp"

namespace slipmode::dynamics::kernels::SLIPMODE_KERNEL_SET {
namespace {

/// e to this power is nothing beside 1, and its square no subnormal number.
constexpr double kGone = -300.0;
/// Past this exponent of growth a state is no longer of use; windows are shorter.
constexpr double kGrown = 300.0;
/// π/2 in three parts of 33 bits: products with integers below 2²⁰ are exact. Source: fdlibm, e_rem_pio2.c.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2ep-69;
constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;

/// Taylor's coefficients, from those of the highest powers down; the highest two of each stand in the code.
constexpr double kSine[] = {1.60590438368216145994e-10, -2.50521083854417187751e-8, 2.75573192239858906526e-6,
                            -1.98412698412698412698e-4, 8.33333333333333333333e-3,  -1.66666666666666666667e-1};
constexpr double kCosine[] = {2.08767569878680989792e-9,  -2.75573192239858906526e-7, 2.48015873015873015873e-5,
                              -1.38888888888888888889e-3, 4.16666666666666666667e-2,  -0.5};
constexpr double kGrowth[] = {
    1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
    1.0 / 120.0,      1.0 / 24.0,      1.0 / 6.0,      0.5,           1.0};

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
  V8 by_z = fma8(z, broadcast8(2.81145725434552076320e-15), broadcast8(-7.64716373181981647590e-13));
  for (const double term : kSine) by_z = fma8(by_z, z, broadcast8(term));
  V8 less = fma8(z, broadcast8(4.77947733238738529744e-14), broadcast8(-1.14707455977297247139e-11));
  for (const double term : kCosine) less = fma8(less, z, broadcast8(term));
  less = less * z;
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
  V8 series = fma8(q, broadcast8(1.0 / 6227020800.0), broadcast8(1.0 / 479001600.0));
  for (const double term : kGrowth) series = fma8(series, q, broadcast8(term));
  series = series * q;
  return where_zero(j, series, scale_by_bits(broadcast8(1.0) + series, rounded) - broadcast8(1.0));
}

}  // namespace

void free_motion(const MotionArrays& m, double t, const double* free, double* x) {
  const Index np = m.np;
  const V8 time = broadcast8(t), one = broadcast8(1.0);
  for (Index i = 0; i < np; i += kLanes) {
    const V8 power = min8(max8(load8(m.decay + i) * time, broadcast8(kGone)), broadcast8(kGrown));
    const V8 grown = growth(power);
    V8 sine, less;
    turn(load8(m.frequency + i) * time, sine, less);
    const V8 across = (one + grown) * sine, straight = fma8(grown, one + less, less);
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

}  // namespace slipmode::dynamics::kernels::SLIPMODE_KERNEL_SET
