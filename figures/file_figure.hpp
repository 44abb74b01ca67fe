#pragma once

#include "figures/gnuplot.hpp"
#include "results/store.hpp"

#include <functional>
#include <string>
#include <vector>

namespace slipmode::figures {

/// A figure that a result file can give.
struct FileFigure {
  std::string name;              ///< "bifurcation", "deviation", "levels", "orbits", "shapes", "energy", "history", ...
  std::string what;              ///< one line about it
  std::function<Figure()> draw;  ///< reads what it needs when called; the reader must still live
};

}  // namespace slipmode::figures
