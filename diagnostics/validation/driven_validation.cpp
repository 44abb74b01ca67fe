#include <slipmode/diagnostics/validation/driven_validation.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/timing.hpp>
#include <slipmode/diagnostics/validation/validate.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

namespace slipmode::diagnostics {

namespace {

constexpr double kTrustedDistance = 0.1, kTrustedNoise = 2.0, kTrustedShare = 0.9;

void check(const DrivenCase& full, const std::vector<pod::NamedBasis>& candidates,
           const DrivenValidationOptions& options) {
  if (options.values.empty() || candidates.empty()) {
    throw InvalidInput(fmt::format("driven validation: expected values and bases, found {} and {}",
                                   options.values.size(), candidates.size()));
  }
  if (options.reading < 0 || options.reading >= full.readings.rows.rows()) {
    throw InvalidInput(fmt::format("driven validation: expected a reading between 0 and {}, found {}",
                                   full.readings.rows.rows() - 1, options.reading));
  }
  if (!(options.cost_cycles >= 0.0) || options.cost_repeats < 1) {
    throw InvalidInput(fmt::format("driven validation: expected cost_cycles >= 0 and cost_repeats >= 1, found {}, {}",
                                   options.cost_cycles, options.cost_repeats));
  }
  for (const pod::NamedBasis& candidate : candidates) {
    if (candidate.basis.vectors.rows() == full.system.size()) continue;
    throw InvalidInput(fmt::format("driven validation: expected basis {} to have {} rows, found {}", candidate.name,
                                   full.system.size(), candidate.basis.vectors.rows()));
  }
}

std::vector<Eigen::Index> sizes(const pod::NamedBasis& candidate, const std::vector<Eigen::Index>& asked) {
  std::vector<Eigen::Index> out;
  const Eigen::Index available = candidate.basis.modes();
  if (asked.empty()) return mode_ladder(available, available);
  std::copy_if(asked.begin(), asked.end(), std::back_inserter(out),
               [available](Eigen::Index L) { return L >= 1 && L <= available; });
  return out;
}

/// Fills trusted_share and band.
void judge(const std::vector<double>& values, const DrivenAgreement& noise, DrivenRow& row) {
  std::size_t trusted = 0, run = 0, longest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!trusted_at(row.agreement.wasserstein[i], noise.wasserstein[i])) {
      run = 0;
      continue;
    }
    ++trusted;
    if (++run > longest) {
      longest = run;
      row.band = {values[i + 1 - run], values[i]};
    }
  }
  row.trusted_share = static_cast<double>(trusted) / static_cast<double>(values.size());
}

Eigen::Index trusted_from(const std::vector<DrivenRow>& rows) {
  Eigen::Index from = 0;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    if (!row->failure.empty() || row->trusted_share < kTrustedShare) break;
    from = row->modes;
  }
  return from;
}

/// The sweeps one after the other, and then the clocks.
class DrivenValidationRun {
 public:
  DrivenValidationRun(const DrivenCase& full, const DriveAt& drive, const std::vector<pod::NamedBasis>& candidates,
                      const dynamics::State& start, const DrivenValidationOptions& options)
      : full_(full),
        drive_(drive),
        candidates_(candidates),
        start_(start),
        options_(options),
        total_(driven_validation_sweeps(candidates, options)) {}

  DrivenValidationReport run(const dynamics::State& other) {
    const Times times = timed([&] {
      out_.full = sweep(full_, start_);
      out_.again = sweep(full_, other);
      for (const pod::NamedBasis& candidate : candidates_) try_candidate(candidate);
    });
    out_.sweeps_wall = times.wall;
    if (out_.interrupted || !out_.whole) return std::move(out_);
    compare();
    if (options_.cost_cycles > 0.0) measure();
    return std::move(out_);
  }

 private:
  /// Empty once the stop flag was seen.
  std::vector<DrivenPoint> sweep(const DrivenCase& model, const dynamics::State& start) {
    if (out_.interrupted) return {};
    ParallelOptions parallel = options_.parallel;
    if (parallel.progress) {
      parallel.progress = [this](std::size_t done, std::size_t all) {
        options_.parallel.progress(static_cast<std::size_t>(model_) * all + done, total_ * all);
      };
    }
    DrivenSink sink = options_.sink;
    sink.first_piece =
        static_cast<std::size_t>(model_) * sweep_pieces(options_.values.size(), options_.mode, options_.segments);
    DrivenSweep found = driven_sweep(driven_model(model, drive_), options_.values, start,
                                     {.mode = options_.mode,
                                      .segments = options_.segments,
                                      .model = model_,
                                      .driven = options_.driven,
                                      .parallel = std::move(parallel),
                                      .sink = std::move(sink)});
    ++model_;
    out_.interrupted = found.interrupted;
    out_.whole &= options_.sink.sharing.leads && found.points.size() == options_.values.size();
    return std::move(found.points);
  }

  void try_candidate(const pod::NamedBasis& candidate) {
    DrivenCandidateReport report{.name = candidate.name};
    for (const Eigen::Index L : sizes(candidate, options_.modes)) {
      DrivenRow row{.modes = L};
      try {
        const pod::Basis basis = candidate.basis.truncated(L);
        row.points = sweep(reduced_case(full_, basis), rom::restrict_state(full_.system.structure(), basis, start_));
      } catch (const InvalidInput& refusal) {
        row.failure = refusal.what();
        ++model_;
      }
      report.rows.push_back(std::move(row));
    }
    out_.candidates.push_back(std::move(report));
  }

  void compare() {
    const Eigen::Index reading = options_.reading;
    out_.noise = compare_driven(out_.full, out_.again, reading);
    out_.peaks = amplitude_peaks(out_.full, reading);
    for (DrivenCandidateReport& candidate : out_.candidates) {
      for (DrivenRow& row : candidate.rows) {
        if (!row.failure.empty()) continue;
        row.agreement = compare_driven(out_.full, row.points, reading);
        row.peaks = amplitude_peaks(row.points, reading);
        judge(options_.values, out_.noise, row);
      }
      candidate.trusted_from = trusted_from(candidate.rows);
    }
  }

  DrivenCost clock(const dynamics::HybridSystem& system, const dynamics::State& start, double projection) const {
    const dynamics::State begin = at_first_section(system, start);
    const dynamics::SimulateOptions run{.duration = options_.cost_cycles * system.drive().period().value(),
                                        .keep_events = false,
                                        .output = dynamics::SimulateOptions::Output::kContacts,
                                        .flow = options_.driven.flow};
    const auto once = [&] { return timed([&] { (void)dynamics::simulate(system, begin, run); }); };
    const Times first = once();
    std::vector<Times> repeats;
    repeats.reserve(static_cast<std::size_t>(options_.cost_repeats));
    for (int k = 0; k < options_.cost_repeats; ++k) repeats.push_back(once());
    const Times middle = median_times(repeats);
    return {.wall = middle.wall, .cpu = middle.cpu, .setup = projection + std::max(0.0, first.wall - middle.wall)};
  }

  /// Systems of their own, so that set-up is seen.
  void measure() {
    const friction::Drive drive = drive_(options_.cost_parameter);
    const dynamics::HybridSystem full(full_.system.structure(), full_.system.contacts(), drive, full_.system.load(),
                                      full_.system.force_directions());
    out_.cost = clock(full, start_, 0.0);
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      for (DrivenRow& row : out_.candidates[c].rows) {
        if (!row.failure.empty()) continue;
        const pod::Basis basis = candidates_[c].basis.truncated(row.modes);
        std::optional<dynamics::HybridSystem> reduced;
        const Times projection = timed([&] { reduced = rom::reduce(full, basis); });
        row.cost = clock(*reduced, rom::restrict_state(full.structure(), basis, start_), projection.wall);
      }
    }
  }

  const DrivenCase& full_;
  const DriveAt& drive_;
  const std::vector<pod::NamedBasis>& candidates_;
  const dynamics::State& start_;
  const DrivenValidationOptions& options_;
  std::size_t total_;  ///< sweeps in all
  int model_ = 0;
  DrivenValidationReport out_;
};

}  // namespace

std::size_t driven_validation_sweeps(const std::vector<pod::NamedBasis>& candidates,
                                     const DrivenValidationOptions& options) {
  std::size_t count = 2;
  for (const pod::NamedBasis& candidate : candidates) count += sizes(candidate, options.modes).size();
  return count;
}

bool trusted_at(double distance, double noise) {
  const double allowed = std::isfinite(noise) ? std::max(kTrustedDistance, kTrustedNoise * noise) : kTrustedDistance;
  return distance <= allowed;
}

DrivenValidationReport validate_driven(const DrivenCase& full, const DriveAt& drive,
                                       const std::vector<pod::NamedBasis>& candidates, const dynamics::State& start,
                                       const dynamics::State& other, const DrivenValidationOptions& options) {
  check(full, candidates, options);
  return DrivenValidationRun(full, drive, candidates, start, options).run(other);
}

}  // namespace slipmode::diagnostics
