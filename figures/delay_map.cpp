#include <slipmode/figures/delay_map.hpp>

#include <slipmode/figures/style.hpp>

#include <fmt/format.h>

namespace slipmode::figures {

Figure delay_map(const DelayMap& map) {
  Figure figure(1200, 640);
  common_style(figure);
  const std::string look = map.is_path
                               ? fmt::format("with lines linewidth 0.5 linecolor rgb '{}'", kFullColour)
                               : fmt::format("with points pointtype 7 pointsize 0.2 linecolor rgb '{}'", kFullColour);
  const std::string range = padded_range(map.now.minCoeff(), map.now.maxCoeff());
  const auto label = [&](const std::string& shift) {
    return axis_label(fmt::format("{}({})", map.symbol, shift), map.unit);
  };
  const std::string data = figure.data({map.now, map.later, map.last});
  figure.show({.panels = {{.title = "delay " + map.delay,
                           .series = {{"", map.now, map.later, map.is_path ? Series::Look::kLine : Series::Look::kDots,
                                       kFullColour}},
                           .x_label = label("t"),
                           .y_label = label("t + delay")}}});
  figure.command("unset key");
  figure.command("set multiplot");
  figure.command("set lmargin at screen 0.095; set rmargin at screen 0.485");
  figure.command("set bmargin at screen 0.13; set tmargin at screen 0.93");
  figure.command(fmt::format("set xrange {0}; set yrange {0}; set zrange {0}", range));
  figure.command(fmt::format("set title \"delay {}\" offset 0,-0.6", literal(map.delay)));
  figure.command(fmt::format("set xlabel \"{}\"; set ylabel \"{}\"", label("t"), label("t + delay")));
  figure.command(fmt::format("plot {} using 1:2 {}", data, look));
  // A projection keeps to its part of the page by size and origin; margins do not hold it.
  figure.command(
      "unset lmargin; unset rmargin; unset bmargin; unset tmargin; set origin 0.49,-0.06; set size 0.52,1.12");
  figure.command("unset title; set border 31; set xyplane 0; set view 62,38; set grid x y z vertical");
  figure.command("set xtics offset -0.4,-0.4; set ytics offset 0.4,-0.4");
  figure.command(
      fmt::format("set xlabel \"{}\" offset 0,-0.8; set ylabel \"{}\" offset 0,-0.8; "
                  "set zlabel \"{}\" rotate",
                  label("t"), label("t + delay"), label("t + 2 delay")));
  figure.command(fmt::format("splot {} using 1:2:3 {}", data, look));
  figure.command("unset multiplot");
  return figure;
}

}  // namespace slipmode::figures
