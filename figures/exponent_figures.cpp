#include <slipmode/figures/exponent_figures.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace slipmode::figures {
namespace {

constexpr std::array<std::string_view, 8> kExponentColours = {"#D55E00", "#0072B2", "#009E73", "#CC79A7",
                                                              "#E69F00", "#56B4E9", "#8A5FBF", "#777777"};

std::string_view exponent_colour(Eigen::Index i) {
  return kExponentColours[static_cast<std::size_t>(i) % kExponentColours.size()];
}

struct ExponentRange {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void include(const Eigen::Ref<const Eigen::VectorXd>& values) {
    for (const double value : values) include(value);
  }
};

/// One entry per model in the legend of the first panel only; models a little apart.
void plot_exponents(Figure& figure, const std::vector<ExponentSeries>& models, Eigen::Index shown, bool titled,
                    Drawing::Axes& out_axes) {
  std::string plots = "plot 0 notitle with lines linewidth 1 linecolor rgb '#888888'";
  for (std::size_t m = 0; m < models.size(); ++m) {
    const Eigen::Index count = std::min(shown, models[m].value.size());
    if (count == 0) continue;
    const double shift = 0.14 * (static_cast<double>(m) - 0.5 * static_cast<double>(models.size() - 1));
    const Eigen::VectorXd number = Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count)).array() + shift;
    const Eigen::VectorXd error =
        models[m].error.head(count).unaryExpr([](double e) { return std::isfinite(e) ? e : 0.0; });
    out_axes.series.push_back(
        {models[m].title, number, models[m].value.head(count), Series::Look::kPoints, models[m].colour, error});
    plots += fmt::format(
        ", {} using 1:2:3 {} with yerrorbars pointtype 7 pointsize 0.7 linewidth 1.4 linecolor rgb '{}'",
        figure.data({number, models[m].value.head(count), error}),
        titled ? fmt::format("title \"{}\"", literal(models[m].title)) : std::string("notitle"), models[m].colour);
  }
  figure.command(plots);
}

std::string exponent_label(const std::string& unit) { return fmt::format("set ylabel \"exponent [{}]\"", unit); }

}  // namespace

Figure exponent_spectrum(const std::vector<ExponentSeries>& models, Eigen::Index leading, const std::string& unit) {
  Figure figure(1100, 820);
  common_style(figure);
  Eigen::Index all = 1;
  ExponentRange whole, front;
  for (const ExponentSeries& model : models) {
    all = std::max(all, model.value.size());
    whole.include(model.value);
    front.include(model.value.head(std::min(leading, model.value.size())));
  }
  whole.include(0.0);
  front.include(0.0);
  figure.command("set multiplot layout 2,1 margins 0.115,0.97,0.09,0.93 spacing 0,0.09");
  figure.command(kLegendAbove);
  Drawing drawing;
  const auto panel = [&](Eigen::Index shown, const ExponentRange& range, bool first) {
    figure.command(fmt::format("set xrange [0.5:{}]", static_cast<double>(shown) + 0.5));
    figure.command("set yrange " + padded_range(range.low, range.high, 0.08));
    figure.command(exponent_label(unit));
    if (!first) figure.command("set xlabel \"number of the exponent\"");
    drawing.panels.push_back({.x_label = "number of the exponent", .y_label = fmt::format("exponent [{}]", unit)});
    plot_exponents(figure, models, shown, first, drawing.panels.back());
  };
  panel(all, whole, true);
  panel(std::min(leading, all), front, false);
  figure.show(std::move(drawing));
  figure.command("unset multiplot");
  return figure;
}

Figure exponent_convergence(const std::vector<ExponentHistory>& models, const std::string& unit,
                            const std::string& time_unit) {
  const int count = static_cast<int>(models.size());
  Figure figure(1100, 90 + 420 * count);
  common_style(figure);
  ExponentRange range;
  double end = 0.0;
  for (const ExponentHistory& model : models) {
    end = std::max(end, model.time.tail(1)(0));
    // What the first tenth does is transient; it may leave the frame.
    const Eigen::Index settled = model.running.cols() / 10;
    for (Eigen::Index i = 0; i < model.running.rows(); ++i)
      range.include(model.running.row(i).tail(model.running.cols() - settled).transpose());
  }
  range.include(0.0);
  figure.command(fmt::format("set multiplot layout {},1 margins 0.125,0.97,{:.4f},{:.4f} spacing 0,{:.4f}", count,
                             75.0 / figure.height(), 1.0 - 40.0 / figure.height(), 45.0 / figure.height()));
  figure.command("unset key");
  figure.command(fmt::format("set xrange [0:{:.10g}]", end));
  figure.command("set yrange " + padded_range(range.low, range.high, 0.06));
  figure.command(exponent_label(unit));
  Drawing drawing;
  for (int m = 0; m < count; ++m) {
    const ExponentHistory& model = models[static_cast<std::size_t>(m)];
    figure.command(fmt::format("set title \"{}\" offset 0,-0.6", literal(model.title)));
    if (m + 1 == count) figure.command(fmt::format("set xlabel \"{}\"", axis_label("time measured", time_unit)));
    drawing.panels.push_back({.title = model.title,
                              .x_label = axis_label("time measured", time_unit),
                              .y_label = fmt::format("exponent [{}]", unit)});
    std::string plots = "plot 0 with lines linewidth 1 linecolor rgb '#888888'";
    for (Eigen::Index i = 0; i < model.running.rows(); ++i) {
      const Eigen::VectorXd curve = model.running.row(i).transpose();
      drawing.panels.back().series.push_back({"", model.time, curve, Series::Look::kLine, exponent_colour(i)});
      plots += fmt::format(", {} using 1:2 with lines linewidth 1.5 linecolor rgb '{}'",
                           figure.data({model.time, curve}), exponent_colour(i));
    }
    figure.command(plots);
  }
  figure.show(std::move(drawing));
  figure.command("unset multiplot");
  return figure;
}

Figure exponent_sweep(const std::vector<ExponentSweep>& models, const std::string& parameter_label,
                      const std::string& value_label, const std::string& unit) {
  const int columns = static_cast<int>(models.size());
  const bool diagram = std::ranges::any_of(models, [](const auto& model) { return model.slip_value.size() > 0; });
  Figure figure(columns == 1 ? 1100 : 1500, diagram ? 900 : 520);
  common_style(figure);
  ExponentRange x, slips, exponents;
  for (const ExponentSweep& model : models) {
    x.include(model.parameter);
    slips.include(model.slip_value);
    for (Eigen::Index i = 0; i < model.exponents.rows(); ++i) exponents.include(model.exponents.row(i).transpose());
  }
  exponents.include(0.0);
  figure.command(fmt::format("set multiplot layout {},{} rowsfirst margins {},0.985,{:.4f},{:.4f} spacing 0.03,0.03",
                             diagram ? 2 : 1, columns, columns == 1 ? 0.12 : 0.09, 80.0 / figure.height(),
                             1.0 - 40.0 / figure.height()));
  figure.command("unset key");
  figure.command("set xrange " + padded_range(x.low, x.high, 0.012));
  Drawing drawing{.panels = {}, .columns = columns, .x = Drawing::Shared::kAll, .y = Drawing::Shared::kRow};
  const auto row = [&](bool upper) {
    figure.command("set yrange " +
                   (upper ? padded_range(slips.low, slips.high) : padded_range(exponents.low, exponents.high)));
    for (std::size_t m = 0; m < models.size(); ++m) {
      const ExponentSweep& model = models[m];
      const bool titled = upper || !diagram;
      figure.command(titled ? fmt::format("set title \"{}\" offset 0,-0.6", literal(model.title)) : "unset title");
      figure.command(m > 0   ? std::string("unset ylabel; set format y ''")
                     : upper ? fmt::format("set ylabel \"{}\"; set format y '%g'", value_label)
                             : exponent_label(unit) + "; set format y '%g'");
      figure.command(upper ? std::string("unset xlabel; set format x ''")
                           : fmt::format("set xlabel \"{}\"; set format x '%g'", parameter_label));
      drawing.panels.push_back({.title = model.title,
                                .x_label = parameter_label,
                                .y_label = upper ? value_label : fmt::format("exponent [{}]", unit)});
      std::vector<Series>& drawn = drawing.panels.back().series;
      if (upper) {
        drawn.push_back({"", model.slip_parameter, model.slip_value, Series::Look::kDots, model.colour});
        figure.command(fmt::format("plot {} using 1:2 with points pointtype 7 pointsize 0.18 linecolor rgb '{}'",
                                   figure.data({model.slip_parameter, model.slip_value}), model.colour));
        continue;
      }
      std::string plots = "plot 0 with lines linewidth 1 linecolor rgb '#888888'";
      for (Eigen::Index i = model.exponents.rows() - 1; i >= 0; --i) {
        const Eigen::VectorXd curve = model.exponents.row(i).transpose();
        drawn.push_back({"", model.parameter, curve, Series::Look::kMarkedLine, exponent_colour(i)});
        plots +=
            fmt::format(", {} using 1:2 with linespoints pointtype 7 pointsize 0.3 linewidth 1.2 linecolor rgb '{}'",
                        figure.data({model.parameter, curve}), exponent_colour(i));
      }
      figure.command(plots);
    }
  };
  if (diagram) row(true);
  row(false);
  figure.show(std::move(drawing));
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
