#pragma once

#include <slipmode/core/fields.hpp>

#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace slipmode::friction {

/// A belt under the contacts: constant speed, or a linear ramp from `speed` to `end_speed` over
/// [ramp_begin, ramp_end], constant before and after.
struct Belt {
  double speed = 0.0, end_speed = 0.0, ramp_begin = 0.0, ramp_end = 0.0;

  static constexpr auto fields() {
    return std::tuple{
        required("from", &Belt::speed, "m/s", "speed at the start").stored_as("speed"),
        required("to", &Belt::end_speed, "m/s", "speed after the ramp").stored_as("end_speed"),
        required("begin", &Belt::ramp_begin, "s", "start of the ramp", kNonNegative).stored_as("ramp_begin"),
        required("end", &Belt::ramp_end, "s", "end of the ramp; not after ramp_begin: no ramp", kNonNegative)
            .stored_as("ramp_end")};
  }

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
  double amplitude = 0.0, frequency_hz = 1.0, phase = 0.0;

  static constexpr auto fields() {
    return std::tuple{required("amplitude", &Shaker::amplitude, "m", "amplitude", kNonNegative),
                      required("frequency", &Shaker::frequency_hz, "Hz", "frequency", kPositive),
                      optional("phase", &Shaker::phase, "rad", "phase at time 0")};
  }

  [[nodiscard]] double omega() const;                 ///< [rad/s]
  [[nodiscard]] double period() const;                ///< [s]
  [[nodiscard]] double displacement(double t) const;  ///< d [m]
  [[nodiscard]] double velocity(double t) const;      ///< d' [m/s]
  [[nodiscard]] double acceleration(double t) const;  ///< d'' [m/s²]
  /// The first time > t at which the velocity passes zero upward: where Poincaré sections are taken (S4 section 6.3.2).
  [[nodiscard]] double next_upward_zero(double t) const;
};

/// One harmonic of a force: amplitude sin(order · ωt + phase) along a direction.
struct ForceHarmonic {
  double amplitude = 0.0, phase = 0.0;
  int order = 1;
  int direction = 0;  ///< column of HybridSystem::force_directions

  static constexpr auto fields() {
    using Own = ForceHarmonic;
    return std::tuple{required("amplitude", &Own::amplitude, "N", "of each harmonic"),
                      required("phase", &Own::phase, "rad", "of each harmonic at time 0"),
                      required("order", &Own::order, "", "of each harmonic", kCount),
                      required("direction", &Own::direction, "",
                               "row of force_directions each harmonic acts along, from 0", kFromZero)};
  }
};

/// A periodic force on the structure; contacts' counterparts rest. Its mean is the structure's constant load.
struct Force {
  double omega = 1.0;
  std::vector<ForceHarmonic> harmonics = {};

  static constexpr auto fields() {
    return std::tuple{required("omega", &Force::omega, "rad/s", "angular frequency of order 1", kPositive)};
  }

  [[nodiscard]] double period() const;  ///< [s]
  /// Force along a direction at t, and its time derivative.
  [[nodiscard]] double value(int direction, double t) const;  ///< [N]
  [[nodiscard]] double rate(int direction, double t) const;   ///< [N/s]
};

/// What drives a system: the motion of the contacts' counterpart, or a force on the structure.
class Drive {
 public:
  Drive() = default;
  Drive(Belt belt) : kind_(belt) {}                // NOLINT(google-explicit-constructor): a belt is a drive
  Drive(Shaker shaker) : kind_(shaker) {}          // NOLINT(google-explicit-constructor)
  Drive(Force force) : kind_(std::move(force)) {}  // NOLINT(google-explicit-constructor)

  /// The belt, or null.
  [[nodiscard]] const Belt* belt() const { return std::get_if<Belt>(&kind_); }
  /// The shaker, or null.
  [[nodiscard]] const Shaker* shaker() const { return std::get_if<Shaker>(&kind_); }
  /// The force, or null.
  [[nodiscard]] const Force* force() const { return std::get_if<Force>(&kind_); }
  /// Period of a shaker or a force; a belt has none [s].
  [[nodiscard]] std::optional<double> period() const;
  /// Angular frequency of a shaker or a force; 0 for a belt [rad/s].
  [[nodiscard]] double omega() const;

  /// A time from 0 on at which its Poincaré sections are taken, a period apart: the velocity of a shaker passes zero
  /// upward there (S4 section 6.3.2); 0 for a force, whose ω t is a whole number of turns then, and for a belt [s].
  [[nodiscard]] double section_time() const;
  /// ω/2π; 0 for a belt [Hz].
  [[nodiscard]] double frequency_hz() const;

  /// True for a belt of constant speed.
  [[nodiscard]] bool is_constant() const { return belt() != nullptr && belt()->is_constant(); }
  /// Velocity of the counterpart at t [m/s].
  [[nodiscard]] double velocity(double t) const {
    return belt() ? belt()->velocity(t) : shaker() ? shaker()->velocity(t) : 0.0;
  }
  /// Its acceleration just after t (right limit) [m/s²].
  [[nodiscard]] double acceleration(double t) const {
    return belt() ? belt()->acceleration(t) : shaker() ? shaker()->acceleration(t) : 0.0;
  }
  /// The size of its velocity around t, which its rounding error is measured by: the amplitude of a shaker's [m/s].
  [[nodiscard]] double velocity_scale(double t) const {
    return shaker() ? shaker()->amplitude * shaker()->omega() : std::abs(velocity(t));
  }
  /// The first time > t at which the acceleration jumps, if any.
  [[nodiscard]] std::optional<double> next_corner(double t) const {
    return belt() ? belt()->next_corner(t) : std::nullopt;
  }

 private:
  std::variant<Belt, Shaker, Force> kind_ = Belt{};
};

/// @throws InvalidInput  if a value is not finite, ramp_end < ramp_begin, a shaker's amplitude < 0, a frequency ≤ 0, or
/// a
///                       harmonic's order < 1 or direction < 0
void validate(const Drive& drive);

}  // namespace slipmode::friction
