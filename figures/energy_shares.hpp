#pragma once

#include <slipmode/figures/gnuplot.hpp>

namespace slipmode::figures {

struct EnergyShares {
  Eigen::VectorXd pom;           ///< share of each POM, descending, sums to 1 over all
  Eigen::VectorXd lnm_captured;  ///< cumulative share the first L LNMs capture; may be empty
  double threshold = 0.99;       ///< the share the choice of modes asked for, drawn as a line
};

/// Left: share of each mode on a logarithmic axis. Right: what the first L modes leave out (1 − cumulative share), also
/// logarithmic, because the differences that decide sit beyond 99 %; the threshold is drawn as a line.
[[nodiscard]] Figure energy_shares(const EnergyShares& shares);

}  // namespace slipmode::figures
