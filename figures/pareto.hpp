#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <vector>

namespace slipmode::figures {

/// One configuration as a point.
struct ParetoPoint {
  std::string name;       ///< written beside it on the front
  std::string group;      ///< each has its symbol and colour, in order of appearance
  double cost = 0.0;      ///< [ms]
  double error = 0.0;     ///< [%]
  double resolved = 0.0;  ///< error or its scatter, the larger of the two: what the front is made of [%]
  bool on_front = false;
};

/// How a front is labelled.
struct ParetoLabels {
  std::string title, cost, error;  ///< as axis_label gives them
  double noise = 0.0;              ///< drawn as a band: errors within are scatter; 0: none [%]
};

/// Error over time, both logarithmic, with the front as steps. Points without error, or with less than 1e-7 of the
/// largest, stand on the lower edge; those that are not finite are left out.
[[nodiscard]] Figure pareto_diagram(const std::vector<ParetoPoint>& points, const ParetoLabels& labels);

}  // namespace slipmode::figures
