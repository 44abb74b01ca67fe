#include <slipmode/figures/recurrence_plot.hpp>

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <utility>
#include <vector>

namespace slipmode::figures {
namespace {

constexpr std::int64_t kMostShown = 800;

/// 1 where a pair recurs, both ways round.
Eigen::MatrixXd recurrence_cells(const RecurrencePlot& plot, std::int64_t shown) {
  Eigen::MatrixXd cells = Eigen::MatrixXd::Zero(shown, shown);
  for (std::size_t k = 0; k < plot.i.size(); ++k) {
    if (plot.i[k] >= shown || plot.j[k] >= shown) continue;
    cells(plot.i[k], plot.j[k]) = 1.0;
    cells(plot.j[k], plot.i[k]) = 1.0;
  }
  return cells;
}

}  // namespace

Figure recurrence_plot(const RecurrencePlot& plot) {
  Figure figure(900, 940);
  common_style(figure);
  const std::int64_t shown = std::min(kMostShown, plot.points);
  const Eigen::MatrixXd cells = recurrence_cells(plot, shown);
  const double span = static_cast<double>(shown) * plot.interval;
  Eigen::VectorXd x(cells.size()), y(cells.size()), z(cells.size());
  std::vector<double> recurs_x, recurs_y;
  for (Eigen::Index a = 0, k = 0; a < shown; ++a) {
    for (Eigen::Index b = 0; b < shown; ++b, ++k) {
      x(k) = plot.start + (static_cast<double>(b) + 0.5) * plot.interval;
      y(k) = plot.start + (static_cast<double>(a) + 0.5) * plot.interval;
      z(k) = cells(a, b);
      if (z(k) == 0.0) continue;
      recurs_x.push_back(x(k));
      recurs_y.push_back(y(k));
    }
  }
  const std::string range = fmt::format("[{:.9g}:{:.9g}]", plot.start, plot.start + span);
  figure.command("unset key; unset grid; unset colorbox; set size square");
  figure.command("set palette defined (0 '#FFFFFF', 1 '#111111'); set cbrange [0:1]");
  figure.command(fmt::format("set title \"{}\" offset 0,-0.5", literal(plot.title)));
  const std::string label = axis_label("time", plot.time_unit);
  figure.command(fmt::format("set xlabel \"{0}\"; set ylabel \"{0}\"", label));
  figure.command(fmt::format("set xrange {0}; set yrange {0}", range));
  figure.command(fmt::format("plot {} using 1:2:3 with image", figure.data({x, y, z})));
  Series pairs{.x = to_vector(recurs_x), .y = to_vector(recurs_y), .look = Series::Look::kDots, .colour = kFullColour};
  figure.show({.panels = {{.title = plot.title, .series = {std::move(pairs)}, .x_label = label, .y_label = label}}});
  return figure;
}

}  // namespace slipmode::figures
