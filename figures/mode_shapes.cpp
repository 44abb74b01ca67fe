#include <slipmode/figures/mode_shapes.hpp>

#include <slipmode/figures/style.hpp>
#include "figures/internal/shapes.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

namespace slipmode::figures {
namespace {

/// Few empty places, panels still wide enough for their titles.
int columns_for(int count) {
  if (count <= 4) return std::min(count, 2);
  if (count <= 6) return 3;
  return count == 9 || count == 10 ? 5 : 4;
}

}  // namespace

Figure mode_shapes(const ModeShapes& shapes) {
  constexpr int kLargestCount = 12;
  const int count = std::min<int>(kLargestCount, static_cast<int>(shapes.poms.cols()));
  const int columns = columns_for(count);
  const int rows = (count + columns - 1) / columns;
  Figure figure(1200, rows * 260 + 135);
  common_style(figure);

  const Eigen::Index n = shapes.poms.rows();
  const Eigen::VectorXd number = Eigen::VectorXd::LinSpaced(n, 1.0, static_cast<double>(n));
  const double height = figure.height();
  figure.command(fmt::format("set multiplot layout {},{} margins 0.085,0.985,{:.4f},{:.4f} spacing 0.025,{:.4f}", rows,
                             columns, 90.0 / height, 1.0 - 75.0 / height, 50.0 / height));
  figure.command(fmt::format("set xrange [0.5:{}]", static_cast<double>(n) + 0.5));
  figure.command("unset key");
  if (shapes.lnms.cols() > 0) {
    const double y = 1.0 - 22.0 / height;
    figure.command(fmt::format("set label 1 'POM: solid' at screen 0.8,{:.4f} textcolor rgb '{}'", y, kPomColour));
    figure.command(fmt::format("set label 2 'LNM: dashed' at screen 0.89,{:.4f} textcolor rgb '{}'", y, kLnmColour));
  }
  figure.command("set yrange [-1.15:1.15]; set ytics 0.5");
  if (n <= 20) figure.command(columns <= 3 || n <= 5 ? "set xtics 1" : "set xtics 2");
  figure.command("set xzeroaxis linecolor rgb '#999999' linewidth 0.8 linetype 1");
  const std::string marker = n <= 60 ? "linespoints pointtype 7 pointsize 0.7" : "lines";
  Drawing drawing{.panels = {}, .columns = columns, .x = Drawing::Shared::kAll, .y = Drawing::Shared::kAll};
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd pom = normalised(shapes.poms.col(i));
    const bool with_lnm = i < shapes.lnms.cols();
    const std::string share =
        i < shapes.shares.size() ? fmt::format(": {:.3g} %", 100.0 * shapes.shares[i]) : std::string();
    figure.command(fmt::format("set title \"mode {}{}\" offset 0,-0.7", i + 1, share));
    figure.command(i % columns == 0 ? "set ylabel \"shape [–]\"; set format y '%g'" : "unset ylabel; set format y ''");
    figure.command(i + columns >= count ? "set xlabel \"mass number\"; set format x '%g'"
                                        : "unset xlabel; set format x ''");
    drawing.panels.push_back({.title = fmt::format("mode {}{}", i + 1, share),
                              .series = {{"POM", number, pom, Series::Look::kMarkedLine, kPomColour}},
                              .x_label = "mass number",
                              .y_label = "shape [–]"});
    std::string plot = fmt::format("plot {} using 1:2 with {} linewidth 1.6 linecolor rgb '{}' title 'POM'",
                                   figure.data({number, pom}), marker, kPomColour);
    if (with_lnm) {
      const Eigen::VectorXd lnm = turned_to(normalised(shapes.lnms.col(i)), pom);
      drawing.panels.back().series.push_back({"LNM", number, lnm, Series::Look::kDashed, kLnmColour});
      plot += fmt::format(", {} using 1:2 with lines dashtype 2 linewidth 1.6 linecolor rgb '{}' title 'LNM'",
                          figure.data({number, lnm}), kLnmColour);
    }
    figure.command(plot);
    figure.command("unset label");
  }
  figure.command("unset multiplot");
  figure.show(std::move(drawing));
  return figure;
}

}  // namespace slipmode::figures
