#pragma once

#include <cstdint>
#include <limits>

/// Inside of strobe_map.cpp and orbit_map.cpp.
namespace slipmode::orbits::detail {

/// Size of a displacement from its values and slopes at equal steps h, by the cubic through both ends of each step.
/// Extremes miss by h⁴/384 max |y⁗| at most where the motion is smooth.
class Waveform {
 public:
  explicit Waveform(double step) : step_(step) {}

  /// One step. @param slope0, slope1  dy/dt at its ends
  void add(double y0, double slope0, double y1, double slope1);

  /// (max − min)/2.
  [[nodiscard]] double alternating() const { return 0.5 * (high_ - low_); }
  /// Root of the mean square about the mean.
  [[nodiscard]] double effective() const;

 private:
  void include(double y);
  void include_turning_points(double y0, double d0, double y1, double d1);

  double step_;
  double reference_ = 0.0;  ///< subtracted, so that a mean far from zero does not cost digits
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
  double sum_ = 0.0, square_ = 0.0;
  std::int64_t count_ = 0;
};

}  // namespace slipmode::orbits::detail
