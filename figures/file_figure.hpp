#pragma once

#include <slipmode/figures/gnuplot.hpp>
#include <slipmode/results/store.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace slipmode::figures {

/// A figure that a result file can give.
struct FileFigure {
  std::string name;              ///< "bifurcation", "deviation", "levels", "orbits", "shapes", "energy", "history", ...
  std::string what;              ///< one line about it
  std::function<Figure()> draw;  ///< reads what it needs when called; the reader must still live
};

/// Figures offered by groups that a file may hold.
class FileFigures {
 public:
  explicit FileFigures(const results::StoreReader& store) : store_(store) {}
  /// @param group  the figure is there if the file has it @param draw  draw(store)
  template <class Draw>
  void add(const std::string& group, std::string name, std::string what, Draw draw) {
    if (store_.has(group))
      all.push_back({std::move(name), std::move(what), [&store = store_, draw] { return draw(store); }});
  }

  std::vector<FileFigure> all;

 private:
  const results::StoreReader& store_;
};

/// Draws each as FOLDER/<name>.svg and .png; makes the folder when it is not there.
/// @return the names, in order
std::vector<std::string> save_all(const std::vector<FileFigure>& all, const std::filesystem::path& folder);

}  // namespace slipmode::figures
