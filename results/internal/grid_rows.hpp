#pragma once

#include <slipmode/orbits/orbit_map.hpp>
#include <slipmode/results/table.hpp>
#include "results/internal/journal_line.hpp"

#include <Eigen/Core>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// Inside of the stores of maps and basins: rows of points with a `failure` each.
namespace slipmode::results::detail {

/// Failures of a row as the note of its journal record, one line per point, and back; empty where all went well.
template <class Point>
void list_failures(const Line& line, std::string& note, std::vector<Point>& row) {
  if (line.reads()) {
    std::istringstream failures(std::exchange(note, {}));
    for (Point& point : row) std::getline(failures, point.failure);
    return;
  }
  bool any = false;
  std::string text;
  for (const Point& point : row) {
    text += point.failure + '\n';
    any = any || !point.failure.empty();
  }
  note = any ? text : std::string();
}

/// One number of every point [y x x].
template <class Point, class Number>
Eigen::MatrixXd layer(const std::vector<std::vector<Point>>& rows, std::size_t columns, const Number& number) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns));
  for (std::size_t j = 0; j < rows.size(); ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      values(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = static_cast<double>(number(rows[j][i]));
    }
  }
  return values;
}

template <class Point>
void store_failures(StoreWriter& writer, const std::string& group, const orbits::MapGrid& grid,
                    const std::vector<std::vector<Point>>& rows) {
  std::vector<double> x, y;
  std::vector<std::string> text;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    for (std::size_t i = 0; i < rows[j].size(); ++i) {
      if (rows[j][i].failure.empty()) continue;
      x.push_back(grid.x[i]);
      y.push_back(grid.y[j]);
      text.push_back(rows[j][i].failure);
    }
  }
  save(writer, group,
       Table{"points at which the flow failed",
             {{"x", {"", "value of the first key"}, x},
              {"y", {"", "value of the second key"}, y},
              {"failure", {"", "why"}, text}}});
}

}  // namespace slipmode::results::detail
