#include <slipmode/figures/deviation.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace slipmode::figures {
namespace {

/// Below this a deviation [%] is rounding (all modes kept), which would stretch a logarithmic axis; it is left out.
constexpr double kSmallest = 1e-5;

Eigen::VectorXd drawable(const Eigen::VectorXd& values) {
  Eigen::VectorXd out = values.cwiseAbs();
  for (double& value : out) {
    if (!(value > kSmallest)) value = std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

/// Whole decades around all curves, so that the columns can be compared by eye.
std::string decades(const std::vector<DeviationCase>& cases, Eigen::VectorXd DeviationCurve::*measure) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const auto& motion : cases) {
    for (const auto& curve : motion.curves) {
      for (const double value : drawable(curve.*measure)) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  }
  if (!(high > 0.0)) return "[1e-9:1]";
  return fmt::format("[1e{}:1e{}]", static_cast<int>(std::floor(std::log10(low))),
                     static_cast<int>(std::floor(std::log10(high))) + 1);
}

std::string curves(Figure& figure, const DeviationCase& motion, Eigen::VectorXd DeviationCurve::*measure) {
  std::string plot;
  int point = 7;
  for (const DeviationCurve& curve : motion.curves) {
    plot += fmt::format(
        "{} {} using 1:2 with linespoints pointtype {} linewidth 1.6 dashtype {} linecolor rgb '{}' "
        "title \"{}\"",
        plot.empty() ? "plot" : ",", figure.data({curve.modes, drawable(curve.*measure)}), point, point == 7 ? 1 : 2,
        curve.colour, literal(curve.name));
    point = 4;
  }
  return plot;
}

Drawing deviation_drawing(const std::vector<DeviationCase>& cases) {
  Drawing drawing{
      .panels = {}, .columns = static_cast<int>(cases.size()), .x = Drawing::Shared::kAll, .y = Drawing::Shared::kRow};
  for (const bool upper : {true, false}) {
    for (const DeviationCase& motion : cases) {
      Drawing::Axes axes{.title = motion.title,
                         .x_label = "number of modes, L",
                         .y_label = upper ? "ΔX [%]" : "|ΔE| [%]",
                         .log_y = true};
      for (const DeviationCurve& curve : motion.curves)
        axes.series.push_back({curve.name, curve.modes, drawable(upper ? curve.delta_x : curve.delta_e),
                               Series::Look::kMarkedLine, curve.colour});
      drawing.panels.push_back(std::move(axes));
    }
  }
  return drawing;
}

}  // namespace

Figure deviation(const std::vector<DeviationCase>& cases) {
  const int columns = static_cast<int>(cases.size());
  Figure figure(1200, 860);
  common_style(figure);
  figure.show(deviation_drawing(cases));
  double most = 1.0;
  for (const auto& motion : cases) {
    for (const auto& curve : motion.curves) most = std::max(most, curve.modes.maxCoeff());
  }
  figure.command(fmt::format("set multiplot layout 2,{} margins 0.085,0.985,0.108,0.915 spacing 0.03,0.05", columns));
  figure.command(fmt::format("set xrange [0.5:{}]", most + 0.5));
  figure.command(most <= 20 ? "set xtics 1" : "set xtics auto");
  figure.command("set logscale y");
  for (const bool upper : {true, false}) {
    const auto measure = upper ? &DeviationCurve::delta_x : &DeviationCurve::delta_e;
    figure.command("set yrange " + decades(cases, measure));
    for (int i = 0; i < columns; ++i) {
      figure.command(i == 0 ? "set format y '10^{%L}'" : "set format y ''");
      figure.command(upper ? fmt::format("set title \"{}\" offset 0,-0.5", literal(cases[i].title))
                           : std::string("unset title"));
      figure.command(i == 0 ? fmt::format("set ylabel \"{} [%]\"", upper ? "ΔX" : "|ΔE|")
                            : std::string("unset ylabel"));
      figure.command(upper ? "unset xlabel; set format x ''" : "set xlabel \"number of modes, L\"; set format x '%g'");
      figure.command(upper && i == 0 ? kLegendAbove : "unset key");
      figure.command(curves(figure, cases[i], measure));
    }
  }
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
