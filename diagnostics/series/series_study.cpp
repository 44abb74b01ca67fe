#include <slipmode/diagnostics/series/series_study.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace slipmode::diagnostics {

namespace {

constexpr Eigen::Index kWithoutBins = 4000;    // samples of the bin-free estimator
constexpr Eigen::Index kTestedSamples = 8192;  // by surrogates

bool is_exponent_tool(SeriesTool tool) {
  switch (tool) {
    case SeriesTool::kWolf:
    case SeriesTool::kDivergence:
    case SeriesTool::kKantz:
    case SeriesTool::kJacobians:
    case SeriesTool::kDimension:
    case SeriesTool::kSurrogates:
      return true;
    default:
      return false;
  }
}

/// One study under way: what later tools need of earlier ones is in `out`.
class SeriesExamination {
 public:
  SeriesExamination(const Series& series, const StudyOptions& options) {
    out.series = series;
    out.settings = options;
    constexpr Eigen::Index kLeast = 100;
    check_series(series, kLeast, "diagnosis");
    check_options();
    const Eigen::ArrayXd x = series.values;
    out.mean = x.mean();
    out.deviation = std::sqrt((x - out.mean).square().mean());
    out.root_mean_square = std::sqrt(x.square().mean());
    out.loop = mean_period(series);
    out.sampled_map = is_sampled_map(out.loop);
    out.decorrelation = decorrelation_lag(series);
    out.window = options.window > 0 ? options.window : theiler_window(series);
    out.smoothness = smoothness(series);
    if (const Eigen::Index given = options.delay; given > 0) out.delay = {given, given, given, "given"};
    if (const int given = options.dimension; given > 0) out.dimension = {given, given, given, "given"};
  }

  SeriesStudy run() {
    for (const SeriesTool tool : kSeriesTools) {
      run_.progress = progress_of(tool);
      if (wanted(tool)) attempt(tool);
      if (tool == SeriesTool::kFalseNeighbours) check_embedding();
      if (out.settings.run.stop != nullptr && out.settings.run.stop->load()) throw Interrupted();
    }
    return std::move(out);
  }

 private:
  void check_options() const {
    for_each_field<StudyOptions>([&]<class T>(const Field<StudyOptions, T>& field) {
      double value = 0.0;
      if constexpr (std::is_same_v<T, std::optional<double>>)
        value = (out.settings.*field.member).value_or(field.limits.low);
      else
        value = static_cast<double>(out.settings.*field.member);
      if (field.limits.hold(value)) return;
      throw InvalidInput(fmt::format("diagnosis: {} = {}: expected {}", field.name, value,
                                     std::is_integral_v<T> ? integer_text(field.limits) : field.limits.text));
    });
    for (const int bins : out.settings.bins)
      if (bins < 2 || bins > 1000)
        throw InvalidInput(fmt::format("diagnosis: bins = {}: expected an integer from 2 to 1000", bins));
  }

  bool named(SeriesTool tool) const { return std::ranges::count(out.settings.tools, tool) > 0; }

  /// Delay and dimension are needed by most tools even where their curves were not asked for.
  bool wanted(SeriesTool tool) const {
    if (out.settings.tools.empty() || named(tool)) return true;
    const bool embeds = std::ranges::any_of(out.settings.tools, [](SeriesTool other) {
      return other > SeriesTool::kFalseNeighbours && other != SeriesTool::kSpectrum;
    });
    if (tool == SeriesTool::kInformation) {
      return out.settings.delay == 0 && (embeds || named(SeriesTool::kFalseNeighbours));
    }
    return tool == SeriesTool::kFalseNeighbours && out.settings.dimension == 0 && embeds;
  }

  ProgressCallback progress_of(SeriesTool tool) const {
    if (!out.settings.run.progress) return {};
    constexpr std::size_t kParts = 1000;
    const auto before = static_cast<std::size_t>(tool) * kParts;
    return [this, before](std::size_t done, std::size_t total) {
      out.settings.run.progress(before + kParts * done / std::max<std::size_t>(total, 1), kParts * kSeriesTools.size());
    };
  }

  void attempt(SeriesTool tool) {
    if (!named(tool) && is_exponent_tool(tool) && repeats()) {
      out.failures.push_back({tool, "not run: the record repeats itself"});
      return;
    }
    try {
      use(tool);
    } catch (const InvalidInput& refusal) {
      if (named(tool)) throw;
      out.failures.push_back({tool, refusal.what()});
    } catch (const NumericalFailure& failure) {
      if (named(tool) && out.settings.tools.size() == 1) throw;
      out.failures.push_back({tool, failure.what()});
    }
  }

  bool repeats() const { return out.verdict && out.verdict->motion == SeriesMotion::kPeriodic; }

  void use(SeriesTool tool) {
    switch (tool) {
      case SeriesTool::kAutocorrelation:
        out.autocorrelation = diagnostics::autocorrelation(series(), longest_lag());
        return;
      case SeriesTool::kInformation:
        return find_delay();
      case SeriesTool::kFalseNeighbours:
        return find_dimension();
      case SeriesTool::kVerdict:
        out.verdict = series_verdict(series(), {.references = std::min<Eigen::Index>(out.settings.references, 4000),
                                                .surrogate_samples = kTestedSamples,
                                                .forecasts = forecasts(),
                                                .embedding = out.embedding(),
                                                .run = run_});
        return;
      case SeriesTool::kWolf:
        return follow_one_pair();
      case SeriesTool::kDivergence:
        out.divergence = diverge(out.sampled_map ? DivergenceMethod::kRosenstein : DivergenceMethod::kTransverse);
        return;
      case SeriesTool::kKantz:
        out.kantz = diverge(DivergenceMethod::kKantz);
        return;
      case SeriesTool::kJacobians:
        return fit_jacobians();
      case SeriesTool::kDimension:
        out.correlation = correlation_dimension(
            series(),
            {.embedding = out.embedding(), .window = out.window, .references = out.settings.references, .run = run_});
        return;
      case SeriesTool::kSpectrum:
        return find_peak();
      case SeriesTool::kSection:
        return cut();
      case SeriesTool::kRecurrence:
        out.recurrence = diagnostics::recurrence(
            series(),
            {.embedding = out.embedding(), .rate = out.settings.rate, .stride = plot_stride(), .window = out.window});
        return;
      case SeriesTool::kSurrogates:
        return test_surrogates();
    }
  }

  const Series& series() const { return out.series; }

  /// Samples in a part of the mean period, 1 for maps.
  Eigen::Index loop_part(double parts) const {
    return out.sampled_map ? 1 : std::max<Eigen::Index>(1, std::lround(out.loop / parts));
  }

  /// An eighth of a loop, at most half a delay: mean crossings are rarer than loops where a motion has several centres.
  Eigen::Index fine_stride() const { return std::clamp<Eigen::Index>(out.delay.samples / 2, 1, loop_part(8.0)); }

  /// Finer where the record would give fewer than two hundred points.
  Eigen::Index plot_stride() const {
    constexpr Eigen::Index kPoints = 200;
    const Eigen::Index known = series().values.size() - out.embedding().span() - 2 * out.window;
    return std::min(fine_stride(), std::max<Eigen::Index>(1, known / kPoints));
  }

  /// Two loops, at least twenty samples, at most an eighth of the record.
  Eigen::Index longest_lag() const {
    return std::min(std::max<Eigen::Index>(20, std::lround(2.0 * out.loop)), series().values.size() / 8);
  }

  void take_minima(const MutualInformation& information) {
    for (const Eigen::Index lag :
         {information.first_minimum, information.first_minimum_of_halves[0], information.first_minimum_of_halves[1]}) {
      if (lag < 1) continue;
      out.delay.lowest = std::min(out.delay.lowest, lag);
      out.delay.highest = std::max(out.delay.highest, lag);
    }
  }

  void find_delay() {
    const Eigen::Index most = longest_lag();
    out.information.push_back(mutual_information(series(), {.max_lag = most, .run = run_}));
    const Series start = part(series(), 0, std::min(series().values.size(), kWithoutBins));
    out.information.push_back(
        mutual_information(start, {.max_lag = most, .estimator = InformationEstimator::kNearest, .run = run_}));
    const bool given = !out.settings.bins.empty();
    for (const int bins : given ? out.settings.bins : std::vector<int>{5, 10, 20, 40, 80}) {
      if (!given && series().values.size() < 2 * (most + 10 * bins)) continue;
      out.information.push_back(mutual_information(
          series(), {.max_lag = most, .estimator = InformationEstimator::kEqualWidth, .bins = bins, .run = run_}));
    }
    if (out.settings.delay > 0) return;
    if (out.sampled_map) {
      out.delay.origin = "a map: 1";
      return;
    }
    const Eigen::Index minimum = out.information.front().first_minimum;
    const Eigen::Index samples = minimum > 0 ? minimum : loop_part(4.0);
    out.delay = {samples, samples, samples,
                 minimum > 0 ? "first minimum of mutual information, equal numbers in 16 bins"
                             : "no minimum of mutual information: a quarter of a mean period"};
    for (const MutualInformation& information : out.information) take_minima(information);
  }

  /// Up to the dimension asked for, or as far as the record reaches.
  FalseNeighbourOptions neighbour_options() const {
    constexpr Eigen::Index kBeyond = 100;
    const Eigen::Index reach = (series().values.size() - kBeyond - 2 * out.window) / out.delay.samples - 1;
    return {.lag = out.delay.samples,
            .max_dimension = static_cast<int>(
                std::clamp<Eigen::Index>(reach, 1, static_cast<Eigen::Index>(out.settings.max_dimension))),
            .window = out.window,
            .ratio = out.settings.ratio,
            .size = out.settings.size,
            .accepted = out.settings.accepted,
            .references = out.settings.references,
            .run = run_};
  }

  void find_dimension() {
    out.false_neighbours = diagnostics::false_neighbours(series(), neighbour_options());
    const FalseNeighbours& found = *out.false_neighbours;
    const int most = found.settings.max_dimension;
    out.cao = cao_averages(series(), neighbour_options());
    if (out.settings.dimension > 0) return;
    const auto first_within = [&](double errors) {
      for (int d = 1; d <= most; ++d) {
        if (found.share(d - 1) + errors * found.error(d - 1) <= out.settings.accepted) return d;
      }
      return most;
    };
    const double percent = 100.0 * out.settings.accepted;
    out.dimension = {found.dimension > 0 ? found.dimension : most, first_within(-1.0), first_within(1.0),
                     found.dimension > 0 ? fmt::format("false neighbours at most {:g} %", percent)
                                         : fmt::format("false neighbours above {:g} % up to there", percent)};
  }

  /// A delay and a dimension that were given must fit the record, whichever tools run.
  void check_embedding() {
    if (out.delay.origin.empty()) out.delay.origin = "not looked for";
    if (out.dimension.origin.empty()) out.dimension.origin = "not looked for";
    if (out.settings.delay == 0 && out.settings.dimension == 0) return;
    constexpr Eigen::Index kBeyond = 100;
    check_series(series(), out.embedding().span() + 2 * out.window + kBeyond,
                 fmt::format("diagnosis in dimension {} at delay {} with window {}", out.dimension.value,
                             out.delay.samples, out.window));
  }

  Eigen::Index forecasts() const {
    constexpr Eigen::Index kMost = 2000;
    return std::min(out.settings.references, kMost);
  }

  void follow_one_pair() {
    // wolf_exponent wants a hundred evolutions.
    const Eigen::Index most =
        std::max<Eigen::Index>(1, (series().values.size() - out.embedding().span() - 2 * out.window - 100) / 100);
    const Eigen::Index loop = out.sampled_map ? 1 : std::min(loop_part(1.0), 4 * out.delay.samples);
    const Eigen::Index evolution = out.settings.evolution > 0 ? out.settings.evolution : std::min(loop, most);
    const auto at = [&](Eigen::Index samples) {
      return wolf_exponent(
          series(),
          {.embedding = out.embedding(), .evolution = samples, .window = out.window, .angle = out.settings.angle});
    };
    WolfStudy study{.chosen = at(evolution), .others = {}};
    double low = study.chosen.nats, high = low;
    for (const Eigen::Index other : {evolution / 2, 2 * evolution}) {
      if (other < 1 || other > most) continue;
      study.others.push_back(at(other));
      low = std::min(low, study.others.back().nats);
      high = std::max(high, study.others.back().nats);
    }
    study.error = std::hypot(study.chosen.error, 0.5 * (high - low));
    out.wolf = std::move(study);
  }

  /// Followed until a rise of six at the exponent already found, at least three loops; ten loops without one.
  Divergence diverge(DivergenceMethod method) const {
    const double largest = out.verdict && out.verdict->spectrum.exponents.size() > 0
                               ? out.verdict->spectrum.exponents(0) * series().interval
                               : 0.0;
    const double samples = largest > 0.0 ? std::max(6.0 / largest, 3.0 * out.loop) : 10.0 * out.loop;
    const double longest = static_cast<double>(series().values.size()) / 8.0;
    const bool kantz = method == DivergenceMethod::kKantz;
    const Eigen::Index stride = kantz ? fine_stride() : loop_part(8.0);
    const int steps = std::max(10, static_cast<int>(std::min(samples, longest) / static_cast<double>(stride)));
    // Kantz starts at a radius, from which saturation may be nearer than a loop by crossings of the mean.
    const auto loop = kantz ? static_cast<double>(std::min(loop_part(1.0), 4 * out.delay.samples)) : out.loop;
    const double width = out.sampled_map ? 0.0 : loop * series().interval;
    Divergence found = divergence(series(), {.embedding = out.embedding(),
                                             .method = method,
                                             .steps = steps,
                                             .stride = stride,
                                             .window = out.window,
                                             .references = out.settings.references,
                                             .region = {.least_rise = 0.3, .least_width = width},
                                             .run = run_});
    if (found.exponent < -3.0 * found.error) {
      throw NumericalFailure(
          fmt::format(
              "divergence of {}: expected neighbours that part at a steady rate somewhere, found the straightest "
              "part of the curve to fall at {:.3g}; too few samples for so many dimensions",
              series().name, found.exponent),
          kNone, {}, kNone);
    }
    return found;
  }

  void fit_jacobians() {
    if (out.verdict && out.verdict->spectrum.exponents.size() > 0) {
      out.jacobians = out.verdict->spectrum;
      return;
    }
    out.jacobians = exponent_spectrum(series(), {.embedding = out.embedding(),
                                                 .neighbours = std::max(20, 3 * out.dimension.value),
                                                 .window = out.window,
                                                 .run = run_});
  }

  void find_peak() {
    AmplitudeSpectrum spectrum = amplitude_spectrum(series().values, series().interval);
    Eigen::Index place = 0;
    spectrum.amplitude.tail(spectrum.amplitude.size() - 1).maxCoeff(&place);
    out.peak = spectrum.frequency_hz(place + 1);
    out.peak_error = 0.5 * spectrum.frequency_hz(1);
    out.spectrum = std::move(spectrum);
  }

  void cut() {
    const double period = out.settings.strobe.value_or(0.0);
    const bool strobe = period > 0.0;
    if (out.sampled_map && !strobe) {
      throw InvalidInput(
          fmt::format("section of {}: expected at least 6 samples per loop, found {:.3g}; a map needs no section",
                      series().name, out.loop));
    }
    out.section = diagnostics::section(series(), {.embedding = {.dimension = 3, .lag = out.delay.samples},
                                                  .cut = strobe ? Cut::kStrobe : Cut::kUpward,
                                                  .period = period});
  }

  void test_surrogates() {
    const bool have = out.verdict && out.verdict->surrogates.of_surrogates.size() == out.settings.surrogates;
    if (have && out.settings.seed == out.verdict->surrogates.settings.seed) {
      out.surrogates = out.verdict->surrogates;
      return;
    }
    const Series start = part(series(), 0, std::min(series().values.size(), kTestedSamples));
    out.surrogates = surrogate_test(start, {.surrogates = out.settings.surrogates,
                                            .embedding = out.embedding(),
                                            .ahead = out.delay.samples,
                                            .references = forecasts(),
                                            .seed = out.settings.seed,
                                            .run = run_});
  }

  SeriesStudy out;
  ParallelOptions run_;  // with the progress of the tool under way
};

}  // namespace

const char* to_string(SeriesTool tool) {
  constexpr std::array kNames = {"autocorrelation", "information", "false-neighbours", "verdict",   "wolf",
                                 "divergence",      "kantz",       "jacobians",        "dimension", "spectrum",
                                 "section",         "recurrence",  "surrogates"};
  static_assert(kNames.size() == kSeriesTools.size());
  return kNames[static_cast<std::size_t>(tool)];
}

std::vector<SeriesTool> series_tools(const std::vector<std::string>& words) {
  std::vector<SeriesTool> tools;
  for (const std::string& word : words) {
    const auto found =
        std::ranges::find(kSeriesTools, word, [](SeriesTool tool) { return std::string(to_string(tool)); });
    if (found == kSeriesTools.end()) {
      std::vector<std::string> names;
      for (const SeriesTool tool : kSeriesTools) names.emplace_back(to_string(tool));
      throw InvalidInput(fmt::format("tools: {}: no such tool; valid: {}", word, fmt::join(names, ", ")));
    }
    tools.push_back(*found);
  }
  return tools;
}

SeriesStudy study_series(const Series& series, const StudyOptions& options) {
  return SeriesExamination(series, options).run();
}

}  // namespace slipmode::diagnostics
