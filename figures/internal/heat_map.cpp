#include "figures/internal/heat_map.hpp"

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::figures {
namespace {

/// Where "no value" stands on the colour bar: below the scale.
struct Scale {
  double low, high, step;

  [[nodiscard]] double missing() const { return low - step; }
  [[nodiscard]] double bottom() const { return low - 1.5 * step; }
  [[nodiscard]] double colour_low() const { return low - 0.5 * step; }
  [[nodiscard]] double colour_high() const { return high + 0.5 * step; }
};

Scale scale_of(const HeatMapLayout& layout) {
  const double width = layout.high - layout.low;
  const double step = layout.steps > 1 ? width / (layout.steps - 1) : 0.06 * width;
  return {layout.low, layout.high, step};
}

/// Colours of viridis (Smith & van der Walt, 2015, CC0) at equal distances.
constexpr const char* kSequential[] = {"#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"};

std::string palette(const HeatMapLayout& layout, const Scale& scale) {
  const bool grey = layout.colours == HeatMapLayout::Colours::kGrey;
  const std::string none = grey ? "#E8A27C" : "#FFFFFF";
  std::string text =
      fmt::format("set palette defined ({:.9g} '{}', {:.9g} '{}'", scale.bottom(), none, scale.colour_low(), none);
  if (grey) {
    text += fmt::format(", {:.9g} '#000000', {:.9g} '#FFFFFF'", scale.colour_low(), scale.colour_high());
    return text + ")";
  }
  constexpr int kAnchors = static_cast<int>(std::size(kSequential));
  const auto colour_at = [&](double share) {
    const double place = share * (kAnchors - 1);
    const int below = std::min(static_cast<int>(place), kAnchors - 2);
    unsigned mixed = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
      const auto channel = [&](int anchor) {
        return static_cast<double>((std::stoul(kSequential[anchor] + 1, nullptr, 16) >> shift) & 0xFFU);
      };
      const double value = channel(below) + (place - below) * (channel(below + 1) - channel(below));
      mixed |= static_cast<unsigned>(std::lround(value)) << static_cast<unsigned>(shift);
    }
    return fmt::format("#{:06X}", mixed);
  };
  if (layout.steps < 2) {
    for (int k = 0; k <= 20; ++k) {
      const double share = k / 20.0;
      text += fmt::format(", {:.9g} '{}'", scale.colour_low() + share * (scale.colour_high() - scale.colour_low()),
                          colour_at(share));
    }
    return text + ")";
  }
  for (int k = 0; k < layout.steps; ++k) {
    const std::string colour = colour_at(static_cast<double>(k) / (layout.steps - 1));
    const double centre = scale.low + k * scale.step;
    text +=
        fmt::format(", {:.9g} '{}', {:.9g} '{}'", centre - 0.5 * scale.step, colour, centre + 0.5 * scale.step, colour);
  }
  return text + ")";
}

std::string colour_tics(const HeatMapLayout& layout, const Scale& scale) {
  std::string tics = fmt::format("set cbtics (\"{}\" {:.9g}", literal(layout.missing.empty() ? "none" : layout.missing),
                                 scale.missing());
  const int count = layout.steps > 1 ? layout.steps - 1 : 5;
  const int every = layout.words.empty() ? std::max(1, (count + 7) / 8) : 1;
  for (int k = 0; k <= count; k += every) {
    const double value = layout.low + k * (layout.high - layout.low) / count;
    const bool open = k + every > count && layout.steps > 1;
    const std::string word = layout.words.empty() ? fmt::format("{}{:.3g}", open ? "≥ " : "", value)
                                                  : literal(layout.words[static_cast<std::size_t>(k)]);
    tics += fmt::format(", \"{}\" {:.9g}", word, value);
  }
  return tics + ")";
}

/// Grid points as x y z, line of the image by line.
std::string image_data(Figure& figure, const HeatMapPanel& panel, const Scale& scale) {
  const Eigen::Index count = panel.value.size();
  Eigen::VectorXd x(count), y(count), z(count);
  Eigen::Index k = 0;
  for (Eigen::Index j = 0; j < panel.y.size(); ++j) {
    for (Eigen::Index i = 0; i < panel.x.size(); ++i, ++k) {
      const double value = panel.value(j, i);
      x(k) = panel.x(i);
      y(k) = panel.y(j);
      z(k) = std::isfinite(value) ? std::clamp(value, scale.low, scale.high) : scale.missing();
    }
  }
  return figure.data({x, y, z});
}

/// Half a cell around the outer points.
std::string cell_range(const Eigen::VectorXd& values) {
  const double low = values.minCoeff(), high = values.maxCoeff();
  const double half = values.size() > 1 ? 0.5 * (high - low) / static_cast<double>(values.size() - 1)
                                        : 0.5 * std::max(std::abs(low), 1e-12);
  return fmt::format("[{:.9g}:{:.9g}]", low - half, high + half);
}

Drawing fields_drawing(const std::vector<HeatMapPanel>& panels, const HeatMapLayout& layout) {
  Drawing drawing{.panels = {}, .columns = static_cast<int>(panels.size())};
  for (const HeatMapPanel& panel : panels) {
    drawing.panels.push_back({.title = panel.title,
                              .x_label = layout.x_label,
                              .y_label = layout.y_label,
                              .field = ColourField{.x = panel.x,
                                                   .y = panel.y,
                                                   .value = panel.value,
                                                   .label = layout.value_label,
                                                   .low = layout.low,
                                                   .high = layout.high,
                                                   .words = layout.words,
                                                   .missing = layout.missing}});
    if (panel.line_x.size() > 0)
      drawing.panels.back().series.push_back({"", panel.line_x, panel.line_y, Series::Look::kLine, kLnmColour});
  }
  return drawing;
}

}  // namespace

Figure heat_maps(const std::vector<HeatMapPanel>& panels, const HeatMapLayout& layout) {
  const int count = static_cast<int>(panels.size());
  const Scale scale = scale_of(layout);
  Figure figure(1200, count == 1 ? 800 : 620);
  common_style(figure);
  figure.show(fields_drawing(panels, layout));
  figure.command("unset grid; unset key");
  figure.command(palette(layout, scale));
  figure.command(fmt::format("set cbrange [{:.9g}:{:.9g}]", scale.bottom(), scale.colour_high()));
  figure.command(colour_tics(layout, scale));
  const double height = figure.height();
  const double right = layout.words.empty() ? 0.83 : 0.76;
  figure.command(fmt::format("set multiplot layout 1,{} margins 0.085,{},{:.4f},{:.4f} spacing 0.03,0", count, right,
                             85.0 / height, 1.0 - 45.0 / height));
  for (int i = 0; i < count; ++i) {
    const HeatMapPanel& panel = panels[static_cast<std::size_t>(i)];
    const bool last = i + 1 == count;
    figure.command(fmt::format("set title \"{}\" offset 0,-0.6", literal(panel.title)));
    figure.command(fmt::format("set xlabel \"{}\"", layout.x_label));
    figure.command(i == 0 ? fmt::format("set ylabel \"{}\"", layout.y_label) : std::string("unset ylabel"));
    figure.command(i == 0 ? "set format y '%g'" : "set format y ''");
    figure.command(last ? fmt::format("set colorbox user origin screen {},graph 0 size 0.022,graph 1", right + 0.015)
                        : std::string("unset colorbox"));
    if (last) {
      figure.command(
          fmt::format("set label 1 \"{}\" at screen 0.99,{:.4f} right", layout.value_label, 1.0 - 22.0 / height));
    }
    figure.command(fmt::format("set xrange {}; set yrange {}", cell_range(panel.x), cell_range(panel.y)));
    std::string plot = fmt::format("plot {} using 1:2:3 with image", image_data(figure, panel, scale));
    if (panel.line_x.size() > 0) {
      plot += fmt::format(", {} using 1:2 with lines lw 2 lc rgb '{}'", figure.data({panel.line_x, panel.line_y}),
                          kLnmColour);
    }
    figure.command(plot);
  }
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
