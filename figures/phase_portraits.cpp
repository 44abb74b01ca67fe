#include <slipmode/figures/phase_portraits.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::figures {
namespace {

struct Box {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double low = left, high = -left;

  void include(const PhasePortrait& portrait) {
    for (Eigen::Index i = 0; i < portrait.displacement.size(); ++i) {
      const double x = portrait.displacement[i], y = portrait.velocity[i];
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
};

Drawing portraits_drawing(const std::vector<PhasePortrait>& portraits, const PortraitLayout& layout) {
  const Drawing::Shared shared =
      layout.axes == PortraitLayout::Axes::kShared ? Drawing::Shared::kAll : Drawing::Shared::kColumn;
  Drawing drawing{.panels = {}, .columns = layout.columns, .x = shared, .y = shared};
  for (const PhasePortrait& portrait : portraits)
    drawing.panels.push_back(
        {.title = portrait.title,
         .series = {{"", portrait.displacement, portrait.velocity, Series::Look::kLine, portrait.colour}},
         .x_label = axis_label(layout.displacement, layout.displacement_unit),
         .y_label = axis_label(layout.velocity, layout.velocity_unit)});
  return drawing;
}

}  // namespace

Figure phase_portraits(const std::vector<PhasePortrait>& portraits, const PortraitLayout& layout) {
  const int count = static_cast<int>(portraits.size());
  const int columns = std::min(layout.columns, count);
  const int rows = (count + columns - 1) / columns;
  const int panel_height = columns <= 2 ? 480 : 370;
  Figure figure(1200, rows * panel_height + 60);
  common_style(figure);
  figure.show(portraits_drawing(portraits, layout));

  const bool shared_axes = layout.axes == PortraitLayout::Axes::kShared;
  std::vector<Box> boxes(columns);
  for (int i = 0; i < count; ++i) {
    for (int column = 0; column < columns; ++column) {
      if (shared_axes || column == i % columns) boxes[column].include(portraits[i]);
    }
  }

  const double height = figure.height();
  figure.command(fmt::format("set multiplot layout {},{} margins 0.11,0.985,{:.4f},{:.4f} spacing {},{:.4f}", rows,
                             columns, 95.0 / height, 1.0 - 45.0 / height, shared_axes ? 0.02 : 0.065, 85.0 / height));
  figure.command("unset key");
  for (int i = 0; i < count; ++i) {
    const Box& box = boxes[i % columns];
    const bool lowest = i + columns >= count;
    if (shared_axes) figure.command(i % columns == 0 ? "set format y '%g'" : "set format y ''");
    const std::string block = figure.data({portraits[i].displacement, portraits[i].velocity});
    figure.command(fmt::format("set title \"{}\" offset 0,-0.6", literal(portraits[i].title)));
    figure.command("set xrange " + padded_range(box.left, box.right));
    figure.command(x_tics(box.left, box.right, columns));
    figure.command("set yrange " + padded_range(box.low, box.high, 0.06));
    figure.command(i % columns == 0
                       ? fmt::format("set ylabel \"{}\"", axis_label(layout.velocity, layout.velocity_unit))
                       : std::string("unset ylabel"));
    figure.command(lowest ? fmt::format("set xlabel \"{}\"", axis_label(layout.displacement, layout.displacement_unit))
                          : std::string("unset xlabel"));
    figure.command(
        fmt::format("plot {} using 1:2 with lines linewidth 0.7 linecolor rgb '{}'", block, portraits[i].colour));
  }
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
