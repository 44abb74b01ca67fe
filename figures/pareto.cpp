#include <slipmode/figures/pareto.hpp>

#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::figures {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

bool drawable(const ParetoPoint& point) {
  return std::isfinite(point.error) && std::isfinite(point.cost) && point.cost > 0.0;
}

struct Limits {
  double low = kInfinite, high = 0.0;
  void include(double value) {
    if (!(value > 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Wider by a share of its decades; one decade at least.
  [[nodiscard]] Limits wider(double below, double above) const {
    const double bottom = std::isfinite(low) ? low : 1e-3, top = std::isfinite(low) ? high : 1.0;
    const double decades = std::max(1.0, std::log10(top / bottom));
    return {bottom * std::pow(10.0, -below * decades), top * std::pow(10.0, above * decades)};
  }
  [[nodiscard]] std::string text() const { return fmt::format("[{:.4g}:{:.4g}]", low, high); }
};

/// All groups, those without a point to draw too: so each keeps its colour in the figures of other measures.
std::vector<std::string> groups_of(const std::vector<ParetoPoint>& points) {
  std::vector<std::string> groups;
  for (const ParetoPoint& point : points) {
    if (std::ranges::find(groups, point.group) == groups.end()) groups.push_back(point.group);
  }
  return groups;
}

/// The front as steps: along the error of a point until the next one takes over.
std::string front_data(Figure& figure, std::vector<ParetoPoint> front, const Limits& x, const Limits& y,
                       std::vector<Series>& out_drawn) {
  std::vector<double> cost, error;
  const auto add = [&](double at, double value) {
    cost.push_back(at);
    error.push_back(std::max(value, y.low));
  };
  for (std::size_t k = 0; k < front.size(); ++k) {
    add(front[k].cost, k == 0 ? y.high : front[k - 1].resolved);
    add(front[k].cost, front[k].resolved);
  }
  if (!front.empty()) add(x.high, front.back().resolved);
  out_drawn.push_back({"front", to_vector(cost), to_vector(error), Series::Look::kLine, "#777777"});
  return figure.data({to_vector(cost), to_vector(error)});
}

/// Names beside the points of the front; neighbours that would run into each other are left out.
void label_front(Figure& figure, const std::vector<ParetoPoint>& front, const Limits& x, const Limits& y) {
  constexpr double kCloseX = 0.16, kCloseY = 0.035;
  const auto place = [](double value, const Limits& limits) {
    return std::log(value / limits.low) / std::log(limits.high / limits.low);
  };
  std::vector<std::pair<double, double>> taken;
  for (const ParetoPoint& point : front) {
    const double height = std::max(point.resolved, y.low);
    const std::pair<double, double> here = {place(point.cost, x), place(height, y)};
    const bool free = std::ranges::none_of(taken, [&](const auto& other) {
      return std::abs(other.first - here.first) < kCloseX && std::abs(other.second - here.second) < kCloseY;
    });
    if (!free) continue;
    taken.push_back(here);
    const bool right = here.first > 0.75;
    figure.command(fmt::format("set label \"{}\" at {:.6g},{:.6g} {} offset {},0.75 textcolor rgb '#222222' front",
                               literal(point.name), point.cost, height, right ? "right" : "left", right ? -0.6 : 0.6));
  }
}

}  // namespace

Figure pareto_diagram(const std::vector<ParetoPoint>& points, const ParetoLabels& labels) {
  constexpr std::array<std::string_view, 8> kColours = {kFullColour, kPomColour, kLnmColour, kSecondColour,
                                                        "#CC79A7",   "#E69F00",  "#56B4E9",  "#888888"};
  constexpr std::array kSymbols = {3, 7, 5, 9, 13, 11, 6, 4};
  constexpr double kShown = 1e-7;  // of the largest error: below it is none to choose by
  Figure figure(1200, 800);
  common_style(figure);
  Limits x, y;
  for (const ParetoPoint& point : points) {
    if (!drawable(point)) continue;
    x.include(point.cost);
    y.include(point.error);
  }
  x = x.wider(0.05, 0.12);
  y.low = std::max(y.low, kShown * y.high);
  y = y.wider(0.08, 0.08);
  std::vector<ParetoPoint> front;
  for (const ParetoPoint& point : points) {
    if (point.on_front && drawable(point)) front.push_back(point);
  }
  std::ranges::sort(front, {}, &ParetoPoint::cost);

  figure.command("set logscale xy; set format y '%g'; set format x '%g'");
  figure.command("set margins screen 0.115, screen 0.98, screen 0.1, screen 0.83");
  figure.command("set key at screen 0.985,0.925 right top horizontal maxrows 2 width 1");
  figure.command(fmt::format("set xrange {}; set yrange {}", x.text(), y.text()));
  figure.command(fmt::format("set label 3 \"{}\" at screen 0.115,0.965 left", literal(labels.title)));
  figure.command(fmt::format("set xlabel \"{}\"; set ylabel \"{}\"", labels.cost, labels.error));
  if (labels.noise > y.low) {
    figure.command(
        fmt::format("set object 1 rectangle from graph 0, graph 0 to graph 1, first {:.6g} fillcolor rgb "
                    "'{}' fillstyle solid 0.45 noborder behind",
                    std::min(labels.noise, y.high), kStickShade));
    figure.command("set label 2 'scatter of the reference' at graph 0.985, graph 0.02 right textcolor rgb '#56789A'");
  }
  label_front(figure, front, x, y);

  std::vector<Series> drawn;
  std::string plot = fmt::format("plot {} using 1:2 with lines linewidth 1.2 linecolor rgb '#777777' title 'front'",
                                 front_data(figure, front, x, y, drawn));
  const std::vector<std::string> groups = groups_of(points);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<double> cost, error;
    for (const ParetoPoint& point : points) {
      if (point.group != groups[g] || !drawable(point)) continue;
      cost.push_back(point.cost);
      error.push_back(std::max(point.error, y.low));
    }
    if (cost.empty()) continue;
    drawn.push_back(
        {groups[g], to_vector(cost), to_vector(error), Series::Look::kPoints, kColours[g % kColours.size()]});
    plot += fmt::format(", {} using 1:2 with points pointtype {} pointsize {} linecolor rgb '{}' title \"{}\"",
                        figure.data({to_vector(cost), to_vector(error)}), kSymbols[g % kSymbols.size()],
                        g == 0 ? 2.0 : 1.1, kColours[g % kColours.size()], literal(groups[g]));
  }
  figure.command(plot);
  figure.show({.panels = {{.title = labels.title,
                           .series = drawn,
                           .x_label = labels.cost,
                           .y_label = labels.error,
                           .log_x = true,
                           .log_y = true}}});
  return figure;
}

}  // namespace slipmode::figures
