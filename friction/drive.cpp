#include <slipmode/friction/drive.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::friction {

double Belt::velocity(double t) const {
  if (is_constant() || t <= ramp_begin) return speed;
  if (t >= ramp_end) return end_speed;
  const double share = (t - ramp_begin) / (ramp_end - ramp_begin);
  return (1.0 - share) * speed + share * end_speed;
}

double Belt::acceleration(double t) const {
  if (is_constant() || t < ramp_begin || t >= ramp_end) return 0.0;
  return (end_speed - speed) / (ramp_end - ramp_begin);
}

std::optional<double> Belt::next_corner(double t) const {
  if (is_constant() || t >= ramp_end) return std::nullopt;
  return t < ramp_begin ? ramp_begin : ramp_end;
}

double Shaker::omega() const { return 2.0 * std::numbers::pi * frequency_hz; }

double Shaker::period() const { return 1.0 / frequency_hz; }

double Shaker::displacement(double t) const { return amplitude * std::sin(omega() * t + phase); }

double Shaker::velocity(double t) const { return amplitude * omega() * std::cos(omega() * t + phase); }

double Shaker::acceleration(double t) const { return -omega() * omega() * displacement(t); }

double Shaker::next_upward_zero(double t) const {
  // cos(ω t + φ) rises through zero at ω t + φ = −π/2 + 2πk.
  const double turns = t * frequency_hz + phase / (2.0 * std::numbers::pi) + 0.25;
  const double k = std::floor(turns) + 1.0;
  return (k - 0.25 - phase / (2.0 * std::numbers::pi)) / frequency_hz;
}

double Force::period() const { return 2.0 * std::numbers::pi / omega; }

double Force::value(int direction, double t) const {
  double sum = 0.0;
  for (const ForceHarmonic& h : harmonics)
    if (h.direction == direction) sum += h.amplitude * std::sin(h.order * omega * t + h.phase);
  return sum;
}

double Force::rate(int direction, double t) const {
  double sum = 0.0;
  for (const ForceHarmonic& h : harmonics)
    if (h.direction == direction) sum += h.amplitude * h.order * omega * std::cos(h.order * omega * t + h.phase);
  return sum;
}

std::optional<double> Drive::period() const {
  if (shaker()) return shaker()->period();
  if (force()) return force()->period();
  return std::nullopt;
}

double Drive::omega() const {
  if (shaker()) return shaker()->omega();
  return force() ? force()->omega : 0.0;
}

double Drive::frequency_hz() const {
  if (shaker()) return shaker()->frequency_hz;
  return force() ? 1.0 / force()->period() : 0.0;
}

double Drive::section_time() const { return shaker() ? shaker()->next_upward_zero(0.0) : 0.0; }

namespace {

void check_finite(const char* drive, const char* key, double value) {
  if (!std::isfinite(value)) throw InvalidInput(fmt::format("{}: {} = {}; expected a finite value", drive, key, value));
}

void validate(const Belt& belt) {
  check_finite("belt", "speed", belt.speed);
  check_finite("belt", "end_speed", belt.end_speed);
  check_finite("belt", "ramp_begin", belt.ramp_begin);
  check_finite("belt", "ramp_end", belt.ramp_end);
  if (belt.ramp_end < belt.ramp_begin) {
    throw InvalidInput(fmt::format("belt: ramp_end = {} is before ramp_begin = {}; expected ramp_end >= ramp_begin",
                                   belt.ramp_end, belt.ramp_begin));
  }
}

void validate(const Shaker& shaker) {
  check_finite("shaker", "amplitude", shaker.amplitude);
  check_finite("shaker", "frequency_hz", shaker.frequency_hz);
  check_finite("shaker", "phase", shaker.phase);
  if (shaker.amplitude < 0.0)
    throw InvalidInput(fmt::format("shaker: amplitude = {}; expected >= 0", shaker.amplitude));
  if (!(shaker.frequency_hz > 0.0))
    throw InvalidInput(fmt::format("shaker: frequency_hz = {}; expected > 0", shaker.frequency_hz));
}

void validate(const Force& force) {
  check_finite("force", "omega", force.omega);
  if (!(force.omega > 0.0)) throw InvalidInput(fmt::format("force: omega = {}; expected > 0", force.omega));
  for (const ForceHarmonic& h : force.harmonics) {
    check_finite("force", "amplitude", h.amplitude);
    check_finite("force", "phase", h.phase);
    if (h.order < 1) throw InvalidInput(fmt::format("force: harmonic of order {}; expected an integer >= 1", h.order));
    if (h.direction < 0)
      throw InvalidInput(fmt::format("force: direction {}; expected the number of a direction, >= 0", h.direction));
  }
}

}  // namespace

void validate(const Drive& drive) {
  if (drive.belt()) validate(*drive.belt());
  if (drive.shaker()) validate(*drive.shaker());
  if (drive.force()) validate(*drive.force());
}

}  // namespace slipmode::friction
