#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <string_view>

namespace slipmode::figures {

/// One colour per model in every figure (Okabe-Ito, distinct for colour-blind readers and in grey).
inline constexpr std::string_view kFullColour = "#222222";
inline constexpr std::string_view kPomColour = "#0072B2";
inline constexpr std::string_view kLnmColour = "#D55E00";
inline constexpr std::string_view kSecondColour = "#009E73";
inline constexpr std::string_view kStickShade = "#C9DDEE";

/// Legend at the top right of the whole figure, clear of all data; needs 75 pixels above the first row of panels.
inline constexpr std::string_view kLegendAbove = "set key at screen 0.985,0.995 right top horizontal maxrows 1";

/// "displacement x_{10} [m]"; a dimensionless quantity (unit "", "1", "-") gets "[–]".
[[nodiscard]] std::string axis_label(std::string_view quantity, std::string_view unit);

/// Borders left and below, light grid, ticks outside: the frame that all figures share.
void common_style(Figure& figure);

/// Tics of the x axis in one of several columns: as many as have room for their labels, which are long where numbers
/// are small or large (1.5×10⁻⁶).
[[nodiscard]] std::string x_tics(double low, double high, int columns);

/// A range a little wider than the data: "[low:high]". Never empty: a constant stands in the middle, and without data
/// (infinite bounds) it is "[0:1]".
[[nodiscard]] std::string padded_range(double low, double high, double margin = 0.04);

}  // namespace slipmode::figures
