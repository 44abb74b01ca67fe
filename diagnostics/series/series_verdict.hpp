#pragma once

#include <slipmode/diagnostics/series/divergence.hpp>
#include <slipmode/diagnostics/series/exponent_spectrum.hpp>
#include <slipmode/diagnostics/series/false_neighbours.hpp>
#include <slipmode/diagnostics/series/mutual_information.hpp>
#include <slipmode/diagnostics/series/series.hpp>
#include <slipmode/diagnostics/series/smoothness.hpp>
#include <slipmode/diagnostics/series/surrogates.hpp>

#include <optional>
#include <string>

namespace slipmode::diagnostics {

enum class SeriesMotion {
  kPeriodic,
  kQuasiPeriodic,
  kChaotic,
  kNoise,       ///< not told from linear noise of the same spectrum and distribution
  kNotSettled,  ///< the halves of the record differ, or the evidence is not enough for any of the others
};

[[nodiscard]] const char* to_string(SeriesMotion motion);

struct VerdictOptions {
  int max_dimension = 8;           ///< of the embedding
  Eigen::Index references = 4000;  ///< points examined by each tool
  /// Largest mean squared difference of the record and itself one period later, over twice its variance.
  double repeat = 1e-5;
  Eigen::Index surrogate_samples = 2048;    ///< of the record's start that are told from noise; many-dimensional: more
  Eigen::Index forecasts = 500;             ///< made per series in that test
  std::optional<Embedding> embedding = {};  ///< empty: delay by mutual information, dimension by false neighbours
  ParallelOptions run = {};
};

/// How a record repeats itself.
struct Repeat {
  double samples = 0.0;   ///< shift of the first repeat [samples]; 0: none up to a third of the record
  double mismatch = 1.0;  ///< at that shift, or the least at any: mean squared difference over twice the variance
};

/// The first shift at which a record repeats itself: where S(m) = ⟨(x_{j+m} − x_j)²⟩/2σ² first falls to `tolerance`.
/// With six samples per mean period or more S is taken between samples too, by the polynomial through the five nearest.
/// @throws InvalidInput  as check_series, for fewer than 100 samples or tolerance ≤ 0
[[nodiscard]] Repeat find_repeat(const Series& series, double tolerance);

/// What a series is, and on what grounds.
struct SeriesVerdict {
  SeriesMotion motion = SeriesMotion::kNotSettled;
  std::string reason;  ///< one sentence with the figures that decided
  int period = 0;      ///< periodic: loops per period, or samples if there are fewer than 6 samples per loop
  double T = 0.0;      ///< periodic: its period [time unit]
  Repeat repeat;
  bool sampled_map = false;  ///< fewer than 6 samples per loop: taken as a map, lag 1
  Embedding embedding;       ///< used below
  Smoothness smoothness;
  SurrogateTest surrogates;  ///< not run for periodic records, nor is what follows
  ExponentSpectrum spectrum;
  Divergence divergence;  ///< not run where the exponents decide
  VerdictOptions settings;
};

/// Periodic, quasi-periodic, chaotic, noise or not settled, in this order of tests:
///  1. not settled   the variances of the halves differ by a factor above 1.5, or only one half repeats itself, unless
///                   forecasts miss by more than 0.6 deviations;
///  2. periodic      the record repeats itself (find_repeat);
///  3. noise         forecasts are no better than on surrogates, or miss by more than 0.6 deviations and are better
///                   than those by less than three of their standard deviations;
///  4. quasi-periodic  the largest exponent is zero: below three of its errors or 0.01 per loop; forecasts miss by <
///  0.1;
///  5. chaotic       the largest exponent is above three errors by fitted Jacobians, and neighbours diverge in both
///                   halves;
///  6. else not settled.
/// smoothness.doubtful is a warning to be shown with it.
/// @throws InvalidInput  for fewer than 1,000 samples, or as the tools
[[nodiscard]] SeriesVerdict series_verdict(const Series& series, const VerdictOptions& options = {});

}  // namespace slipmode::diagnostics
