#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>

namespace slipmode::figures {

struct DelayMap {
  Eigen::VectorXd now, later, last;  ///< s(t), s(t + delay), s(t + 2·delay), same length
  std::string symbol = "s";
  std::string unit;
  std::string delay;    ///< as text with its unit: "5.5 s"
  bool is_path = true;  ///< neighbouring entries are joined; else points
};

/// The record in two delay coordinates, and in three as a projection beside it.
[[nodiscard]] Figure delay_map(const DelayMap& map);

}  // namespace slipmode::figures
