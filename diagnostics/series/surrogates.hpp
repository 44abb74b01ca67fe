#pragma once

#include <slipmode/core/parallel.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/diagnostics/series/embedding.hpp>
#include <slipmode/diagnostics/series/series.hpp>

#include <Eigen/Core>

namespace slipmode::diagnostics {

/// What a surrogate keeps of the series.
enum class SurrogateKind {
  kPhase,      ///< the amplitude spectrum exactly; phases are drawn anew
  kAmplitude,  ///< AAFT: the samples exactly, the spectrum nearly
  kIterated,   ///< IAAFT: the samples exactly, the spectrum as nearly as iterations bring it
};

/// A series like the given one but for everything beyond its spectrum (and the values of its samples).
/// @param random  phases 2π·uniform() in order of frequency (kPhase); normal() per sample, then phases (kAmplitude); a
///                Fisher-Yates shuffle from the last sample down, index ⌊uniform()·(j + 1)⌋ (kIterated)
/// @throws InvalidInput  for fewer than 16 samples, or as check_series
/// Source: Theiler and others, Physica D 58 (1992) 77; Schreiber, Schmitz, Phys. Rev. Lett. 77 (1996) 635.
[[nodiscard]] Series surrogate(const Series& series, SurrogateKind kind, Random& random);

struct SurrogateOptions {
  SurrogateKind kind = SurrogateKind::kIterated;
  int surrogates = 19;  ///< ≥ 19, with which a rank of 0 has p = 0.05
  Embedding embedding = {};
  Eigen::Index ahead = 1;         ///< the forecast looks this far [samples]
  Eigen::Index window = 0;        ///< of Theiler [samples]; 0: theiler_window(series)
  Eigen::Index references = 500;  ///< forecasts made per series, evenly spaced
  std::uint64_t seed = 1;         ///< surrogate k draws from Random::stream(seed, k)
  ParallelOptions run = {};       ///< surrogates run in parallel
};

/// Whether a series is told from noise of the same spectrum.
struct SurrogateTest {
  double error = 0.0;             ///< forecast error of the series, see forecast_error
  Eigen::VectorXd of_surrogates;  ///< the same of each surrogate, in order of index
  int rank = 0;                   ///< surrogates with a smaller error than the series
  double p = 1.0;                 ///< (rank + 1)/(surrogates + 1): chance of so low a rank for linear noise
  double distance = 0.0;          ///< (mean of the surrogates − error)/their standard deviation
  bool rejected = false;          ///< p ≤ 0.05: not linear noise seen through a static function
  SurrogateOptions settings;      ///< with the window used
};

/// Root mean square error of the forecast of s_{i+span+ahead} by its mean over the five nearest neighbours of x_i, over
/// the standard deviation of the series: near 0 for a known law, near 1 for independent samples.
/// @param window  of Theiler [samples]
/// @throws InvalidInput  for fewer samples than span + ahead + 2·window + 100
[[nodiscard]] double forecast_error(const Series& series, const Embedding& embedding, Eigen::Index ahead,
                                    Eigen::Index window, Eigen::Index references);

/// Null hypothesis: a linear stochastic process, seen through a monotone function (phase surrogates: seen as it is).
/// One-sided by rank of the forecast error. A periodic record is told from its surrogates only by chance: they are
/// periodic too.
/// @throws InvalidInput  as forecast_error, or for options out of range
[[nodiscard]] SurrogateTest surrogate_test(const Series& series, const SurrogateOptions& options = {});

}  // namespace slipmode::diagnostics
