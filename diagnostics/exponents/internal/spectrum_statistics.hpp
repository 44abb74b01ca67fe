#pragma once

#include <slipmode/diagnostics/exponents/lyapunov_spectrum.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// Fills in exponents, errors, halves and dimension from the growth of every direction in every interval.
/// @param spectrum  with size, lost and interval; `rates` come from `growth`
/// @param growth    ln of the growth [k x m], m ≥ 1; rows beyond the N − lost first are replaced by −∞
void summarise(LyapunovSpectrum& spectrum, const Eigen::Ref<const Eigen::MatrixXd>& growth);

}  // namespace slipmode::diagnostics
