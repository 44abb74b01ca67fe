#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slipmode::figures {

/// A number over a plane of two parameters.
struct HeatMapPanel {
  std::string title;
  Eigen::VectorXd x, y;   ///< equally spaced, ascending or descending
  Eigen::MatrixXd value;  ///< [y x x]; not finite: no value
  /// Lines drawn over it; a point that is not finite breaks one.
  Eigen::VectorXd line_x = {}, line_y = {};
};

struct HeatMapLayout {
  std::string x_label, y_label, value_label;  ///< as axis_label gives them
  double low = 0.0, high = 1.0;               ///< colours span this; values beyond take the end's colour
  enum class Colours {
    kSequential,  ///< dark to light, for counts and sizes
    kGrey,        ///< black at `low` to white at `high`, as S0 draws multipliers
  } colours = Colours::kSequential;
  int steps = 0;                        ///< > 0: so many distinct colours between low and high, for counts
  std::vector<std::string> words = {};  ///< what the steps are called, where they are no numbers
  std::string missing = {};             ///< what "no value" means, for the colour bar; empty: "none"
};

/// Panels side by side on shared axes and colours. A point without a value is drawn in a colour outside the scale.
[[nodiscard]] Figure heat_maps(const std::vector<HeatMapPanel>& panels, const HeatMapLayout& layout);

}  // namespace slipmode::figures
