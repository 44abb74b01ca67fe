#include <slipmode/figures/time_history.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <array>
#include <utility>

namespace slipmode::figures {

Figure time_history(const TimeHistory& history) {
  Figure figure(1200, 820);
  common_style(figure);
  struct Row {
    std::string_view quantity;
    const Eigen::VectorXd& values;
    std::string_view unit;
  };
  const std::array<Row, 3> rows = {Row{"displacement", history.displacement, history.displacement_unit},
                                   Row{"velocity", history.velocity, history.velocity_unit},
                                   Row{"contact force", history.force, history.force_unit}};
  const double begin = history.time[0], end = history.time[history.time.size() - 1];

  figure.command("set multiplot layout 3,1 margins 0.125,0.97,0.11,0.95 spacing 0,0.025");
  figure.command("unset key");
  figure.command(fmt::format("set xrange [{:.10g}:{:.10g}]", begin, end));
  for (const auto& [from, to] : history.stick) {
    figure.command(
        fmt::format("set object rectangle from first {:.10g},graph 0 to first {:.10g},graph 1 behind "
                    "fillcolor rgb '{}' fillstyle solid 0.7 noborder",
                    std::max(from, begin), std::min(to, end), kStickShade));
  }
  const std::string title = history.contact + (history.stick.empty() ? "" : ": stick is shaded");
  Drawing drawing{.panels = {}, .x = Drawing::Shared::kAll};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    drawing.panels.push_back({.title = i == 0 ? title : std::string(),
                              .series = {{"", history.time, rows[i].values, Series::Look::kLine, kFullColour}},
                              .x_label = axis_label("time", history.time_unit),
                              .y_label = axis_label(rows[i].quantity, rows[i].unit),
                              .shaded = history.stick});
    const bool last = i + 1 == rows.size();
    figure.command(i == 0 ? fmt::format("set title \"{}\" offset 0,-0.5", literal(title)) : std::string("unset title"));
    figure.command(fmt::format("set ylabel \"{}\"", axis_label(rows[i].quantity, rows[i].unit)));
    figure.command("set yrange " + padded_range(rows[i].values.minCoeff(), rows[i].values.maxCoeff(), 0.08));
    figure.command(last ? fmt::format("set format x '%g'; set xlabel \"{}\"", axis_label("time", history.time_unit))
                        : std::string("set format x ''"));
    figure.command(fmt::format("plot {} using 1:2 with lines linewidth 1.4 linecolor rgb '{}'",
                               figure.data({history.time, rows[i].values}), kFullColour));
  }
  figure.command("unset multiplot");
  figure.show(std::move(drawing));
  return figure;
}

}  // namespace slipmode::figures
