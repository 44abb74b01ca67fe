#include "cli/figures/style.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::figures {

std::string axis_label(std::string_view quantity, std::string_view unit) {
  const bool dimensionless = unit.empty() || unit == "1" || unit == "-" || unit == "dimensionless";
  // A no-break space: renderers of SVG drop an ordinary one after a subscript.
  return fmt::format("{} [{}]", quantity, dimensionless ? "–" : literal(unit));
}

void common_style(Figure& figure) {
  figure.command("set encoding utf8");
  figure.command("set border 3 linecolor rgb '#555555'");
  figure.command("set tics out nomirror textcolor rgb '#222222'");
  figure.command("set grid linetype 1 linecolor rgb '#E4E4E4' linewidth 0.6");
  figure.command("set key noopaque samplen 2.5 spacing 1.15");
}

std::string padded_range(double low, double high, double margin) {
  double width = high - low;
  if (!(width > 0.0)) width = std::max(std::abs(low), 1.0) * 0.1;
  return fmt::format("[{:.8g}:{:.8g}]", low - margin * width, high + margin * width);
}

}  // namespace slipmode::figures
