#include <slipmode/diagnostics/series/findings.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/diagnostics/series/kaplan_yorke.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::diagnostics {
namespace {

constexpr const char* kNotLookedFor = "not looked for";

/// Collects findings of one study in the units asked for.
class FindingList {
 public:
  FindingList(const SeriesStudy& study, bool bits) : study_(study), bits_(bits) {
    const Series& series = study.series;
    time_ = series.time_unit;
    values_ = series.unit;
    embedded_ =
        fmt::format("dimension {}, delay {}, window {}", study.dimension.value, study.delay.samples, study.window);
  }

  std::vector<Finding> all() {
    facts();
    embedding();
    exponents();
    attractor();
    motion();
    return std::move(out_);
  }

 private:
  void add(std::string key, std::string quantity, double value, double error, std::string unit,
           std::string settings = "") {
    out_.push_back({std::move(key), std::move(quantity), value, error, std::move(unit), std::move(settings)});
  }

  double interval() const { return study_.series.interval; }
  std::string per_time() const { return fmt::format("1/{}", time_); }
  double scale() const { return bits_ ? 1.0 / std::numbers::ln2 : 1.0; }

  void facts() {
    const auto samples = static_cast<double>(study_.series.values.size());
    add("samples", "samples", samples, kNone, "", fmt::format("every {:g} {}", interval(), time_));
    add("mean", "mean", study_.mean, study_.deviation / std::sqrt(std::max(1.0, samples / correlated())), values_,
        fmt::format("decorrelated after {} samples", study_.decorrelation));
    add("deviation", "standard deviation", study_.deviation, kNone, values_);
    add("rms", "root mean square", study_.root_mean_square, kNone, values_);
    add("mean_period", "mean period", study_.loop * interval(), kNone, time_,
        study_.sampled_map ? fmt::format("{:.3g} samples: taken as a map", study_.loop)
                           : fmt::format("{:.4g} samples, by upward crossings of the mean", study_.loop));
    add("decorrelation", "autocorrelation time", static_cast<double>(study_.decorrelation) * interval(),
        0.5 * interval(), time_, "first below 1/e");
    if (study_.smoothness) {
      add("flat_share", "flat stretches", 100.0 * study_.smoothness->flat_share, kNone, "%", "of the samples");
      add("kinks", "kinks", study_.smoothness->coarse ? kNone : study_.smoothness->kinks_per_period, kNone, "",
          study_.smoothness->coarse ? "too few samples per period to tell" : "per mean period");
    }
  }

  double correlated() const { return 1.0 + 2.0 * static_cast<double>(study_.decorrelation); }

  void embedding() {
    const Delay& delay = study_.delay;
    if (delay.origin != kNotLookedFor) {
      add("delay", "delay", static_cast<double>(delay.samples), 0.5 * static_cast<double>(delay.highest - delay.lowest),
          "samples",
          delay.lowest < delay.highest
              ? fmt::format("{}; {} to {} over estimators and halves", delay.origin, delay.lowest, delay.highest)
              : delay.origin);
    }
    if (!study_.information.empty()) {
      const MutualInformation& first = study_.information.front();
      const Eigen::Index at = std::min<Eigen::Index>(delay.samples, first.bits.size() - 1);
      add("information", "mutual information there", first.bits(at) * (bits_ ? 1.0 : std::numbers::ln2),
          first.error * (bits_ ? 1.0 : std::numbers::ln2), bits_ ? "bit" : "nat", "equal numbers in 16 bins");
    }
    const EmbeddingDimension& dimension = study_.dimension;
    if (dimension.origin == kNotLookedFor) return;
    std::string settings = dimension.origin;
    if (study_.false_neighbours) {
      const FalseNeighbourOptions& used = study_.false_neighbours->settings;
      settings += fmt::format(", ratio {:.3g}, size {:.3g}, up to {}", used.ratio, used.size, used.max_dimension);
    }
    add("dimension", "embedding dimension", dimension.value, 0.5 * (dimension.highest - dimension.lowest), "",
        settings);
    if (!study_.cao) return;
    constexpr double kLevel = 0.9;
    Eigen::Index level = 0;
    while (level < study_.cao->E1.size() && study_.cao->E1(level) < kLevel) ++level;
    add("cao_level", "Cao's E1 above 0.9 from", level < study_.cao->E1.size() ? static_cast<double>(level + 1) : kNone,
        kNone, "", "dimension");
    Eigen::Index least = 0;
    study_.cao->E2.minCoeff(&least);
    add("cao_least_E2", "Cao's least E2", study_.cao->E2(least), study_.cao->E2_error(least), "",
        "1 at every dimension for independent samples");
  }

  void add_exponent(std::string key, std::string quantity, double nats, double error, std::string settings) {
    add(std::move(key), std::move(quantity), nats * scale(), error * scale(),
        fmt::format("{}/{}", bits_ ? "bit" : "nat", time_), std::move(settings));
  }

  std::string region(const Divergence& divergence) const {
    return fmt::format("fitted from {:.3g} to {:.3g} {}", divergence.time(divergence.region.begin),
                       divergence.time(divergence.region.end - 1), time_);
  }

  void exponents() {
    if (study_.wolf) {
      const WolfOptions& used = study_.wolf->chosen.settings;
      add_exponent("wolf", "exponent, Wolf", study_.wolf->chosen.nats, study_.wolf->error,
                   fmt::format("{}; pairs followed for {} samples (half and twice: in the error), angle {:g}",
                               embedded_, used.evolution, used.angle));
    }
    if (study_.divergence) {
      const bool path = study_.divergence->settings.method == DivergenceMethod::kTransverse;
      add_exponent(path ? "transverse" : "rosenstein", path ? "exponent, across the flow" : "exponent, Rosenstein",
                   study_.divergence->exponent, study_.divergence->error, region(*study_.divergence));
    }
    if (study_.kantz) {
      add_exponent("kantz", "exponent, Kantz", study_.kantz->exponent, study_.kantz->error,
                   fmt::format("{}, radius {:.3g}", region(*study_.kantz), study_.kantz->settings.radius));
    }
    if (!study_.jacobians) return;
    const ExponentSpectrum& spectrum = *study_.jacobians;
    for (Eigen::Index k = 0; k < spectrum.exponents.size(); ++k) {
      add_exponent(fmt::format("jacobians_{}", k + 1), fmt::format("exponent {}, fitted Jacobians", k + 1),
                   spectrum.exponents(k), spectrum.error(k),
                   k == 0 ? fmt::format("{} neighbours, {} steps", spectrum.settings.neighbours, spectrum.steps) : "");
    }
    add("kaplan_yorke", "Kaplan-Yorke dimension", spectrum.dimension, kaplan_yorke_error(spectrum), "",
        "of these exponents");
  }

  /// Root sum of squares of what each exponent's error does to the dimension.
  static double kaplan_yorke_error(const ExponentSpectrum& spectrum) {
    double squares = 0.0;
    for (Eigen::Index k = 0; k < spectrum.exponents.size(); ++k) {
      Eigen::VectorXd more = spectrum.exponents, less = spectrum.exponents;
      more(k) += spectrum.error(k);
      less(k) -= spectrum.error(k);
      const double half = 0.5 * (kaplan_yorke_dimension(more) - kaplan_yorke_dimension(less));
      squares += half * half;
    }
    return std::sqrt(squares);
  }

  void attractor() {
    if (study_.correlation) {
      const CorrelationDimension& found = *study_.correlation;
      add("correlation_dimension", "correlation dimension", found.dimension, found.error, "",
          fmt::format("{}; fitted from {:.3g} to {:.3g}{}{}", embedded_, found.radius(found.plateau.begin),
                      found.radius(found.plateau.end - 1), values_ == "1" ? "" : " ", values_ == "1" ? "" : values_));
    }
    if (study_.spectrum) {
      add("peak", "peak of the spectrum", study_.peak, study_.peak_error, per_time(),
          fmt::format("{} segments of {} samples", study_.spectrum->segments,
                      2 * (study_.spectrum->frequency_hz.size() - 1)));
    }
    if (study_.recurrence) {
      const Recurrence& plot = *study_.recurrence;
      add("determinism", "determinism", plot.determinism, plot.determinism_error, "",
          fmt::format("of recurrences: rate {:.3g}, radius {:.3g}, {} points every {:.3g} {}", plot.rate,
                      plot.settings.radius, plot.points, plot.interval, time_));
      add("longest_line", "longest recurrence", static_cast<double>(plot.longest) * plot.interval, kNone, time_,
          "diagonal line of the recurrence plot");
    }
    if (study_.section && study_.section->time.size() > 1) {
      const bool strobe = study_.section->settings.cut == Cut::kStrobe;
      add("return_time", "time between section points", study_.section->mean_return,
          strobe ? kNone : study_.section->return_error, time_,
          fmt::format("{} points, {}", study_.section->time.size(),
                      strobe ? "once per period of the drive" : "upward through the mean"));
    }
  }

  void motion() {
    if (study_.surrogates) {
      const SurrogateTest& test = *study_.surrogates;
      add("forecast_error", "forecast error", test.error, kNone, "deviations",
          fmt::format("{} samples ahead, mean of five neighbours", test.settings.ahead));
      add("surrogate_p", "chance of linear noise", test.p, kNone, "",
          fmt::format("rank {} of {} surrogates, {:.3g} of their deviations below their mean", test.rank,
                      test.of_surrogates.size(), test.distance));
    }
    if (!study_.verdict) return;
    if (study_.verdict->motion == SeriesMotion::kPeriodic) {
      add("period", "period", study_.verdict->T, kNone, time_,
          fmt::format("{} {}", study_.verdict->period, study_.sampled_map ? "samples" : "loops"));
    }
    add("mismatch", "least mismatch after a shift", study_.verdict->repeat.mismatch, kNone, "",
        "mean squared difference over twice the variance");
  }

  const SeriesStudy& study_;
  bool bits_;
  std::string time_, values_, embedded_;
  std::vector<Finding> out_;
};

}  // namespace

std::vector<Finding> findings_of(const SeriesStudy& study, bool bits) { return FindingList(study, bits).all(); }

std::string with_error(double value, double error) {
  if (!std::isfinite(value)) return "–";
  if (!std::isfinite(error)) return fmt::format("{:.6g}", value);
  if (!(error > 0.0)) return fmt::format("{:.6g} ± 0", value);
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 12);
  const double largest = std::max(std::abs(value), error);
  if (largest >= 1e6 || largest < 1e-4) return fmt::format("{:.4g} ± {:.2g}", value, error);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

}  // namespace slipmode::diagnostics
