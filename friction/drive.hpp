#pragma once

#include <optional>

namespace slipmode::friction {

/// A belt under the contacts: constant speed, or a linear ramp from `speed` to `end_speed` over
/// [ramp_begin, ramp_end], constant before and after.
struct Belt {
  double speed = 0.0;                       ///< [m/s]; may be 0 or negative
  double end_speed = 0.0;                   ///< used only when ramp_end > ramp_begin
  double ramp_begin = 0.0, ramp_end = 0.0;  ///< [s]

  [[nodiscard]] static Belt constant(double speed) { return {speed, speed, 0.0, 0.0}; }
  [[nodiscard]] static Belt ramp(double from, double to, double begin, double end) { return {from, to, begin, end}; }

  [[nodiscard]] bool is_constant() const { return !(ramp_end > ramp_begin) || end_speed == speed; }
  /// Belt speed at t. At a corner the value is continuous.
  [[nodiscard]] double velocity(double t) const;
  /// Belt acceleration just after t (right limit).
  [[nodiscard]] double acceleration(double t) const;
  /// The first time > t at which the acceleration jumps, if any.
  [[nodiscard]] std::optional<double> next_corner(double t) const;
};

/// What excites the contacts. One kind so far; others (shaker, force) join the variant when a scene needs them.
using Drive = Belt;

/// @throws InvalidInput  if a value is not finite or ramp_end < ramp_begin
void validate(const Belt& belt);

}  // namespace slipmode::friction
