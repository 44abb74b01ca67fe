#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace slipmode::figures {

/// One branch of orbits, in order along it.
struct ResponseBranch {
  std::string title;                 ///< for the legend; empty: none
  Eigen::VectorXd parameter, value;  ///< same length
  std::vector<bool> stable;          ///< one per point
  std::string_view colour;
  /// Half the height of a band about it, in the order of the points: NaN where it is not known (the band goes straight
  /// on), infinite where there is none (it ends). Empty: no band.
  Eigen::VectorXd band = {};
};

/// A point of a branch where it changes its kind.
struct ResponseMark {
  std::string kind;  ///< each kind has its symbol and its entry in the legend
  double parameter = 0.0, value = 0.0;
};

struct ResponseLabels {
  std::string parameter, value;  ///< as axis_label gives them
};

/// Branches over a parameter: stable orbits solid, unstable ones dashed, special points marked (S0 Figures 4.1, 4.13).
[[nodiscard]] Figure response_diagram(const std::vector<ResponseBranch>& branches,
                                      const std::vector<ResponseMark>& marks, const ResponseLabels& labels);

/// Multipliers in the complex plane with the unit circle. @param parts  multiplier x (real, imaginary)
[[nodiscard]] Figure multiplier_plane(const Eigen::MatrixXd& parts, const std::string& title);

}  // namespace slipmode::figures
