#include "dynamics/pair_motion.hpp"

#include <cmath>
#include <cstdint>

namespace slipmode::dynamics {
namespace {

/// w below this share of |τ| would make A large.
constexpr double kHardlyOscillates = 1e-2;
/// Added to a double below 2⁵¹ in size it leaves the nearest integer in the lowest bits.
constexpr double kRounder = 6755399441055744.0;
/// e to this power is nothing beside 1, and its square no subnormal number.
constexpr double kGone = -300.0;
/// Past this exponent of growth a state is no longer of use; windows are shorter.
constexpr double kGrown = 300.0;

/// π/2 in three parts of 33 bits and a rest: products with integers below 2²⁰ are exact. Source: fdlibm, e_rem_pio2.c.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2ep-69;
constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;

#if defined(__GNUC__) && !defined(__clang__)
// Without AVX vectors of four are passed otherwise than with it. Here they stay within inlined functions of this file.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

/// Four pairs at a time: two registers of SSE2, one of AVX2.
using V4 = double __attribute__((vector_size(32), aligned(32)));
using Bits = std::int64_t __attribute__((vector_size(32)));

V4 load(const double* from) { return *reinterpret_cast<const V4*>(from); }
void store(double* to, V4 a) { *reinterpret_cast<V4*>(to) = a; }
Bits bits(V4 a) { return reinterpret_cast<Bits>(a); }
V4 number(Bits a) { return reinterpret_cast<V4>(a); }

/// sin a and cos a − 1.
struct Turn {
  V4 sine, cosine_less;
};
Turn turn(V4 a) {
  // a = r + k π/2, |r| ≤ π/4.
  const V4 rounded = a * 0.63661977236758134308 + kRounder, k = rounded - kRounder;
  const V4 r = ((a - k * kHalfPi1) - k * kHalfPi2) - k * kHalfPi3, z = r * r;
  V4 by_z = z * 2.81145725434552076320e-15 - 7.64716373181981647590e-13;
  for (const double term : {1.60590438368216145994e-10, -2.50521083854417187751e-8, 2.75573192239858906526e-6,
                            -1.98412698412698412698e-4, 8.33333333333333333333e-3, -1.66666666666666666667e-1})
    by_z = by_z * z + term;
  V4 less = z * 4.77947733238738529744e-14 - 1.14707455977297247139e-11;
  for (const double term : {2.08767569878680989792e-9, -2.75573192239858906526e-7, 2.48015873015873015873e-5,
                            -1.38888888888888888889e-3, 4.16666666666666666667e-2, -0.5})
    less = less * z + term;
  less *= z;
  const V4 sine = r + r * z * by_z, cosine = 1.0 + less;
  const Bits quadrant = bits(rounded), odd = (quadrant & 1) != 0;
  const V4 s = number(bits(odd ? cosine : sine) ^ ((quadrant & 2) << 62));
  const V4 c = number(bits(odd ? sine : cosine) ^ (((quadrant + 1) & 2) << 62));
  return {s, k == 0.0 ? less : c - 1.0};
}

/// e^a − 1, of a power that is not beyond kGone or kGrown.
V4 growth(V4 a) {
  // a = q + j ln 2, |q| ≤ ln 2 / 2.
  const V4 rounded = a * 1.44269504088896340736 + kRounder, j = rounded - kRounder;
  const V4 q = (a - j * kLn2High) - j * kLn2Low;
  V4 series = q * (1.0 / 6227020800.0) + 1.0 / 479001600.0;
  for (const double term : {1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0,
                            1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0})
    series = series * q + term;
  series *= q;
  const V4 size = number(bits(1.0 + series) + (bits(rounded) << 52));
  return j == 0.0 ? series : size - 1.0;
}

}  // namespace

PairMotion::PairMotion(const ModalModel& m) {
  decay_ = frequency_ = a11_ = a12_ = a21_ = Eigen::VectorXd::Zero(m.np);
  available_ = m.n > 0;
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const double half = (m.g11(i) - m.g22(i)) / 2.0, square = -m.g12(i) * m.g21(i) - half * half;
    decay_(i) = (m.g11(i) + m.g22(i)) / 2.0;
    if (!(square > kHardlyOscillates * kHardlyOscillates * decay_(i) * decay_(i))) {
      available_ = false;
      return;
    }
    frequency_(i) = std::sqrt(square);
    a11_(i) = half / frequency_(i);
    a12_(i) = m.g12(i) / frequency_(i);
    a21_(i) = m.g21(i) / frequency_(i);
  }
}

void PairMotion::add(double t, const double* free, double* x) const {
  const Eigen::Index np = decay_.size();
  for (Eigen::Index i = 0; i < np; i += 4) {
    const V4 power = load(decay_.data() + i) * t;
    const V4 bounded = power < kGone ? V4{} + kGone : power > kGrown ? V4{} + kGrown : power;
    const V4 grown = growth(bounded);
    const auto [sine, cosine_less] = turn(load(frequency_.data() + i) * t);
    const V4 across = (1.0 + grown) * sine, straight = grown * (1.0 + cosine_less) + cosine_less;
    const V4 own = across * load(a11_.data() + i);
    const V4 f1 = load(free + i), f2 = load(free + np + i);
    store(x + i, load(x + i) + ((straight + own) * f1 + across * load(a12_.data() + i) * f2));
    store(x + np + i, load(x + np + i) + (across * load(a21_.data() + i) * f1 + (straight - own) * f2));
  }
}

}  // namespace slipmode::dynamics
