#pragma once

#include <cmath>
#include <optional>
#include <variant>

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

/// A slider that is shaken under the contacts: d = amplitude sin(ω t + phase), ω = 2π frequency_hz.
struct Shaker {
  double amplitude = 0.0;     ///< ≥ 0 [m]
  double frequency_hz = 1.0;  ///< > 0
  double phase = 0.0;         ///< [rad]

  [[nodiscard]] double omega() const;                 ///< [rad/s]
  [[nodiscard]] double period() const;                ///< [s]
  [[nodiscard]] double displacement(double t) const;  ///< d [m]
  [[nodiscard]] double velocity(double t) const;      ///< d' [m/s]
  [[nodiscard]] double acceleration(double t) const;  ///< d'' [m/s²]
  /// The first time > t at which the velocity passes zero upward: where Poincaré sections are taken (S4 section 6.3.2).
  [[nodiscard]] double next_upward_zero(double t) const;
};

/// What moves the contacts' counterpart.
class Drive {
 public:
  Drive() = default;
  Drive(Belt belt) : kind_(belt) {}        // NOLINT(google-explicit-constructor): a belt is a drive
  Drive(Shaker shaker) : kind_(shaker) {}  // NOLINT(google-explicit-constructor)

  /// The belt, or null.
  [[nodiscard]] const Belt* belt() const { return std::get_if<Belt>(&kind_); }
  /// The shaker, or null.
  [[nodiscard]] const Shaker* shaker() const { return std::get_if<Shaker>(&kind_); }

  /// True for a belt of constant speed.
  [[nodiscard]] bool is_constant() const { return belt() != nullptr && belt()->is_constant(); }
  /// Velocity of the counterpart at t [m/s].
  [[nodiscard]] double velocity(double t) const { return belt() ? belt()->velocity(t) : shaker()->velocity(t); }
  /// Its acceleration just after t (right limit) [m/s²].
  [[nodiscard]] double acceleration(double t) const {
    return belt() ? belt()->acceleration(t) : shaker()->acceleration(t);
  }
  /// The size of its velocity around t, which its rounding error is measured by: the amplitude of a shaker's [m/s].
  [[nodiscard]] double velocity_scale(double t) const {
    return shaker() ? shaker()->amplitude * shaker()->omega() : std::abs(velocity(t));
  }
  /// The way it goes from t0 to t1 [m].
  [[nodiscard]] double way(double t0, double t1) const;
  /// The first time > t at which the acceleration jumps, if any.
  [[nodiscard]] std::optional<double> next_corner(double t) const {
    return belt() ? belt()->next_corner(t) : std::nullopt;
  }

 private:
  std::variant<Belt, Shaker> kind_ = Belt{};
};

/// @throws InvalidInput  if a value is not finite, ramp_end < ramp_begin, amplitude < 0 or frequency ≤ 0
void validate(const Drive& drive);

}  // namespace slipmode::friction
