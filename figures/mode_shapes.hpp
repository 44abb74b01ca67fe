#pragma once

#include <slipmode/figures/gnuplot.hpp>

namespace slipmode::figures {

struct ModeShapes {
  Eigen::MatrixXd poms;    ///< n x L
  Eigen::MatrixXd lnms;    ///< n x L', drawn dashed beside the POM of the same number; may be empty
  Eigen::VectorXd shares;  ///< energy share of each POM; may be empty
};

/// Shapes against the number of the mass, one panel per mode (at most twelve), each scaled to a largest component of
/// one in magnitude, its share of the energy in the title; an LNM is turned to the sign of its POM.
[[nodiscard]] Figure mode_shapes(const ModeShapes& shapes);

}  // namespace slipmode::figures
