#pragma once

#include <Eigen/Core>

namespace slipmode {

/// Eight doubles in one value: one AVX-512 register, or several narrower ones. The hot loops of the flow hold their
/// data in groups of eight (collocation nodes or modes), so that one operation serves all.
using V8 = double __attribute__((vector_size(64)));

/// Width of V8.
inline constexpr int kLanes = 8;

/// Eight doubles from 64-byte-aligned memory.
[[gnu::always_inline]] inline V8 load8(const double* aligned) { return *reinterpret_cast<const V8*>(aligned); }
[[gnu::always_inline]] inline void store8(double* aligned, const V8& value) { *reinterpret_cast<V8*>(aligned) = value; }
[[gnu::always_inline]] inline V8 broadcast8(double value) { return V8{} + value; }

/// |a| lane by lane.
[[gnu::always_inline]] inline V8 abs8(const V8& a) { return a < 0.0 ? -a : a; }
/// Largest lane.
[[gnu::always_inline]] inline double max8(const V8& a) {
  return Eigen::Map<const Eigen::Array<double, 8, 1>, Eigen::Aligned64>(reinterpret_cast<const double*>(&a)).maxCoeff();
}
/// Smallest lane.
[[gnu::always_inline]] inline double min8(const V8& a) {
  return Eigen::Map<const Eigen::Array<double, 8, 1>, Eigen::Aligned64>(reinterpret_cast<const double*>(&a)).minCoeff();
}
/// Sum of the lanes.
[[gnu::always_inline]] inline double sum8(const V8& a) {
  return Eigen::Map<const Eigen::Array<double, 8, 1>, Eigen::Aligned64>(reinterpret_cast<const double*>(&a)).sum();
}
/// e^a lane by lane (Eigen's packet exponential).
[[gnu::always_inline]] inline V8 exp8(const V8& a) {
  V8 out;
  Eigen::Map<Eigen::Array<double, 8, 1>, Eigen::Aligned64>(reinterpret_cast<double*>(&out)) =
      Eigen::Map<const Eigen::Array<double, 8, 1>, Eigen::Aligned64>(reinterpret_cast<const double*>(&a)).exp();
  return out;
}

/// `count` rounded up to a whole number of lanes.
constexpr Eigen::Index padded(Eigen::Index count) { return (count + kLanes - 1) / kLanes * kLanes; }

}  // namespace slipmode
