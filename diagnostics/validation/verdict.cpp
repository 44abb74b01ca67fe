#include <slipmode/diagnostics/validation/verdict.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/farthest_dof.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/diagnostics/series/correlation_dimension.hpp>
#include <slipmode/diagnostics/series/false_neighbours.hpp>
#include <slipmode/diagnostics/series/kaplan_yorke.hpp>
#include <slipmode/diagnostics/series/mutual_information.hpp>
#include <slipmode/diagnostics/series/spectrum.hpp>
#include <slipmode/rom/reduce.hpp>
#include "diagnostics/validation/internal/shared_starts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

namespace slipmode::diagnostics {
namespace {

constexpr Eigen::Index kLeastSamples = 2000;

/// One model, ready to run: its state, and how the channel's velocity is read from its own.
struct Subject {
  std::string name;
  std::optional<dynamics::HybridSystem> system = {};
  dynamics::State start = {};
  Eigen::RowVectorXd channel = {};
  std::string failure = {};
};

void check(const dynamics::HybridSystem& full, const ModelVerdictOptions& options) {
  const bool numbers = options.sample > 0.0 && std::isfinite(options.sample) && options.samples >= kLeastSamples &&
                       options.max_lag >= 1 && options.max_dimension >= 1 && options.references >= 100;
  if (!numbers) {
    throw InvalidInput(fmt::format(
        "verdict: expected sample > 0, samples >= {}, max_lag >= 1, max_dimension >= 1 and references >= "
        "100, found {}, {}, {}, {}, {}",
        kLeastSamples, options.sample, options.samples, options.max_lag, options.max_dimension, options.references));
  }
  if (options.channel >= full.size())
    throw InvalidInput(
        fmt::format("verdict: expected a channel from 1 to {}, found {}", full.size(), options.channel + 1));
}

Subject reduced_subject(const dynamics::HybridSystem& full, const dynamics::State& start,
                        const pod::NamedBasis& candidate, Eigen::Index channel) {
  Subject subject{.name = candidate.name};
  try {
    subject.system = rom::reduce(full, candidate.basis);
    const dynamics::State nearest = rom::restrict_state(full.structure(), candidate.basis, start);
    subject.start = dynamics::handed_on(*subject.system, nearest, start.time);
    subject.channel = candidate.basis.vectors.row(channel);
  } catch (const InvalidInput& unusable) {
    subject.failure = unusable.what();
  }
  return subject;
}

/// Runs one tool; what it cannot do is noted and leaves NaN.
template <class Tool>
void attempt(ModelFindings& findings, const char* what, const Tool& tool) {
  try {
    tool();
  } catch (const InvalidInput& reason) {
    findings.notes.push_back(fmt::format("{}: {}", what, reason.what()));
  } catch (const NumericalFailure& reason) {
    findings.notes.push_back(fmt::format("{}: {}", what, reason.what()));
  }
}

/// Record and stick, half by half, from one state on.
void take_record(ModelFindings& findings, const Subject& subject, dynamics::State state,
                 const ModelVerdictOptions& options) {
  const Eigen::Index half = options.samples / 2;
  dynamics::FlowOptions flow = options.tangent.flow;
  flow.audit = false;
  findings.record.resize(2 * half);
  for (int h = 0; h < 2; ++h) {
    const double duration = options.sample * static_cast<double>(half);
    const dynamics::SimulateOptions run{
        .duration = duration, .sample = options.sample, .keep_events = false, .flow = flow};
    const dynamics::Trajectory motion = dynamics::simulate(*subject.system, state, run);
    findings.record.segment(h * half, half) = (subject.channel * motion.v.leftCols(half)).transpose();
    findings.stick_fraction.halves[static_cast<std::size_t>(h)] =
        stick_share(*subject.system, motion.statistics.stick_time, duration);
    state = motion.final_state;
  }
  findings.stick_fraction.value = 0.5 * (findings.stick_fraction.halves[0] + findings.stick_fraction.halves[1]);
}

Series series_of(const ModelFindings& findings, double sample) {
  return {.values = findings.record, .interval = sample, .name = findings.name, .unit = "1", .time_unit = "unit"};
}

double found(Eigen::Index value) {
  return value > 0 ? static_cast<double>(value) : std::numeric_limits<double>::quiet_NaN();
}

void read_series(ModelFindings& findings, const ModelVerdictOptions& options) {
  const Series series = series_of(findings, options.sample);
  const ParallelOptions alone{.threads = 1, .stop = options.parallel.stop};
  attempt(findings, "delay", [&] {
    const MutualInformation information = mutual_information(series, {.max_lag = options.max_lag, .run = alone});
    findings.delay = {
        .value = found(information.first_minimum),
        .halves = {found(information.first_minimum_of_halves[0]), found(information.first_minimum_of_halves[1])}};
  });
  const Eigen::Index lag =
      std::isfinite(findings.delay.value) ? static_cast<Eigen::Index>(findings.delay.value) : decorrelation_lag(series);
  const auto neighbours = [&](const Series& part) {
    return false_neighbours(
        part, {.lag = lag, .max_dimension = options.max_dimension, .references = options.references, .run = alone});
  };
  int embedding = options.max_dimension;
  attempt(findings, "embedding", [&] {
    const FalseNeighbours all = neighbours(series);
    Eigen::Index best = 0;
    const double least = all.share.minCoeff(&best);
    embedding = all.dimension > 0 ? all.dimension : static_cast<int>(best) + 1;
    if (all.dimension == 0)
      findings.notes.push_back(fmt::format("no embedding: {:.2g} % of the neighbours are false even in dimension {}",
                                           100.0 * least, embedding));
    findings.embedding = {
        .value = found(all.dimension),
        .halves = {found(neighbours(first_half(series)).dimension), found(neighbours(second_half(series)).dimension)}};
  });
  attempt(findings, "correlation dimension", [&] {
    const CorrelationDimension correlation = correlation_dimension(
        series, {.embedding = {.dimension = embedding, .lag = lag}, .references = options.references, .run = alone});
    findings.correlation = {.value = correlation.dimension,
                            .halves = {correlation.of_halves[0], correlation.of_halves[1]}};
  });
}

void read_exponents(ModelFindings& findings) {
  const LyapunovSpectrum& spectrum = findings.exponents;
  findings.kaplan_yorke.value = spectrum.dimension;
  for (Eigen::Index h = 0; h < 2; ++h) {
    const Eigen::VectorXd half = spectrum.halves.col(h);
    const bool told = half.size() == spectrum.size || half.sum() < 0.0;
    if (told && !half.hasNaN())
      findings.kaplan_yorke.halves[static_cast<std::size_t>(h)] = kaplan_yorke_dimension(half);
  }
  if (!spectrum.failure.empty()) findings.notes.push_back("exponents end early, " + spectrum.failure);
}

ModelFindings findings_of(const Subject& subject, const ModelVerdictOptions& options) {
  ModelFindings findings{.name = subject.name,
                         .exponents = {},
                         .kaplan_yorke = {},
                         .correlation = {},
                         .delay = {},
                         .embedding = {},
                         .spectrum_distance = {},
                         .stick_fraction = {},
                         .failure = subject.failure};
  if (!subject.system) return findings;
  findings.modes = subject.system->size();
  TangentOptions tangent = options.tangent;
  tangent.stop = options.parallel.stop;
  tangent.progress = {};
  const Eigen::Index all = 2 * subject.system->size() + subject.system->internal_size();
  tangent.exponents = std::min(tangent.exponents, all);
  try {
    dynamics::State state = subject.start;
    if (!subject.system->drive().period()) state = dynamics::handed_on(*subject.system, state);
    if (tangent.transient > 0.0) {
      dynamics::FlowOptions flow = tangent.flow;
      flow.audit = false;
      const dynamics::SimulateOptions run{.duration = tangent.transient, .keep_events = false, .flow = flow};
      state = dynamics::simulate(*subject.system, state, run).final_state;
    }
    tangent.transient = 0.0;
    findings.exponents = lyapunov_spectrum(*subject.system, state, tangent);
    read_exponents(findings);
    take_record(findings, subject, state, options);
    read_series(findings, options);
  } catch (const NumericalFailure& failure) {
    findings.failure = fmt::format("at time {:g}: {}", failure.time, failure.what());
  }
  return findings;
}

Eigen::VectorXd amplitudes(const Eigen::VectorXd& record, double sample, Eigen::Index segment) {
  return amplitude_spectrum(record, sample, segment).amplitude;
}

/// Spectra of the record and its halves, on one grid of frequencies.
struct Spectra {
  Eigen::VectorXd whole, first, second;
};

Spectra spectra_of(const Eigen::VectorXd& record, double sample) {
  const Eigen::Index half = record.size() / 2;
  const Eigen::Index segment = 2 * (half / 16);
  return {amplitudes(record, sample, segment), amplitudes(record.head(half), sample, segment),
          amplitudes(record.tail(half), sample, segment)};
}

double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& reference) {
  return (a - reference).norm() / reference.norm();
}

void compare_spectra(std::vector<ModelFindings>& models, double sample) {
  if (models.front().record.size() == 0) return;
  const Spectra full = spectra_of(models.front().record, sample);
  if (full.whole.norm() == 0.0) return;
  models.front().spectrum_distance.value = distance(full.second, full.first);
  for (std::size_t i = 1; i < models.size(); ++i) {
    if (models[i].record.size() == 0) continue;
    const Spectra own = spectra_of(models[i].record, sample);
    models[i].spectrum_distance = {.value = distance(own.whole, full.whole),
                                   .halves = {distance(own.first, full.first), distance(own.second, full.second)}};
  }
}

}  // namespace

VerdictTable model_verdict(const dynamics::HybridSystem& full, const dynamics::State& start,
                           const std::vector<pod::NamedBasis>& candidates, const ModelVerdictOptions& options) {
  check(full, options);
  VerdictTable table{.models = std::vector<ModelFindings>(candidates.size() + 1),
                     .channel = options.channel >= 0 ? options.channel : farthest_dof(full),
                     .sample = options.sample};
  std::vector<Subject> subjects = {{.name = "full",
                                    .system = full,
                                    .start = start,
                                    .channel = Eigen::RowVectorXd::Unit(full.size(), table.channel)}};
  for (const pod::NamedBasis& candidate : candidates)
    subjects.push_back(reduced_subject(full, start, candidate, table.channel));
  rethrow_first(parallel_for(subjects.size(), options.parallel,
                             [&](std::size_t i) { table.models[i] = findings_of(subjects[i], options); }));
  compare_spectra(table.models, options.sample);
  return table;
}

}  // namespace slipmode::diagnostics
