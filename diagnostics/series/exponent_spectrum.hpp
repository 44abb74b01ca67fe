#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

struct SpectrumOptions {
  Embedding embedding = {};
  int neighbours = 20;       ///< per point, ≥ 2·dimension
  Eigen::Index window = 0;   ///< of Theiler [samples]; 0: theiler_window(series)
  ParallelOptions run = {};  ///< points run in parallel
};

/// Exponents of a series, one per dimension of the embedding.
struct ExponentSpectrum {
  Eigen::VectorXd exponents;  ///< descending [nat per time unit of the series]
  Eigen::VectorXd error;      ///< standard error from the scatter of eight equal stretches [nat per time unit]
  double dimension = 0.0;     ///< Kaplan-Yorke
  Eigen::Index steps = 0;     ///< Jacobians multiplied, one per lag
  SpectrumOptions settings;   ///< with the window used
};

/// Exponents from fitted Jacobians. Over one lag a delay vector shifts by one place and gains s_{i+d·lag}; the change
/// of that sample with x_i is fitted, by least squares with a constant, to the `neighbours` nearest points and theirs.
/// The product of these matrices along the record is kept in QR form.
///
/// More dimensions than the motion needs add exponents that mean nothing; the largest is not touched by them in
/// general. Strongly negative exponents are lost: the data hold no distances across so thin a sheet. Cost: T/lag fits.
/// @throws InvalidInput  for options out of range, or fewer samples than span + lag·(100 + 1) + 2·window + neighbours
/// Source: Sano, Sawada, Phys. Rev. Lett. 55 (1985) 1082; Eckmann, Oliffson Kamphorst, Ruelle, Ciliberto, Phys. Rev. A
/// 34 (1986) 4971, whose one-row form this is.
[[nodiscard]] ExponentSpectrum exponent_spectrum(const Series& series, const SpectrumOptions& options = {});

}  // namespace slipmode::diagnostics
