#include <slipmode/figures/series_figures.hpp>

#include <slipmode/figures/delay_map.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/recurrence_plot.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/series_store.hpp>
#include <slipmode/results/table.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

namespace slipmode::figures {
namespace {

constexpr std::string_view kGuideColour = "#888888", kFittedColour = kLnmColour;
constexpr const char* kLegendInside = "set key inside right top vertical";

Series guide_line(double x0, double y0, double x1, double y1, std::string title, std::string_view colour = kGuideColour,
                  Series::Look look = Series::Look::kDashed) {
  return {std::move(title), Eigen::VectorXd{{x0, x1}}, Eigen::VectorXd{{y0, y1}}, look, colour};
}

Figure draw_delay_map(const results::StoreReader& store) {
  constexpr Eigen::Index kShown = 6000;
  const Eigen::VectorXd values = store.vector(results::diagnosis_path("series/values"));
  const Eigen::Index delay = store.integer(results::diagnosis_path("embedding/delay"));
  const double interval = store.number(results::diagnosis_path("series/interval"));
  const std::string unit = store.entry(results::diagnosis_path("series/interval")).meaning.units;
  const Eigen::Index count = std::min(kShown, values.size() - 2 * delay);
  // Joined where neighbours are nearer than points picked at random: a flow, sampled densely.
  const double step = (values.tail(values.size() - 1) - values.head(values.size() - 1)).squaredNorm();
  const double spread = (values.array() - values.mean()).matrix().squaredNorm();
  return delay_map({.now = values.head(count),
                    .later = values.segment(delay, count),
                    .last = values.segment(2 * delay, count),
                    .unit = store.entry(results::diagnosis_path("series/values")).meaning.units,
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

Figure draw_information(const results::StoreReader& store) {
  constexpr std::array<std::string_view, 6> kColours = {"#CCCCCC", "#AAAAAA", "#888888",
                                                        "#666666", "#444444", "#222222"};
  const results::Table table = results::load_table(store, results::diagnosis_path("information"));
  const Eigen::VectorXd lag = to_vector(table.numbers("lag"));
  const auto delay = static_cast<double>(store.integer(results::diagnosis_path("embedding/delay")));
  Panel panel{.title = "average mutual information", .series = {}};
  std::size_t widths = 0;
  double top = 0.0;
  for (const results::Column& column : table.columns) {
    if (column.name == "lag") continue;
    const Eigen::VectorXd bits = to_vector(table.numbers(column.name));
    const bool width = column.name.starts_with("equal_width");
    const std::string_view colour = width                      ? kColours[std::min<std::size_t>(widths++, 5)]
                                    : column.name == "no_bins" ? kLnmColour
                                                               : kPomColour;
    panel.series.push_back({estimator_title(column.name), lag, bits, Series::Look::kLine, colour});
    if (bits.size() > 1) top = std::max(top, bits(1));
  }
  panel.series.push_back(guide_line(delay, 0.0, delay, top, "delay used"));
  return panel_grid({panel}, {.panel_height = 560,
                              .x_label = axis_label("lag", "samples"),
                              .y_label = axis_label("mutual information", "bit"),
                              .legend = kLegendInside});
}

Figure draw_autocorrelation(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, results::diagnosis_path("autocorrelation"));
  const Eigen::VectorXd lag = to_vector(table.numbers("lag")), value = to_vector(table.numbers("value"));
  const double last = lag(lag.size() - 1), level = std::exp(-1.0);
  Panel panel{.title = "autocorrelation",
              .series = {guide_line(0.0, level, last, level, "1/e"),
                         guide_line(0.0, 0.0, last, 0.0, ""),
                         {"", lag, value, Series::Look::kLine, kFullColour}}};
  return panel_grid({panel}, {.panel_height = 460,
                              .x_label = axis_label("lag", "samples"),
                              .y_label = axis_label("autocorrelation", "1"),
                              .legend = kLegendInside});
}

Figure draw_neighbours(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, results::diagnosis_path("neighbours"));
  const Eigen::VectorXd d = to_vector(table.numbers("dimension"));
  const auto curve = [&](const std::string& column, double scale, std::string title, std::string_view colour) {
    return Series{std::move(title), d, scale * to_vector(table.numbers(column)), Series::Look::kMarkedLine, colour};
  };
  const Panel kennel{.title = "false neighbours in %: all (black), next coordinate far (blue), neighbour far (orange)",
                     .series = {curve("by_ratio", 100.0, "", kPomColour), curve("by_size", 100.0, "", kLnmColour),
                                curve("share", 100.0, "", kFullColour)}};
  const Panel cao{.title = "Cao: E1 (black) levels off near 1; E2 (blue) is 1 throughout for noise",
                  .series = {guide_line(d(0), 1.0, d(d.size() - 1), 1.0, ""), curve("E2", 1.0, "", kPomColour),
                             curve("E1", 1.0, "", kFullColour)}};
  return panel_grid({kennel, cao}, {.panel_height = 340,
                                    .x_label = axis_label("dimension of the embedding", "1"),
                                    .y_label = "",
                                    .shared_y = false});
}

/// The fitted stretch of a curve, drawn over it.
Series fitted_line(const results::StoreReader& store, const std::string& group, const Eigen::VectorXd& x) {
  const auto begin = store.integer(group + "/fit/begin"), end = store.integer(group + "/fit/end");
  const double slope = store.number(group + "/fit/slope"), intercept = store.number(group + "/fit/intercept");
  const double x0 = x(begin), x1 = x(end - 1);
  return guide_line(x0, intercept + slope * x0, x1, intercept + slope * x1, fmt::format("slope {:.4g}", slope),
                    kFittedColour, Series::Look::kMarkedLine);
}

Figure draw_divergence(const results::StoreReader& store) {
  std::vector<Panel> panels;
  std::string unit;
  for (const auto& [group, title] :
       {std::pair{"across_the_flow", "across the flow"}, {"rosenstein", "Rosenstein"}, {"kantz", "Kantz"}}) {
    if (!store.has(results::diagnosis_path(group))) continue;
    const results::Table table = results::load_table(store, results::diagnosis_path(group));
    const Eigen::VectorXd time = to_vector(table.numbers("time")), log = to_vector(table.numbers("mean_log"));
    const double slope = store.number(results::diagnosis_path(group) + "/fit/slope");
    unit = store.entry(results::diagnosis_path(group) + "/time").meaning.units;
    panels.push_back({fmt::format("{}: {:.4g} nat per {}", title, slope, unit == "unit" ? "unit of time" : unit),
                      {{"", time, log, Series::Look::kLine, kFullColour},
                       fitted_line(store, results::diagnosis_path(group), time)}});
    panels.back().series.back().title.clear();
  }
  return panel_grid(panels, {.columns = static_cast<int>(panels.size()),
                             .panel_height = 480,
                             .x_label = axis_label("time", unit == "unit" ? "1" : unit),
                             .y_label = "mean ln(distance of neighbours); fitted part orange",
                             .shared_x = false,
                             .shared_y = false});
}

Figure draw_dimension(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, results::diagnosis_path("correlation"));
  const Eigen::VectorXd r = to_vector(table.numbers("radius")), C = to_vector(table.numbers("C"));
  const Eigen::VectorXd log_r = r.array().log10(), log_C = C.array().log10();
  const std::string group = results::diagnosis_path("correlation");
  const auto begin = store.integer(group + "/fit/begin"), end = store.integer(group + "/fit/end");
  const double slope = store.number(group + "/fit/slope");
  const Panel sums{.title = "logarithm (base 10) of the correlation sum; fitted part orange",
                   .series = {{"", log_r, log_C, Series::Look::kLine, kFullColour},
                              {"", log_r.segment(begin, end - begin), log_C.segment(begin, end - begin),
                               Series::Look::kMarkedLine, kFittedColour}}};
  const Panel slopes{
      .title = fmt::format("local slope; over the fitted part {:.3f}", slope),
      .series = {{"", log_r, to_vector(table.numbers("local_slope")), Series::Look::kLine, kFullColour},
                 guide_line(log_r(begin), slope, log_r(end - 1), slope, "", kFittedColour, Series::Look::kLine)}};
  return panel_grid({sums, slopes},
                    {.panel_height = 340, .x_label = "log_{10} of the radius", .y_label = "", .shared_y = false});
}

Figure draw_spectrum(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, results::diagnosis_path("spectrum"));
  const Eigen::VectorXd f = to_vector(table.numbers("frequency")), a = to_vector(table.numbers("amplitude"));
  const std::string unit = store.entry(results::diagnosis_path("spectrum/frequency")).meaning.units;
  const Panel panel{.title = "averaged amplitude spectrum",
                    .series = {{"", f.tail(f.size() - 1), a.tail(a.size() - 1), Series::Look::kLine, kFullColour}}};
  return panel_grid(
      {panel}, {.panel_height = 460,
                .x_label = axis_label("frequency", unit == "1/unit" ? "1" : unit),
                .y_label = axis_label("amplitude", store.entry(results::diagnosis_path("series/values")).meaning.units),
                .log_y = true});
}

Figure draw_section(const results::StoreReader& store) {
  const Eigen::MatrixXd points = store.columns(results::diagnosis_path("section/points"));
  const std::string unit = store.entry(results::diagnosis_path("series/values")).meaning.units;
  const bool strobe = store.text(results::diagnosis_path("section/cut")) == "strobe";
  const Eigen::VectorXd x = points.row(strobe ? 0 : 1), y = points.row(strobe ? 1 : 2);
  const Panel panel{.title = strobe ? "once per period of the drive" : "where s rises through its mean",
                    .series = {{"", x, y, x.size() > 3000 ? Series::Look::kDots : Series::Look::kPoints, kFullColour}}};
  return panel_grid({panel}, {.panel_height = 640,
                              .x_label = axis_label(strobe ? "s(t)" : "s(t + delay)", unit),
                              .y_label = axis_label(strobe ? "s(t + delay)" : "s(t + 2 delay)", unit)});
}

Figure draw_recurrence(const results::StoreReader& store) {
  const std::string unit = store.entry(results::diagnosis_path("recurrence/interval")).meaning.units;
  return recurrence_plot(
      {.i = store.integers(results::diagnosis_path("recurrence/i")),
       .j = store.integers(results::diagnosis_path("recurrence/j")),
       .points = store.integer(results::diagnosis_path("recurrence/points")),
       .interval = store.number(results::diagnosis_path("recurrence/interval")),
       .start = store.number(results::diagnosis_path("series/start")),
       .time_unit = unit == "unit" ? "1" : unit,
       .title = fmt::format("recurrences within {:.3g}", store.number(results::diagnosis_path("recurrence/radius")))});
}

}  // namespace

std::vector<FileFigure> series_figures_of(const results::StoreReader& store) {
  std::vector<FileFigure> out;
  const auto add = [&](std::initializer_list<const char*> any_of, const char* name, const char* what, auto draw) {
    if (std::ranges::any_of(any_of, [&](const char* part) { return store.has(results::diagnosis_path(part)); }))
      out.push_back({name, what, draw});
  };
  add({"series"}, "delay", "the record against itself one and two delays later", draw_delay_map);
  add({"information"}, "information", "average mutual information", draw_information);
  add({"autocorrelation"}, "autocorrelation", "autocorrelation", draw_autocorrelation);
  add({"neighbours"}, "neighbours", "false neighbours and Cao's averages against the dimension", draw_neighbours);
  add({"across_the_flow", "rosenstein", "kantz"}, "divergence", "divergence of neighbours with the fitted part",
      draw_divergence);
  add({"correlation"}, "dimension", "correlation sum with local slopes and the fitted part", draw_dimension);
  add({"spectrum"}, "spectrum", "averaged amplitude spectrum", draw_spectrum);
  add({"section"}, "section", "Poincaré section", draw_section);
  add({"recurrence"}, "recurrence", "recurrence plot", draw_recurrence);
  return out;
}

}  // namespace slipmode::figures
