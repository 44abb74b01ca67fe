#pragma once

#include <slipmode/core/fields.hpp>

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipmode::figures {

/// A curve or a cloud of points in a panel.
struct Series {
  std::string title = {};  ///< for the legend; empty: none
  Eigen::VectorXd x, y;    ///< same length; an entry that is not finite breaks a curve
  enum class Look { kLine, kDashed, kDots, kMarkedLine, kPoints } look = Look::kLine;
  std::string_view colour;     ///< lives as long as the program
  Eigen::VectorXd error = {};  ///< half the height of a bar about each point; empty: none
};

/// A number over a plane of two parameters, as colours.
struct ColourField {
  Eigen::VectorXd x, y;                 ///< equally spaced
  Eigen::MatrixXd value;                ///< [y x x]; not finite: no value
  std::string label = {};               ///< of the values, as axis_label gives it
  double low = 0.0, high = 1.0;         ///< colours span this
  std::vector<std::string> words = {};  ///< what whole steps from low to high are called; empty: numbers
  std::string missing = {};             ///< what "no value" means
};

/// What a figure shows, apart from how gnuplot draws it: the interactive report and the Python package draw from it.
/// Titles are plain text, labels as axis_label gives them.
struct Drawing {
  struct Axes {
    std::string title = {};
    std::vector<Series> series = {};  ///< the last on top
    std::string x_label = {}, y_label = {};
    bool log_x = false, log_y = false;
    std::vector<std::pair<double, double>> shaded = {};  ///< stretches along x
    std::optional<ColourField> field = {};               ///< below the series
  };
  std::vector<Axes> panels = {};  ///< row by row; none: the figure does not tell
  int columns = 1;
  /// Which panels have one range, so that they can be compared by eye.
  enum class Shared { kNone, kAll, kRow, kColumn } x = Shared::kNone, y = Shared::kNone;
};

}  // namespace slipmode::figures

namespace slipmode {

template <>
inline constexpr std::array kWords<figures::Series::Look> = {"line", "dashed", "dots", "marked", "points"};
template <>
inline constexpr std::array kWords<figures::Drawing::Shared> = {"none", "all", "row", "column"};

}  // namespace slipmode
