#pragma once

#include <slipmode/dynamics/simulate.hpp>

#include <cstddef>
#include <vector>

namespace slipmode::selftest {

/// The modes of one contact over time, rebuilt from a run's events. The end of a flight beyond a stop is no event:
/// flights count as the gap.
class Timeline {
 public:
  Timeline(const dynamics::Trajectory& run, int contact);
  [[nodiscard]] dynamics::ContactMode at(double t) const;
  /// The mode that ends at times()[i].
  [[nodiscard]] dynamics::ContactMode before(std::size_t i) const { return modes_[i]; }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }

 private:
  std::vector<double> times_;
  std::vector<dynamics::ContactMode> modes_;
  bool broken_ = false;
};

}  // namespace slipmode::selftest
