#include "cli/series_figures.hpp"

#include <slipmode/figures/delay_map.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/recurrence_plot.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/table.hpp>
#include "cli/series_store.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

namespace slipmode::cli {
namespace {

constexpr std::string_view kGuideColour = "#888888", kFittedColour = figures::kLnmColour;
constexpr const char* kLegendInside = "set key inside right top vertical";

figures::Series guide_line(double x0, double y0, double x1, double y1, std::string title,
                           std::string_view colour = kGuideColour,
                           figures::Series::Look look = figures::Series::Look::kDashed) {
  return {std::move(title), Eigen::VectorXd{{x0, x1}}, Eigen::VectorXd{{y0, y1}}, look, colour};
}

figures::Figure draw_delay_map(const results::StoreReader& store) {
  constexpr Eigen::Index kShown = 6000;
  const Eigen::VectorXd values = store.vector(diagnosis_path("series/values"));
  const Eigen::Index delay = store.integer(diagnosis_path("embedding/delay"));
  const double interval = store.number(diagnosis_path("series/interval"));
  const std::string unit = store.entry(diagnosis_path("series/interval")).meaning.units;
  const Eigen::Index count = std::min(kShown, values.size() - 2 * delay);
  // Joined where neighbours are nearer than points picked at random: a flow, sampled densely.
  const double step = (values.tail(values.size() - 1) - values.head(values.size() - 1)).squaredNorm();
  const double spread = (values.array() - values.mean()).matrix().squaredNorm();
  return figures::delay_map({.now = values.head(count),
                             .later = values.segment(delay, count),
                             .last = values.segment(2 * delay, count),
                             .unit = store.entry(diagnosis_path("series/values")).meaning.units,
                             .delay = fmt::format("{} samples = {:g} {}", delay, static_cast<double>(delay) * interval,
                                                  unit == "unit" ? "units of time" : unit),
                             .is_path = step < spread});
}

/// "equal_width_20" as the legend says it.
std::string estimator_title(const std::string& column) {
  if (column == "no_bins") return "no bins";
  const std::size_t number = column.rfind('_') + 1;
  const bool width = column.starts_with("equal_width");
  return fmt::format("{} {}", column.substr(number), width ? "cells" : "bins of equal numbers");
}

figures::Figure draw_information(const results::StoreReader& store) {
  constexpr std::array<std::string_view, 6> kColours = {"#CCCCCC", "#AAAAAA", "#888888",
                                                        "#666666", "#444444", "#222222"};
  const results::Table table = results::load_table(store, diagnosis_path("information"));
  const Eigen::VectorXd lag = to_vector(table.numbers("lag"));
  const auto delay = static_cast<double>(store.integer(diagnosis_path("embedding/delay")));
  figures::Panel panel{.title = "average mutual information", .series = {}};
  std::size_t widths = 0;
  double top = 0.0;
  for (const results::Column& column : table.columns) {
    if (column.name == "lag") continue;
    const Eigen::VectorXd bits = to_vector(table.numbers(column.name));
    const bool width = column.name.starts_with("equal_width");
    const std::string_view colour = width                      ? kColours[std::min<std::size_t>(widths++, 5)]
                                    : column.name == "no_bins" ? figures::kLnmColour
                                                               : figures::kPomColour;
    panel.series.push_back({estimator_title(column.name), lag, bits, figures::Series::Look::kLine, colour});
    if (bits.size() > 1) top = std::max(top, bits(1));
  }
  panel.series.push_back(guide_line(delay, 0.0, delay, top, "delay used"));
  return figures::panel_grid({panel}, {.panel_height = 560,
                                       .x_label = figures::axis_label("lag", "samples"),
                                       .y_label = figures::axis_label("mutual information", "bit"),
                                       .legend = kLegendInside});
}

figures::Figure draw_autocorrelation(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, diagnosis_path("autocorrelation"));
  const Eigen::VectorXd lag = to_vector(table.numbers("lag")), value = to_vector(table.numbers("value"));
  const double last = lag(lag.size() - 1), level = std::exp(-1.0);
  figures::Panel panel{.title = "autocorrelation",
                       .series = {guide_line(0.0, level, last, level, "1/e"),
                                  guide_line(0.0, 0.0, last, 0.0, ""),
                                  {"", lag, value, figures::Series::Look::kLine, figures::kFullColour}}};
  return figures::panel_grid({panel}, {.panel_height = 460,
                                       .x_label = figures::axis_label("lag", "samples"),
                                       .y_label = figures::axis_label("autocorrelation", "1"),
                                       .legend = kLegendInside});
}

figures::Figure draw_neighbours(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, diagnosis_path("neighbours"));
  const Eigen::VectorXd d = to_vector(table.numbers("dimension"));
  const auto curve = [&](const std::string& column, double scale, std::string title, std::string_view colour) {
    return figures::Series{std::move(title), d, scale * to_vector(table.numbers(column)),
                           figures::Series::Look::kMarkedLine, colour};
  };
  const figures::Panel kennel{
      .title = "false neighbours in %: all (black), next coordinate far (blue), neighbour far (orange)",
      .series = {curve("by_ratio", 100.0, "", figures::kPomColour), curve("by_size", 100.0, "", figures::kLnmColour),
                 curve("share", 100.0, "", figures::kFullColour)}};
  const figures::Panel cao{
      .title = "Cao: E1 (black) levels off near 1; E2 (blue) is 1 throughout for noise",
      .series = {guide_line(d(0), 1.0, d(d.size() - 1), 1.0, ""), curve("E2", 1.0, "", figures::kPomColour),
                 curve("E1", 1.0, "", figures::kFullColour)}};
  return figures::panel_grid({kennel, cao}, {.panel_height = 340,
                                             .x_label = figures::axis_label("dimension of the embedding", "1"),
                                             .y_label = "",
                                             .shared_y = false});
}

/// The fitted stretch of a curve, drawn over it.
figures::Series fitted_line(const results::StoreReader& store, const std::string& group, const Eigen::VectorXd& x) {
  const auto begin = store.integer(group + "/fit/begin"), end = store.integer(group + "/fit/end");
  const double slope = store.number(group + "/fit/slope"), intercept = store.number(group + "/fit/intercept");
  const double x0 = x(begin), x1 = x(end - 1);
  return guide_line(x0, intercept + slope * x0, x1, intercept + slope * x1, fmt::format("slope {:.4g}", slope),
                    kFittedColour, figures::Series::Look::kMarkedLine);
}

figures::Figure draw_divergence(const results::StoreReader& store) {
  std::vector<figures::Panel> panels;
  std::string unit;
  for (const auto& [group, title] :
       {std::pair{"across_the_flow", "across the flow"}, {"rosenstein", "Rosenstein"}, {"kantz", "Kantz"}}) {
    if (!store.has(diagnosis_path(group))) continue;
    const results::Table table = results::load_table(store, diagnosis_path(group));
    const Eigen::VectorXd time = to_vector(table.numbers("time")), log = to_vector(table.numbers("mean_log"));
    const double slope = store.number(diagnosis_path(group) + "/fit/slope");
    unit = store.entry(diagnosis_path(group) + "/time").meaning.units;
    panels.push_back({fmt::format("{}: {:.4g} nat per {}", title, slope, unit == "unit" ? "unit of time" : unit),
                      {{"", time, log, figures::Series::Look::kLine, figures::kFullColour},
                       fitted_line(store, diagnosis_path(group), time)}});
    panels.back().series.back().title.clear();
  }
  return figures::panel_grid(panels, {.columns = static_cast<int>(panels.size()),
                                      .panel_height = 480,
                                      .x_label = figures::axis_label("time", unit == "unit" ? "1" : unit),
                                      .y_label = "mean ln(distance of neighbours); fitted part orange",
                                      .shared_x = false,
                                      .shared_y = false});
}

figures::Figure draw_dimension(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, diagnosis_path("correlation"));
  const Eigen::VectorXd r = to_vector(table.numbers("radius")), C = to_vector(table.numbers("C"));
  const Eigen::VectorXd log_r = r.array().log10(), log_C = C.array().log10();
  const std::string group = diagnosis_path("correlation");
  const auto begin = store.integer(group + "/fit/begin"), end = store.integer(group + "/fit/end");
  const double slope = store.number(group + "/fit/slope");
  const figures::Panel sums{.title = "logarithm (base 10) of the correlation sum; fitted part orange",
                            .series = {{"", log_r, log_C, figures::Series::Look::kLine, figures::kFullColour},
                                       {"", log_r.segment(begin, end - begin), log_C.segment(begin, end - begin),
                                        figures::Series::Look::kMarkedLine, kFittedColour}}};
  const figures::Panel slopes{
      .title = fmt::format("local slope; over the fitted part {:.3f}", slope),
      .series = {
          {"", log_r, to_vector(table.numbers("local_slope")), figures::Series::Look::kLine, figures::kFullColour},
          guide_line(log_r(begin), slope, log_r(end - 1), slope, "", kFittedColour, figures::Series::Look::kLine)}};
  return figures::panel_grid(
      {sums, slopes}, {.panel_height = 340, .x_label = "log_{10} of the radius", .y_label = "", .shared_y = false});
}

figures::Figure draw_spectrum(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, diagnosis_path("spectrum"));
  const Eigen::VectorXd f = to_vector(table.numbers("frequency")), a = to_vector(table.numbers("amplitude"));
  const std::string unit = store.entry(diagnosis_path("spectrum/frequency")).meaning.units;
  const figures::Panel panel{
      .title = "averaged amplitude spectrum",
      .series = {{"", f.tail(f.size() - 1), a.tail(a.size() - 1), figures::Series::Look::kLine, figures::kFullColour}}};
  return figures::panel_grid(
      {panel}, {.panel_height = 460,
                .x_label = figures::axis_label("frequency", unit == "1/unit" ? "1" : unit),
                .y_label = figures::axis_label("amplitude", store.entry(diagnosis_path("series/values")).meaning.units),
                .log_y = true});
}

figures::Figure draw_section(const results::StoreReader& store) {
  const Eigen::MatrixXd points = store.columns(diagnosis_path("section/points"));
  const std::string unit = store.entry(diagnosis_path("series/values")).meaning.units;
  const bool strobe = store.text(diagnosis_path("section/cut")) == "strobe";
  const Eigen::VectorXd x = points.row(strobe ? 0 : 1), y = points.row(strobe ? 1 : 2);
  const figures::Panel panel{
      .title = strobe ? "once per period of the drive" : "where s rises through its mean",
      .series = {{"", x, y, x.size() > 3000 ? figures::Series::Look::kDots : figures::Series::Look::kPoints,
                  figures::kFullColour}}};
  return figures::panel_grid({panel},
                             {.panel_height = 640,
                              .x_label = figures::axis_label(strobe ? "s(t)" : "s(t + delay)", unit),
                              .y_label = figures::axis_label(strobe ? "s(t + delay)" : "s(t + 2 delay)", unit)});
}

figures::Figure draw_recurrence(const results::StoreReader& store) {
  const std::string unit = store.entry(diagnosis_path("recurrence/interval")).meaning.units;
  return figures::recurrence_plot(
      {.i = store.integers(diagnosis_path("recurrence/i")),
       .j = store.integers(diagnosis_path("recurrence/j")),
       .points = store.integer(diagnosis_path("recurrence/points")),
       .interval = store.number(diagnosis_path("recurrence/interval")),
       .start = store.number(diagnosis_path("series/start")),
       .time_unit = unit == "unit" ? "1" : unit,
       .title = fmt::format("recurrences within {:.3g}", store.number(diagnosis_path("recurrence/radius")))});
}

}  // namespace

std::vector<figures::FileFigure> series_figures_of(const results::StoreReader& store) {
  figures::FileFigures out(store);
  out.add(diagnosis_path("series"), "delay", "the record against itself one and two delays later", draw_delay_map);
  out.add(diagnosis_path("information"), "information", "average mutual information", draw_information);
  out.add(diagnosis_path("autocorrelation"), "autocorrelation", "autocorrelation", draw_autocorrelation);
  out.add(diagnosis_path("neighbours"), "neighbours", "false neighbours and Cao's averages against the dimension",
          draw_neighbours);
  const bool diverges = store.has(diagnosis_path("across_the_flow")) || store.has(diagnosis_path("rosenstein"));
  out.add(diagnosis_path(diverges ? "series" : "kantz"), "divergence", "divergence of neighbours with the fitted part",
          draw_divergence);
  out.add(diagnosis_path("correlation"), "dimension", "correlation sum with local slopes and the fitted part",
          draw_dimension);
  out.add(diagnosis_path("spectrum"), "spectrum", "averaged amplitude spectrum", draw_spectrum);
  out.add(diagnosis_path("section"), "section", "Poincaré section", draw_section);
  out.add(diagnosis_path("recurrence"), "recurrence", "recurrence plot", draw_recurrence);
  return std::move(out.all);
}

}  // namespace slipmode::cli
