#include "friction/drive.hpp"

#include "core/errors.hpp"

#include <fmt/format.h>
#include <cmath>

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

void validate(const Belt& belt) {
  const auto check_finite = [](const char* key, double value) {
    if (!std::isfinite(value)) throw InvalidInput(fmt::format("belt: {} = {}; expected a finite value", key, value));
  };
  check_finite("speed", belt.speed);
  check_finite("end_speed", belt.end_speed);
  check_finite("ramp_begin", belt.ramp_begin);
  check_finite("ramp_end", belt.ramp_end);
  if (belt.ramp_end < belt.ramp_begin) {
    throw InvalidInput(fmt::format("belt: ramp_end = {} is before ramp_begin = {}; expected ramp_end >= ramp_begin",
                                   belt.ramp_end, belt.ramp_begin));
  }
}

}  // namespace slipmode::friction
