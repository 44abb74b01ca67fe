#include <slipmode/figures/style.hpp>

#include <fmt/format.h>
#include <algorithm>
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

std::string x_tics(double low, double high, int columns) {
  constexpr double kCharacters = 105.0, kGap = 2.0;  // across the page; between labels
  if (columns == 1 || !std::isfinite(high - low) || !(high > low)) return "set xtics autofreq";
  const auto length = [](double tic) { return static_cast<double>(fmt::format("{:.6g}", tic).size()); };
  double unit = std::pow(10.0, std::floor(std::log10(high - low)) - 1.0);
  for (;; unit *= 10.0) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double step = digit * unit;
      const double longest = std::max(length(step * std::floor(low / step)), length(step * std::floor(high / step)));
      const double all = (high - low) / step * (longest + kGap);
      if (all <= kCharacters / columns || step > high - low) return fmt::format("set xtics {:.1g}", step);
    }
  }
}

std::string padded_range(double low, double high, double margin) {
  if (!std::isfinite(low) || !std::isfinite(high)) return "[0:1]";
  constexpr double kRounding = 1e-6;  // narrower than this, a curve is a constant with noise, and labels would be equal
  const double largest = std::max(std::abs(low), std::abs(high));
  const double scale = largest > 0.0 ? largest : 1.0;
  double width = high - low;
  if (!(width > kRounding * scale)) width = 0.1 * scale / margin;
  return fmt::format("[{:.8g}:{:.8g}]", low - margin * width, high + margin * width);
}

}  // namespace slipmode::figures
