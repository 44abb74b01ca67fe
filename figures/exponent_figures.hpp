#pragma once

#include <slipmode/figures/gnuplot.hpp>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace slipmode::figures {

/// Exponents of one model, descending; the lost ones left out.
struct ExponentSeries {
  std::string title;
  Eigen::VectorXd value, error;
  std::string_view colour;
};

/// Exponents against their number with error bars: all above, the leading ones enlarged below.
/// @param leading  how many are enlarged
[[nodiscard]] Figure exponent_spectrum(const std::vector<ExponentSeries>& models, Eigen::Index leading,
                                       const std::string& unit);

/// What one model's exponents were after every interval.
struct ExponentHistory {
  std::string title;
  Eigen::VectorXd time;
  Eigen::MatrixXd running;  ///< [exponent x time]
};

/// One panel per model, a curve per exponent, towards the values at the right.
[[nodiscard]] Figure exponent_convergence(const std::vector<ExponentHistory>& models, const std::string& unit,
                                          const std::string& time_unit);

/// One model over a swept key.
struct ExponentSweep {
  std::string title;
  Eigen::VectorXd slip_parameter, slip_value;  ///< the bifurcation diagram; may be empty
  Eigen::VectorXd parameter;
  Eigen::MatrixXd exponents;  ///< [exponent x value]; NaN where there is none
  std::string_view colour;
};

/// The bifurcation diagram above, the exponents below, a column per model.
[[nodiscard]] Figure exponent_sweep(const std::vector<ExponentSweep>& models, const std::string& parameter_label,
                                    const std::string& value_label, const std::string& unit);

}  // namespace slipmode::figures
