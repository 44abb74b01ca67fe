#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <vector>

namespace slipmode::figures {

/// Displacement against velocity of a contact over a stretch of time.
struct PhasePortrait {
  std::string title;
  Eigen::VectorXd displacement, velocity;  ///< same length; an entry that is not finite breaks the curve
  std::string_view colour;
};

struct PortraitLayout {
  int columns = 4;
  std::string displacement = "displacement", displacement_unit;
  std::string velocity = "velocity", velocity_unit;
  /// Same axes in all panels (levels of reduction, S4 Figure 3.7), or in each column (orbits, S4 Figure 3.8).
  enum class Axes { kShared, kPerColumn } axes = Axes::kShared;
};

/// Panels row by row, so that what is side by side or one above the other is on the same axes.
[[nodiscard]] Figure phase_portraits(const std::vector<PhasePortrait>& portraits, const PortraitLayout& layout);

}  // namespace slipmode::figures
