#include <slipmode/figures/bifurcation.hpp>

#include <slipmode/figures/style.hpp>
#include "figures/internal/raster.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>

namespace slipmode::figures {
namespace {

/// Points on a raster finer than the dots: one per cell.
BifurcationPanel thinned(const BifurcationPanel& panel, const Range& x, const Range& y, double cells_x,
                         double cells_y) {
  const auto kept = one_per_cell(panel.parameter, panel.value, x, y, cells_x, cells_y);
  return {panel.title, panel.parameter(kept), panel.value(kept), panel.colour};
}

/// Dots a little wider than the distance of the values, so that a chaotic band is closed and a short sweep is visible.
/// In gnuplot's unit, which is about 12 pixels here.
double dot_size(const Eigen::VectorXd& parameter) {
  const std::set<double> values(parameter.begin(), parameter.end());
  const double spacing = 1050.0 / static_cast<double>(std::max<std::size_t>(values.size(), 1));
  return std::clamp(1.5 * spacing / 12.0, 0.16, 0.8);
}

/// Finer than gnuplot's, as a reader may zoom in.
Drawing diagram_drawing(const std::vector<BifurcationPanel>& panels, const BifurcationLabels& labels, const Range& x,
                        const Range& y) {
  constexpr double kCells = 2000.0;
  Drawing drawing{.panels = {}, .x = Drawing::Shared::kAll, .y = Drawing::Shared::kAll};
  for (const BifurcationPanel& panel : panels) {
    BifurcationPanel points = thinned(panel, x, y, kCells, kCells);
    drawing.panels.push_back({.title = panel.title,
                              .series = {{"", points.parameter, points.value, Series::Look::kDots, panel.colour}},
                              .x_label = axis_label(labels.parameter, labels.parameter_unit),
                              .y_label = axis_label(labels.value, labels.value_unit)});
  }
  return drawing;
}

}  // namespace

Figure bifurcation_diagram(const std::vector<BifurcationPanel>& panels, const BifurcationLabels& labels) {
  const int count = static_cast<int>(panels.size());
  const int panel_height = count == 1 ? 620 : 460;
  Figure figure(1200, panel_height * count + 85);
  common_style(figure);

  Range x, y;
  for (const auto& panel : panels) {
    x.include(panel.parameter);
    x.include(panel.swept);
    y.include(panel.value);
  }
  figure.show(diagram_drawing(panels, labels, x, y));
  const double bottom = 90.0 / figure.height(), top = 1.0 - 40.0 / figure.height();
  figure.command(fmt::format("set multiplot layout {},1 margins 0.125,0.975,{:.4f},{:.4f} spacing 0,{:.4f}", count,
                             bottom, top, 45.0 / figure.height()));
  figure.command("unset key");
  figure.command("set xrange " + padded_range(x.low, x.high, 0.012));
  figure.command("set yrange " + padded_range(y.low, y.high) + "; set format y '%g'");
  for (int i = 0; i < count; ++i) {
    const bool last = i + 1 == count;
    const BifurcationPanel points = thinned(panels[i], x, y, 1100.0, 0.5 * panel_height);
    const std::string block = figure.data({points.parameter, points.value});
    figure.command(fmt::format("set title \"{}\" offset 0,-0.6", literal(panels[i].title)));
    figure.command(fmt::format("set ylabel \"{}\"", axis_label(labels.value, labels.value_unit)));
    figure.command(last ? fmt::format("set xlabel \"{}\"", axis_label(labels.parameter, labels.parameter_unit))
                        : std::string("unset xlabel"));
    figure.command(last ? "set format x '%g'" : "set format x ''");
    figure.command(fmt::format("set label 1 \"{}\" at graph 0.5,0.5 center",
                               points.parameter.size() == 0 ? literal(labels.none) : ""));
    figure.command(fmt::format("plot {} using 1:2 with points pointtype 7 pointsize {:.3f} linecolor rgb '{}'", block,
                               dot_size(panels[i].parameter), points.colour));
  }
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
