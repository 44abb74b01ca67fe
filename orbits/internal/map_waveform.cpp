#include "orbits/internal/map_waveform.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::orbits::detail {

void Waveform::add(double y0, double slope0, double y1, double slope1) {
  if (count_ == 0) reference_ = y0;
  include(y0);
  include(y1);
  include_turning_points(y0, step_ * slope0, y1, step_ * slope1);
  // ∫f over a step to fourth order from values and slopes.
  const double a = y0 - reference_, b = y1 - reference_;
  sum_ += 0.5 * (a + b) + step_ / 12.0 * (slope0 - slope1);
  square_ += 0.5 * (a * a + b * b) + step_ / 6.0 * (a * slope0 - b * slope1);
  ++count_;
}

double Waveform::effective() const {
  const double mean = sum_ / static_cast<double>(count_);
  return std::sqrt(std::max(0.0, square_ / static_cast<double>(count_) - mean * mean));
}

void Waveform::include(double y) {
  low_ = std::min(low_, y);
  high_ = std::max(high_, y);
}

// Roots in (0, 1) of the derivative of the cubic with ends y0, y1 and end slopes d0, d1 per step.
void Waveform::include_turning_points(double y0, double d0, double y1, double d1) {
  const double c3 = 2.0 * (y0 - y1) + d0 + d1;
  const double c2 = 3.0 * (y1 - y0) - 2.0 * d0 - d1;
  const double discriminant = c2 * c2 - 3.0 * c3 * d0;
  if (discriminant < 0.0) return;
  const double w = -(c2 + std::copysign(std::sqrt(discriminant), c2));
  for (const double s : {w / (3.0 * c3), d0 / w}) {
    if (s > 0.0 && s < 1.0) include(y0 + s * (d0 + s * (c2 + s * c3)));
  }
}

}  // namespace slipmode::orbits::detail
