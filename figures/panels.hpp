#pragma once

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/gnuplot.hpp>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace slipmode::figures {

/// One pair of axes.
struct Panel {
  std::string title;
  std::vector<Series> series;  ///< drawn in this order, the last on top
  std::string x_label = {};    ///< empty: the layout's, below the lowest row only
};

/// How panels stand together.
struct PanelLayout {
  int columns = 1;
  int panel_height = 300;                  ///< [pixels]
  std::string x_label = {}, y_label = {};  ///< as axis_label gives them
  bool shared_x = true;                    ///< one range for all panels
  bool shared_y = true;
  bool log_y = false;
  std::string_view legend = {};  ///< gnuplot's `set key …`; empty: the figure's top right
};

/// Panels in rows, axes labelled at the left and below. Dots are thinned on a raster finer than they are.
[[nodiscard]] Figure panel_grid(const std::vector<Panel>& panels, const PanelLayout& layout);

}  // namespace slipmode::figures
