#pragma once

#include "figures/gnuplot.hpp"
#include "results/store.hpp"

#include <functional>
#include <string>
#include <vector>

namespace slipmode::cli {

/// A figure that a result file can give.
struct FileFigure {
  std::string name;  ///< "bifurcation", "deviation", "levels", "orbits", "shapes", "energy", "history", "portrait"
  std::string what;  ///< one line about it
  std::function<figures::Figure()> draw;  ///< reads what it needs when called; the reader must still live
};

/// All figures a file can give, the most telling first; empty when it holds nothing to draw.
[[nodiscard]] std::vector<FileFigure> figures_of(const results::StoreReader& store);

}  // namespace slipmode::cli
