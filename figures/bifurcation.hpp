#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <vector>

namespace slipmode::figures {

/// One diagram: every recorded slip state against the parameter it was recorded at.
struct BifurcationPanel {
  std::string title;
  Eigen::VectorXd parameter, value;  ///< one entry per point, same length
  std::string_view colour;
  Eigen::VectorXd swept = {};  ///< all values gone through, which the axis spans; empty: those with points
};

struct BifurcationLabels {
  std::string parameter, parameter_unit;
  std::string value, value_unit;
  std::string none = {};  ///< what a panel without points says
};

/// Panels one above the other on shared axes (S4 Figure 3.9: full above reduced). Points that would fall on the same
/// spot are drawn once, so that the SVG of a chaotic sweep stays small; nothing visible is lost.
[[nodiscard]] Figure bifurcation_diagram(const std::vector<BifurcationPanel>& panels, const BifurcationLabels& labels);

}  // namespace slipmode::figures
