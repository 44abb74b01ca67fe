#pragma once

#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/results/store.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace slipmode::figures {

/// A figure that a result file can give.
struct FileFigure {
  std::string name;  ///< "bifurcation", "deviation", "levels", "orbits", "shapes", "energy", "history", ...
  std::string what;  ///< one line about it
  std::function<Figure(const results::StoreReader&)> draw;
};

/// Draws each as FOLDER/<name>.svg and .png; makes the folder when it is not there.
/// @return the names, in order
std::vector<std::string> save_all(const results::StoreReader& store, const std::vector<FileFigure>& all,
                                  const std::filesystem::path& folder);

}  // namespace slipmode::figures
