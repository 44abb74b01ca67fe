#pragma once

// Eight doubles in one value, for the width this source is compiled for: one register of AVX-512, two of AVX2, four of
// SSE2. Every operation is written out (no compiler contracts or reorders it: kernels are built with
// -ffp-contract=off), and reductions have one order, so that AVX2 and AVX-512 give the same bytes. Without fused
// multiply-add (the plain x86-64 level) products are rounded before they are added: the last bits differ there.
//
// Included by the kernels only. Nothing here or there may be an inline function with linkage: the linker would keep one
// copy, of one width, for all.

#include <cstdint>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace slipmode::kernels {
namespace {

#define SLIPMODE_LANES_INLINE [[gnu::always_inline]] static inline

inline constexpr int kLanes = 8;
/// 1.5·2⁵²: added to a double below 2⁵¹ in size it leaves its nearest integer in the lowest bits.
inline constexpr double kRounder = 6755399441055744.0;

#if defined(__AVX512F__) && defined(__AVX512DQ__)

struct V8 {
  __m512d r;
};
SLIPMODE_LANES_INLINE V8 load8(const double* from) { return {_mm512_loadu_pd(from)}; }
SLIPMODE_LANES_INLINE void store8(double* to, V8 a) { _mm512_storeu_pd(to, a.r); }
SLIPMODE_LANES_INLINE V8 broadcast8(double value) { return {_mm512_set1_pd(value)}; }
SLIPMODE_LANES_INLINE V8 operator+(V8 a, V8 b) { return {_mm512_add_pd(a.r, b.r)}; }
SLIPMODE_LANES_INLINE V8 operator-(V8 a, V8 b) { return {_mm512_sub_pd(a.r, b.r)}; }
SLIPMODE_LANES_INLINE V8 operator*(V8 a, V8 b) { return {_mm512_mul_pd(a.r, b.r)}; }
SLIPMODE_LANES_INLINE V8 operator/(V8 a, V8 b) { return {_mm512_div_pd(a.r, b.r)}; }
/// a b + c, and c − a b.
SLIPMODE_LANES_INLINE V8 fma8(V8 a, V8 b, V8 c) { return {_mm512_fmadd_pd(a.r, b.r, c.r)}; }
SLIPMODE_LANES_INLINE V8 fnma8(V8 a, V8 b, V8 c) { return {_mm512_fnmadd_pd(a.r, b.r, c.r)}; }
SLIPMODE_LANES_INLINE V8 max8(V8 a, V8 b) { return {_mm512_max_pd(a.r, b.r)}; }
SLIPMODE_LANES_INLINE V8 min8(V8 a, V8 b) { return {_mm512_min_pd(a.r, b.r)}; }
SLIPMODE_LANES_INLINE V8 abs8(V8 a) { return {_mm512_abs_pd(a.r)}; }
/// b where a > 0, else 0.
SLIPMODE_LANES_INLINE V8 where_positive(V8 a, V8 b) {
  return {_mm512_maskz_mov_pd(_mm512_cmp_pd_mask(a.r, _mm512_setzero_pd(), _CMP_GT_OQ), b.r)};
}
/// a 2ᵏ for k in the lowest bits of t = kRounder + k, as long as the result is a normal number.
SLIPMODE_LANES_INLINE V8 scale_by_bits(V8 a, V8 t) {
  return {
      _mm512_castsi512_pd(_mm512_add_epi64(_mm512_castpd_si512(a.r), _mm512_slli_epi64(_mm512_castpd_si512(t.r), 52)))};
}
/// Lane k in all lanes.
template <int k>
SLIPMODE_LANES_INLINE V8 splat(V8 a) {
  return {_mm512_permutexvar_pd(_mm512_set1_epi64(k), a.r)};
}
/// The four sums of lanes i and i + 4 (or other pairings of the same kind).
#define SLIPMODE_HALVES(a, combine) combine(_mm512_castpd512_pd256(a.r), _mm512_extractf64x4_pd(a.r, 1))

#elif defined(__AVX2__) && defined(__FMA__)

struct V8 {
  __m256d lo, hi;
};
SLIPMODE_LANES_INLINE V8 load8(const double* from) { return {_mm256_loadu_pd(from), _mm256_loadu_pd(from + 4)}; }
SLIPMODE_LANES_INLINE void store8(double* to, V8 a) {
  _mm256_storeu_pd(to, a.lo);
  _mm256_storeu_pd(to + 4, a.hi);
}
SLIPMODE_LANES_INLINE V8 broadcast8(double value) {
  const __m256d all = _mm256_set1_pd(value);
  return {all, all};
}
SLIPMODE_LANES_INLINE V8 operator+(V8 a, V8 b) { return {_mm256_add_pd(a.lo, b.lo), _mm256_add_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 operator-(V8 a, V8 b) { return {_mm256_sub_pd(a.lo, b.lo), _mm256_sub_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 operator*(V8 a, V8 b) { return {_mm256_mul_pd(a.lo, b.lo), _mm256_mul_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 operator/(V8 a, V8 b) { return {_mm256_div_pd(a.lo, b.lo), _mm256_div_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 fma8(V8 a, V8 b, V8 c) {
  return {_mm256_fmadd_pd(a.lo, b.lo, c.lo), _mm256_fmadd_pd(a.hi, b.hi, c.hi)};
}
SLIPMODE_LANES_INLINE V8 fnma8(V8 a, V8 b, V8 c) {
  return {_mm256_fnmadd_pd(a.lo, b.lo, c.lo), _mm256_fnmadd_pd(a.hi, b.hi, c.hi)};
}
SLIPMODE_LANES_INLINE V8 max8(V8 a, V8 b) { return {_mm256_max_pd(a.lo, b.lo), _mm256_max_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 min8(V8 a, V8 b) { return {_mm256_min_pd(a.lo, b.lo), _mm256_min_pd(a.hi, b.hi)}; }
SLIPMODE_LANES_INLINE V8 abs8(V8 a) {
  const __m256d sign = _mm256_set1_pd(-0.0);
  return {_mm256_andnot_pd(sign, a.lo), _mm256_andnot_pd(sign, a.hi)};
}
SLIPMODE_LANES_INLINE V8 where_positive(V8 a, V8 b) {
  const __m256d zero = _mm256_setzero_pd();
  return {_mm256_and_pd(_mm256_cmp_pd(a.lo, zero, _CMP_GT_OQ), b.lo),
          _mm256_and_pd(_mm256_cmp_pd(a.hi, zero, _CMP_GT_OQ), b.hi)};
}
SLIPMODE_LANES_INLINE __m256d scale_half(__m256d a, __m256d t) {
  return _mm256_castsi256_pd(_mm256_add_epi64(_mm256_castpd_si256(a), _mm256_slli_epi64(_mm256_castpd_si256(t), 52)));
}
SLIPMODE_LANES_INLINE V8 scale_by_bits(V8 a, V8 t) { return {scale_half(a.lo, t.lo), scale_half(a.hi, t.hi)}; }
template <int k>
SLIPMODE_LANES_INLINE V8 splat(V8 a) {
  const __m256d all = _mm256_permute4x64_pd(k < 4 ? a.lo : a.hi, (k % 4) * 0x55);
  return {all, all};
}
#define SLIPMODE_HALVES(a, combine) combine(a.lo, a.hi)

#else

struct V8 {
  double lane[kLanes];
};
#define SLIPMODE_EACH(expression)                            \
  V8 out;                                                    \
  for (int i = 0; i < kLanes; ++i) out.lane[i] = expression; \
  return out
SLIPMODE_LANES_INLINE V8 load8(const double* from) { SLIPMODE_EACH(from[i]); }
SLIPMODE_LANES_INLINE void store8(double* to, const V8& a) {
  for (int i = 0; i < kLanes; ++i) to[i] = a.lane[i];
}
SLIPMODE_LANES_INLINE V8 broadcast8(double value) { SLIPMODE_EACH(value); }
SLIPMODE_LANES_INLINE V8 operator+(const V8& a, const V8& b) { SLIPMODE_EACH(a.lane[i] + b.lane[i]); }
SLIPMODE_LANES_INLINE V8 operator-(const V8& a, const V8& b) { SLIPMODE_EACH(a.lane[i] - b.lane[i]); }
SLIPMODE_LANES_INLINE V8 operator*(const V8& a, const V8& b) { SLIPMODE_EACH(a.lane[i] * b.lane[i]); }
SLIPMODE_LANES_INLINE V8 operator/(const V8& a, const V8& b) { SLIPMODE_EACH(a.lane[i] / b.lane[i]); }
SLIPMODE_LANES_INLINE V8 fma8(const V8& a, const V8& b, const V8& c) {
  SLIPMODE_EACH(a.lane[i] * b.lane[i] + c.lane[i]);
}
SLIPMODE_LANES_INLINE V8 fnma8(const V8& a, const V8& b, const V8& c) {
  SLIPMODE_EACH(c.lane[i] - a.lane[i] * b.lane[i]);
}
SLIPMODE_LANES_INLINE V8 max8(const V8& a, const V8& b) {
  SLIPMODE_EACH(a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]);
}
SLIPMODE_LANES_INLINE V8 min8(const V8& a, const V8& b) {
  SLIPMODE_EACH(a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]);
}
SLIPMODE_LANES_INLINE V8 abs8(const V8& a) { SLIPMODE_EACH(__builtin_fabs(a.lane[i])); }
SLIPMODE_LANES_INLINE V8 where_positive(const V8& a, const V8& b) { SLIPMODE_EACH(a.lane[i] > 0.0 ? b.lane[i] : 0.0); }
SLIPMODE_LANES_INLINE double scale_lane(double a, double t) {
  std::uint64_t bits, by;
  __builtin_memcpy(&bits, &a, sizeof bits);
  __builtin_memcpy(&by, &t, sizeof by);
  bits += by << 52;
  __builtin_memcpy(&a, &bits, sizeof a);
  return a;
}
SLIPMODE_LANES_INLINE V8 scale_by_bits(const V8& a, const V8& t) { SLIPMODE_EACH(scale_lane(a.lane[i], t.lane[i])); }
template <int k>
SLIPMODE_LANES_INLINE V8 splat(const V8& a) {
  return broadcast8(a.lane[k]);
}
#undef SLIPMODE_EACH

#endif

#ifdef SLIPMODE_HALVES
SLIPMODE_LANES_INLINE __m128d low(__m256d a) { return _mm256_castpd256_pd128(a); }
SLIPMODE_LANES_INLINE __m128d high(__m256d a) { return _mm256_extractf128_pd(a, 1); }
SLIPMODE_LANES_INLINE double sum8(V8 a) {
  const __m256d four = SLIPMODE_HALVES(a, _mm256_add_pd);
  const __m128d two = _mm_add_pd(low(four), high(four));
  return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
}
SLIPMODE_LANES_INLINE double largest(V8 a) {
  const __m256d four = SLIPMODE_HALVES(a, _mm256_max_pd);
  const __m128d two = _mm_max_pd(low(four), high(four));
  return _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)));
}
SLIPMODE_LANES_INLINE double least(V8 a) {
  const __m256d four = SLIPMODE_HALVES(a, _mm256_min_pd);
  const __m128d two = _mm_min_pd(low(four), high(four));
  return _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)));
}
#undef SLIPMODE_HALVES
#else
SLIPMODE_LANES_INLINE double sum8(const V8& a) {
  const double* x = a.lane;
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}
SLIPMODE_LANES_INLINE double largest(const V8& a) {
  double out = a.lane[0];
  for (int i = 1; i < kLanes; ++i) out = a.lane[i] > out ? a.lane[i] : out;
  return out;
}
SLIPMODE_LANES_INLINE double least(const V8& a) {
  double out = a.lane[0];
  for (int i = 1; i < kLanes; ++i) out = a.lane[i] < out ? a.lane[i] : out;
  return out;
}
#endif

/// e^a lane by lane to a rounding or two, for a up to 700; below −700 as there. a = k ln 2 + r, |r| ≤ ln 2/2, Taylor's
/// polynomial of degree 13 in r, whose remainder is 4e-18.
SLIPMODE_LANES_INLINE V8 exp8(V8 a) {
  a = max8(a, broadcast8(-700.0));
  const V8 t = fma8(a, broadcast8(1.4426950408889634074), broadcast8(kRounder));
  const V8 k = t - broadcast8(kRounder);
  V8 r = fnma8(k, broadcast8(6.93147180369123816490e-1), a);  // ln 2 in two parts, the first with 20 bits to spare
  r = fnma8(k, broadcast8(1.90821492927058770002e-10), r);
  const V8 r2 = r * r, r4 = r2 * r2;
  const V8 p01 = broadcast8(1.0) + r;
  const V8 p23 = fma8(broadcast8(1.0 / 6.0), r, broadcast8(0.5));
  const V8 p45 = fma8(broadcast8(1.0 / 120.0), r, broadcast8(1.0 / 24.0));
  const V8 p67 = fma8(broadcast8(1.0 / 5040.0), r, broadcast8(1.0 / 720.0));
  const V8 p89 = fma8(broadcast8(1.0 / 362880.0), r, broadcast8(1.0 / 40320.0));
  const V8 pab = fma8(broadcast8(1.0 / 39916800.0), r, broadcast8(1.0 / 3628800.0));
  const V8 pcd = fma8(broadcast8(1.0 / 6227020800.0), r, broadcast8(1.0 / 479001600.0));
  const V8 low4 = fma8(p23, r2, p01), next4 = fma8(p67, r2, p45), top6 = fma8(pcd, r4, fma8(pab, r2, p89));
  return scale_by_bits(fma8(fma8(top6, r4, next4), r4, low4), t);
}

}  // namespace
}  // namespace slipmode::kernels
