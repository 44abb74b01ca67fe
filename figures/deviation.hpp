#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace slipmode::figures {

/// Deviations of the reduced models of one kind of basis from the full model.
struct DeviationCurve {
  std::string name;         ///< "POM", "LNM"
  Eigen::VectorXd modes;    ///< number of modes kept
  Eigen::VectorXd delta_x;  ///< ΔX [%], S4 (3.37)
  Eigen::VectorXd delta_e;  ///< ΔE [%], S4 (3.36)
  std::string_view colour;
};

/// One column of panels: the same comparison on one motion.
struct DeviationCase {
  std::string title;  ///< the motion and the horizon
  std::vector<DeviationCurve> curves;
};

/// ΔX above, |ΔE| below, on logarithmic axes against the number of modes; one column per motion.
[[nodiscard]] Figure deviation(const std::vector<DeviationCase>& cases);

}  // namespace slipmode::figures
