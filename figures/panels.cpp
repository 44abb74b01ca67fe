#include <slipmode/figures/panels.hpp>

#include <slipmode/figures/style.hpp>
#include "figures/internal/raster.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::figures {
namespace {

std::string range_text(const Range& range, bool log) {
  if (!log) return padded_range(range.low, range.high);
  if (!(range.high > 0.0) || !std::isfinite(range.low)) return "[1e-3:1]";
  return fmt::format("[{:.3g}:{:.3g}]", 0.7 * range.low, 1.4 * range.high);
}

struct Ranges {
  Range x, y;
  void include(const Panel& panel, bool log_y) {
    for (const Series& series : panel.series) {
      x.include(series.x, false);
      y.include(series.y, log_y);
    }
  }
};

/// One point per cell of a raster.
Series thinned(const Series& series, const Ranges& ranges) {
  constexpr double kCellsX = 700.0, kCellsY = 350.0;
  const auto kept = one_per_cell(series.x, series.y, ranges.x, ranges.y, kCellsX, kCellsY);
  return {series.title, series.x(kept), series.y(kept), series.look, series.colour};
}

std::string style_of(const Series& series) {
  switch (series.look) {
    case Series::Look::kLine:
      return fmt::format("with lines linewidth 1.3 linecolor rgb '{}'", series.colour);
    case Series::Look::kDashed:
      return fmt::format("with lines dashtype 2 linewidth 1.6 linecolor rgb '{}'", series.colour);
    case Series::Look::kDots:
      return fmt::format("with points pointtype 7 pointsize 0.25 linecolor rgb '{}'", series.colour);
    case Series::Look::kPoints:
      return fmt::format("with points pointtype 7 pointsize 0.55 linecolor rgb '{}'", series.colour);
    case Series::Look::kMarkedLine:
      break;
  }
  return fmt::format("with linespoints pointtype 7 pointsize 0.8 linewidth 1.5 linecolor rgb '{}'", series.colour);
}

std::string plot_of(Figure& figure, const Panel& panel, const Ranges& ranges) {
  std::string plot;
  for (const Series& series : panel.series) {
    if (series.x.size() == 0) continue;
    const bool dots = series.look == Series::Look::kDots;
    const Series drawn = dots ? thinned(series, ranges) : series;
    const std::string name = series.title.empty() ? "notitle" : fmt::format("title \"{}\"", literal(series.title));
    plot += fmt::format("{}{} using 1:2 {} {}", plot.empty() ? "plot " : ", ", figure.data({drawn.x, drawn.y}),
                        style_of(series), name);
  }
  return plot.empty() ? "plot NaN notitle" : plot;
}

Drawing drawing_of(const std::vector<Panel>& panels, const PanelLayout& layout) {
  using enum Drawing::Shared;
  Drawing drawing{.panels = {},
                  .columns = layout.columns,
                  .x = layout.shared_x ? kAll : kNone,
                  .y = layout.shared_y ? kAll : kNone};
  for (const Panel& panel : panels) {
    drawing.panels.push_back({.title = panel.title,
                              .series = panel.series,
                              .x_label = panel.x_label.empty() ? layout.x_label : panel.x_label,
                              .y_label = layout.y_label,
                              .log_y = layout.log_y});
  }
  return drawing;
}

}  // namespace

Figure panel_grid(const std::vector<Panel>& panels, const PanelLayout& layout) {
  const int count = static_cast<int>(panels.size());
  const int columns = std::min(layout.columns, std::max(count, 1));
  const int rows = (count + columns - 1) / columns;
  // Above narrow panels entries of the legend stand one below the other; a third needs more room than titles leave.
  const auto entries = panels.empty() ? 0 : std::ranges::count_if(panels.front().series, [](const Series& own) {
    return !own.title.empty();
  });
  const int above = 95 + (columns > 2 ? 25 * std::max<int>(0, static_cast<int>(entries) - 2) : 0);
  Figure figure(1200, rows * layout.panel_height + 75 + above);
  common_style(figure);
  figure.show(drawing_of(panels, layout));
  Ranges all;
  for (const Panel& panel : panels) all.include(panel, layout.log_y);
  const double height = figure.height();
  const double gap_x = columns == 1 ? 0.0 : (layout.shared_y ? 0.03 : 0.085);
  figure.command(fmt::format("set multiplot layout {},{} margins 0.14,0.98,{:.4f},{:.4f} spacing {:.3f},{:.4f}", rows,
                             columns, 75.0 / height, 1.0 - above / height, gap_x,
                             (layout.shared_x ? 45.0 : 90.0) / height));
  if (layout.log_y) figure.command("set logscale y; set format y '%.0e'");
  for (int i = 0; i < count; ++i) {
    Ranges ranges = all, own;
    own.include(panels[static_cast<std::size_t>(i)], layout.log_y);
    if (!layout.shared_x) ranges.x = own.x;
    if (!layout.shared_y) ranges.y = own.y;
    const bool left = i % columns == 0, below = i + columns >= count;
    figure.command(i == 0 ? std::string(layout.legend.empty() ? kLegendAbove : layout.legend) : "unset key");
    figure.command(
        fmt::format("set xrange {}; set yrange {}", range_text(ranges.x, false), range_text(ranges.y, layout.log_y)));
    figure.command(x_tics(ranges.x.low, ranges.x.high, columns));
    figure.command(fmt::format("set title \"{}\" offset 0,-0.7", literal(panels[static_cast<std::size_t>(i)].title)));
    figure.command(left ? fmt::format("set ylabel \"{}\"", layout.y_label) : std::string("unset ylabel"));
    if (layout.shared_y) {
      figure.command(!left ? "set format y ''" : layout.log_y ? "set format y '%.0e'" : "set format y '%g'");
    }
    const std::string& own_label = panels[static_cast<std::size_t>(i)].x_label;
    const std::string x_label = own_label.empty() && below ? layout.x_label : own_label;
    figure.command(x_label.empty() ? std::string("unset xlabel") : fmt::format("set xlabel \"{}\"", x_label));
    if (layout.shared_x) figure.command(below ? "set format x '%g'" : "set format x ''");
    figure.command(plot_of(figure, panels[static_cast<std::size_t>(i)], ranges));
  }
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
