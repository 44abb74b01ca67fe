#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace slipmode::figures {

struct RecurrencePlot {
  std::vector<std::int64_t> i, j;  ///< pairs of points that recur
  std::int64_t points = 0;
  double interval = 1.0, start = 0.0;  ///< of the points, in `time_unit`
  std::string time_unit, title;
};

/// Black where pairs recur, a cell for each pair of points; of more than 800 points the first 800.
[[nodiscard]] Figure recurrence_plot(const RecurrencePlot& plot);

}  // namespace slipmode::figures
