#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <vector>

namespace slipmode::figures {

/// Motion of one contact over a stretch of time.
struct TimeHistory {
  std::string contact;                                  ///< name for the title
  Eigen::VectorXd time, displacement, velocity, force;  ///< same length
  std::vector<std::pair<double, double>> stick;         ///< intervals in which the contact sticks, shaded
  std::string time_unit, displacement_unit, velocity_unit, force_unit;
};

/// Displacement, velocity and contact force one above the other, stick shaded.
[[nodiscard]] Figure time_history(const TimeHistory& history);

}  // namespace slipmode::figures
