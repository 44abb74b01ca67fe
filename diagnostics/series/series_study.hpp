#pragma once

#include <slipmode/core/fields.hpp>
#include <slipmode/diagnostics/series/correlation_dimension.hpp>
#include <slipmode/diagnostics/series/divergence.hpp>
#include <slipmode/diagnostics/series/exponent_spectrum.hpp>
#include <slipmode/diagnostics/series/false_neighbours.hpp>
#include <slipmode/diagnostics/series/mutual_information.hpp>
#include <slipmode/diagnostics/series/recurrence.hpp>
#include <slipmode/diagnostics/series/section.hpp>
#include <slipmode/diagnostics/series/series.hpp>
#include <slipmode/diagnostics/series/series_verdict.hpp>
#include <slipmode/diagnostics/series/spectrum.hpp>
#include <slipmode/diagnostics/series/wolf.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace slipmode::diagnostics {

/// The tools of a study, in the order they run.
enum class SeriesTool {
  kAutocorrelation,
  kInformation,
  kFalseNeighbours,
  kVerdict,
  kWolf,
  kDivergence,
  kKantz,
  kJacobians,
  kDimension,
  kSpectrum,
  kSection,
  kRecurrence,
  kSurrogates,
};

inline constexpr std::array kSeriesTools = {
    SeriesTool::kAutocorrelation, SeriesTool::kInformation, SeriesTool::kFalseNeighbours,
    SeriesTool::kVerdict,         SeriesTool::kWolf,        SeriesTool::kDivergence,
    SeriesTool::kKantz,           SeriesTool::kJacobians,   SeriesTool::kDimension,
    SeriesTool::kSpectrum,        SeriesTool::kSection,     SeriesTool::kRecurrence,
    SeriesTool::kSurrogates};

/// "autocorrelation", "information", "false-neighbours", "verdict", "wolf", "divergence", "kantz", "jacobians",
/// "dimension", "spectrum", "section", "recurrence", "surrogates".
[[nodiscard]] const char* to_string(SeriesTool tool);

/// @throws InvalidInput  for a word that is none of them, naming those there are
[[nodiscard]] std::vector<SeriesTool> series_tools(const std::vector<std::string>& words);

struct StudyOptions {
  std::vector<SeriesTool> tools = {};  ///< empty: all that the record allows and that mean something for it
  Eigen::Index delay = 0;
  int dimension = 0;
  Eigen::Index window = 0;
  std::vector<int> bins = {};  ///< of equal width, a curve of mutual information each; empty: 5, 10, 20, 40, 80 as S4
  int max_dimension = 10;
  double ratio = 15.0, size = 2.0, accepted = 0.01;
  Eigen::Index evolution = 0;
  double angle = 0.2, rate = 0.05;
  std::optional<double> strobe = std::nullopt;  ///< none as 0
  Eigen::Index references = 5000;
  int surrogates = 19;
  std::uint64_t seed = 1;    ///< of the surrogates
  ParallelOptions run = {};  ///< progress counts thousandths of all tools

  static constexpr auto fields() {
    constexpr Limits kShare{.low = 0.0, .high = 1.0, .text = "a number from 0 to 1"};
    constexpr Limits kRate{.low = 1e-6, .high = 0.999, .text = "a number from 1e-6 to 0.999"};
    return std::tuple{
        optional("delay", &StudyOptions::delay, "samples", "of the embedding; 0: by mutual information", kFromZero),
        optional("dimension", &StudyOptions::dimension, "", "of the embedding; 0: by false neighbours",
                 {.low = 0.0, .high = 100.0}),
        optional("window", &StudyOptions::window, "samples",
                 "neighbours nearer in time are left out (Theiler); 0: found", kFromZero),
        optional("max_dimension", &StudyOptions::max_dimension, "", "up to which false neighbours are counted",
                 {.low = 1.0, .high = 50.0}),
        optional("ratio", &StudyOptions::ratio, "1", "first criterion for a false neighbour; 3.162 is S4's", kPositive),
        optional("size", &StudyOptions::size, "1", "second criterion [standard deviations]", kPositive),
        optional("accepted", &StudyOptions::accepted, "1", "share of false neighbours at which a dimension is enough",
                 kShare),
        optional("evolution", &StudyOptions::evolution, "samples", "that Wolf's pairs are followed; 0: about a loop",
                 kFromZero),
        optional("angle", &StudyOptions::angle, "rad", "Wolf's replacements turn no more than this", kPositive),
        optional("rate", &StudyOptions::rate, "1", "share of pairs that recur in the recurrence plot", kRate),
        optional("strobe", &StudyOptions::strobe, "",
                 "time between section points; else the drive's period, without a drive upward through the mean (0)",
                 kNonNegative),
        optional("references", &StudyOptions::references, "", "points each tool examines, evenly spaced",
                 {.low = 100.0, .high = 1e8}),
        optional("surrogates", &StudyOptions::surrogates, "", "records of the same spectrum to compare with",
                 {.low = 19.0, .high = 1e5})};
  }
};

/// The delay and how far the estimators agree on it.
struct Delay {
  Eigen::Index samples = 1;
  Eigen::Index lowest = 1, highest = 1;  ///< first minima over all curves and both halves of the record
  std::string origin;                    ///< "given", "not looked for", "first minimum of mutual information", …
};

/// The dimension and how far its share of false neighbours pins it down.
struct EmbeddingDimension {
  int value = 1;
  int lowest = 1, highest = 1;  ///< at the share less, and plus, its error
  std::string origin;
};

/// Wolf's exponent depends on how long a pair is followed: at half, once and twice the chosen evolution, as far as the
/// record allows.
struct WolfStudy {
  WolfExponent chosen;
  std::vector<WolfExponent> others;
  double error = 0.0;  ///< root sum of squares of the scatter and half the spread over evolutions [nat per time unit]
};

/// A tool that gave nothing, and why.
struct ToolFailure {
  SeriesTool tool;
  std::string reason;
};

/// All that was asked about one record. What did not run is empty.
struct SeriesStudy {
  Series series;  ///< as examined
  double mean = 0.0, deviation = 0.0, root_mean_square = 0.0;
  double loop = 0.0;               ///< mean period [samples]
  bool sampled_map = false;        ///< fewer than 6 samples per loop
  Eigen::Index decorrelation = 0;  ///< [samples]
  Eigen::Index window = 0;         ///< of Theiler [samples]
  Delay delay;
  EmbeddingDimension dimension;
  std::optional<Smoothness> smoothness;
  std::optional<Eigen::VectorXd> autocorrelation;
  std::vector<MutualInformation> information;  ///< equal numbers per bin first, then none (a part), then equal widths
  std::optional<FalseNeighbours> false_neighbours;
  std::optional<CaoAverages> cao;
  std::optional<SeriesVerdict> verdict;
  std::optional<WolfStudy> wolf;
  std::optional<Divergence> divergence;  ///< across the flow; of a map Rosenstein's
  std::optional<Divergence> kantz;
  std::optional<ExponentSpectrum> jacobians;
  std::optional<CorrelationDimension> correlation;
  std::optional<AmplitudeSpectrum> spectrum;
  double peak = 0.0, peak_error = 0.0;  ///< of the spectrum, half its resolution [1/time unit]
  std::optional<SectionPoints> section;
  std::optional<Recurrence> recurrence;
  std::optional<SurrogateTest> surrogates;
  std::vector<ToolFailure> failures;
  StudyOptions settings;

  [[nodiscard]] Embedding embedding() const { return {.dimension = dimension.value, .lag = delay.samples}; }
};

/// Runs the tools on one record, each with the delay, dimension and window found or given. A tool that was not asked
/// for by name and cannot run (too few samples, no scaling region) leaves a line in `failures`; for a record that
/// repeats itself the tools for exponents are left out in the same way.
///
/// Same result for any number of threads.
/// @throws InvalidInput  for fewer than 100 samples, options out of range, too few samples for a dimension or delay
///                       that was given, or a tool named in `tools` that cannot run
/// @throws NumericalFailure  of the only tool named in `tools`
/// @throws Interrupted       when run.stop is set
[[nodiscard]] SeriesStudy study_series(const Series& series, const StudyOptions& options = {});

}  // namespace slipmode::diagnostics
