#include <slipmode/diagnostics/validation/validate.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/ensemble_run.hpp>
#include <slipmode/rom/reduce.hpp>
#include "diagnostics/validation/internal/shared_starts.hpp"
#include "diagnostics/validation/internal/validation_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace slipmode::diagnostics {

namespace {

/// One basis cut to L vectors, ready to run.
struct Reduction {
  std::size_t candidate = 0;
  Eigen::Index modes = 0;
  pod::Basis basis = {};
  std::optional<Model> model = {};  ///< empty where the projection failed
  std::string failure = {};
};

/// What the full model did at one speed of the orbit table.
struct FullOrbit {
  std::optional<Orbit> orbit = {};
  std::string failure = {};
};

/// The work of one validation, part after part; each part runs its items in parallel.
class Validation {
 public:
  Validation(const dynamics::HybridSystem& full, const std::vector<pod::NamedBasis>& candidates,
             const dynamics::State& start, const ValidationOptions& options)
      : full_(full),
        candidates_(candidates),
        start_(start),
        options_(options),
        full_model_(belt_model(full)),
        run_flow_(options.settle.flow),
        full_orbits_(options.orbit_speeds.size()) {
    options_.settle.stop = options.parallel.stop;
    run_flow_.audit = false;
    options_.lyapunov.stop = options.parallel.stop;
    report_.speed = options.speed;
    report_.chosen = options.chosen > 0 ? options.chosen
                                        : pod::modes_for_share(candidates.front().captured, pod::ModeChoice{}.energy);
    prepare_reductions();
    total_ = 3 + full_orbits_.size() + reductions_.size() * (1 + full_orbits_.size()) +
             2 * options.sweep_values.size() + (options.verdict ? candidates.size() + 1 : 0) +
             (options.cost_duration > 0.0 ? 1 : 0);
  }

  ValidationReport run() {
    try {
      // First what other processes may share, so that none waits for what one does alone.
      run_sweep();
      if (!report_.whole) return std::move(report_);
      run_full();
      run_reduced();
      run_verdict();
      run_cost();
    } catch (const Interrupted&) {
      report_.interrupted = true;
    }
    return std::move(report_);
  }

 private:
  /// By number of modes where they grow, so that those of all candidates come together; else by candidate.
  void prepare_reductions() {
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      report_.candidates.push_back({.name = candidates_[c].name});
      for (const Eigen::Index L : modes_to_try(candidates_[c], options_)) {
        Reduction reduction{.candidate = c, .modes = L, .basis = candidates_[c].basis.truncated(L)};
        try {
          reduction.model = reduced_belt_model(full_, reduction.basis);
        } catch (const InvalidInput& unusable) {
          reduction.failure = unusable.what();
        }
        reductions_.push_back(std::move(reduction));
      }
    }
    if (options_.grow) std::ranges::stable_sort(reductions_, {}, &Reduction::modes);
  }

  /// The batch's options, with progress counted over the whole validation.
  ParallelOptions batch() {
    ParallelOptions parallel = options_.parallel;
    if (options_.parallel.progress) {
      parallel.progress = [this, before = done_](std::size_t done, std::size_t) {
        options_.parallel.progress(before + done, total_);
      };
    }
    return parallel;
  }

  void run_items(std::size_t count, const std::function<void(std::size_t)>& item) {
    rethrow_first(parallel_for(count, batch(), item));
    done_ += count;
  }

  [[nodiscard]] dynamics::State projected(const pod::Basis& basis, const dynamics::State& state) const {
    return rom::restrict_state(full_.structure(), basis, state);
  }

  // The chosen model along the belt speeds.

  [[nodiscard]] pod::Basis chosen_basis() const { return candidates_.front().basis.truncated(report_.chosen); }

  void run_sweep() {
    report_.whole = options_.sink.sharing.leads;
    if (options_.sweep_values.empty()) return;
    const pod::Basis basis = chosen_basis();
    const auto begin = std::chrono::steady_clock::now();
    report_.sweep =
        paired_sweep(full_model_, reduced_belt_model(full_, basis), options_.sweep_values, projected(basis, start_),
                     {.mode = options_.sweep_mode,
                      .segments = options_.sweep_segments,
                      .settle = options_.sweep_settle,
                      .parallel = batch(),
                      .sink = options_.sink});
    report_.sweep_wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    done_ += 2 * options_.sweep_values.size();
    if (report_.sweep->interrupted) throw Interrupted();
    report_.whole = report_.whole && report_.sweep->full.size() == options_.sweep_values.size() &&
                    report_.sweep->reduced.size() == options_.sweep_values.size();
    if (!report_.whole) return;
    report_.bifurcation = compare_sweeps(report_.sweep->full, report_.sweep->reduced);
  }

  // The full model alone: its attractor, itself again from elsewhere, its orbits.

  void run_full() {
    Settled again;
    run_items(2 + full_orbits_.size(), [&](std::size_t i) {
      const dynamics::HybridSystem system = full_model_.system(options_.speed);
      if (i == 0) settle_full(system);
      if (i == 1) again = settle(system, starts_about(1).back(), attractor_settling());
      if (i > 1) full_orbits_[i - 2] = find_orbit(options_.orbit_speeds[i - 2]);
    });
    report_.noise = attractor_distance(report_.full, again);
  }

  void settle_full(const dynamics::HybridSystem& system) {
    report_.full = settle(system, start_, attractor_settling());
    attractor_starts_ =
        states_along(system, report_.full.end, options_.horizon_starts, options_.horizon_gap, run_flow_);
  }

  /// From the attractor's end: a start elsewhere may take thousands of units to get there, and count as motion on it.
  [[nodiscard]] std::optional<LyapunovExponent> exponent(const dynamics::HybridSystem& system,
                                                         const Settled& attractor) const {
    if (attractor.period.motion != Motion::kAperiodic) return std::nullopt;
    return largest_exponent(system, attractor.end, options_.lyapunov);
  }

  /// The given start and `count` random ones about it, so that runs from two of them share nothing but the attractor.
  [[nodiscard]] std::vector<dynamics::State> starts_about(Eigen::Index count) const {
    std::vector<dynamics::State> starts = {start_};
    if (count == 0) return starts;
    const auto centre = RandomStateOptions::Centre::kRest;
    for (const dynamics::State& shift :
         random_states(full_, {.count = count, .spread = options_.start_spread, .centre = centre})) {
      starts.push_back({.time = 0.0, .q = start_.q + shift.q, .v = start_.v + shift.v});
    }
    return starts;
  }

  /// Long blocks: of a chaotic motion, means over a short record are mostly scatter.
  [[nodiscard]] SettleOptions attractor_settling() const {
    SettleOptions settling = options_.settle;
    settling.block = std::max(settling.block, 0.2 * settling.limit);
    settling.energy_samples = std::max(settling.energy_samples, 16384);
    settling.max_slips = std::max(settling.max_slips, 4000);
    return settling;
  }

  [[nodiscard]] SettleOptions orbit_settling() const {
    SettleOptions settling = options_.settle;
    settling.period.tolerance = options_.orbit_tolerance;
    return settling;
  }

  [[nodiscard]] FullOrbit find_orbit(double speed) const {
    FullOrbit found;
    for (const dynamics::State& start : starts_about(options_.orbit_starts - 1)) {
      try {
        return {.orbit = settle_to_orbit(full_model_.system(speed), start, orbit_settling())};
      } catch (const NumericalFailure& failure) {
        found.failure = fmt::format("{} (the last of {} starts)", failure.what(), options_.orbit_starts);
      }
    }
    return found;
  }

  // Every reduced model: its row of the energy-share table, its cells of the orbit table. Beside them, as it takes one
  // thread about as long as a row, the full model's exponent.

  void run_reduced() {
    std::vector<OrbitRow> orbits;
    const std::size_t count = reductions_.size(), together = options_.grow ? candidates_.size() : count;
    std::size_t sunk = 0, begin = 0;
    for (; begin < count && sunk < kSunkLevels; begin += together) {
      run_reductions(begin, begin + together, orbits);
      const bool enough = reductions_[begin].modes >= report_.chosen;
      sunk = options_.grow && enough && is_within_scatter() ? sunk + 1 : 0;
    }
    if (begin < count) {
      report_.left_out_above = reductions_[begin - 1].modes;
      total_ -= (count - begin) * (1 + full_orbits_.size());
    }
    for (std::size_t o = 0; o < full_orbits_.size(); ++o) {
      for (std::size_t r = 0; r < begin; ++r) {
        report_.candidates[reductions_[r].candidate].orbits.push_back(std::move(orbits[r * full_orbits_.size() + o]));
      }
    }
  }

  /// Rows and cells of the reductions [begin, end); the full model's exponent beside the first ones.
  void run_reductions(std::size_t begin, std::size_t end, std::vector<OrbitRow>& out_orbits) {
    const std::size_t parts = 1 + full_orbits_.size(), first = begin == 0 ? 1 : 0;
    std::vector<ShareRow> shares(end - begin);
    out_orbits.resize(end * full_orbits_.size());
    run_items(first + (end - begin) * parts, [&](std::size_t i) {
      if (i < first) {
        report_.lyapunov = exponent(full_model_.system(options_.speed), report_.full);
        return;
      }
      const std::size_t r = begin + (i - first) / parts, part = (i - first) % parts;
      if (part == 0) {
        shares[r - begin] = share_row(reductions_[r]);
      } else {
        out_orbits[r * full_orbits_.size() + part - 1] = orbit_row(reductions_[r], part - 1);
      }
    });
    for (std::size_t r = begin; r < end; ++r) {
      report_.candidates[reductions_[r].candidate].shares.push_back(std::move(shares[r - begin]));
    }
  }

  /// The last row of every candidate is about as near to the full model as another full run, or, where that is the same
  /// to rounding, to a thousandth of the reach of its slip states. Without slip states states from shared starts
  /// decide.
  [[nodiscard]] bool is_within_scatter() const {
    constexpr double kSameReach = 1e-3, kSamePercent = 1.0;
    constexpr double kScatter = 3.0;  // the distance of one pair of runs scatters by as much as it is
    const auto [low, high] = std::ranges::minmax_element(report_.full.slips, {}, &SlipState::displacement);
    const double reach = report_.full.slips.empty() ? 0.0 : high->displacement - low->displacement;
    return std::ranges::all_of(report_.candidates, [&](const CandidateReport& candidate) {
      const ShareRow& row = candidate.shares.back();
      if (!row.attractor) return false;
      if (report_.full.slips.empty()) return row.attractor->slips.empty() && row.horizon.dX <= kSamePercent;
      return row.distance.wasserstein <= std::max(kScatter * report_.noise.wasserstein, kSameReach * reach);
    });
  }

  [[nodiscard]] ShareRow share_row(const Reduction& reduction) const {
    ShareRow row{.modes = reduction.modes, .failure = reduction.failure};
    row.energy = 100.0 * candidates_[reduction.candidate].captured(reduction.modes - 1);
    row.start_error = distance_to_basis(full_.structure(), reduction.basis, attractor_starts_);
    if (!reduction.model) return row;
    try {
      const dynamics::HybridSystem system = reduction.model->system(options_.speed);
      const dynamics::State start = projected(reduction.basis, report_.full.end);
      row.attractor = settle(system, start, attractor_settling());
      row.attractor->mean_energy += energy_offset_at(*reduction.model, options_.speed);
      row.distance = attractor_distance(report_.full, *row.attractor);
      row.lyapunov = exponent(system, *row.attractor);
      row.horizon = deviation_up_to_horizon(full_.structure(), full_model_, *reduction.model, options_.speed,
                                            attractor_starts_, options_.horizon, options_.sample, run_flow_);
    } catch (const InvalidInput& no_motion) {
      row.failure = no_motion.what();
    } catch (const NumericalFailure& failure) {
      row.failure = failure.what();
    }
    return row;
  }

  [[nodiscard]] OrbitRow orbit_row(const Reduction& reduction, std::size_t index) const {
    OrbitRow row{.speed = options_.orbit_speeds[index], .modes = reduction.modes, .failure = reduction.failure};
    const FullOrbit& full = full_orbits_[index];
    if (!full.orbit) row.failure = "full model: " + full.failure;
    if (!full.orbit || !reduction.model) return row;
    try {
      const Orbit orbit = settle_to_orbit(reduction.model->system(row.speed),
                                          projected(reduction.basis, full.orbit->states.front()), orbit_settling());
      row.comparison = compare_orbits(full_.structure(), full_model_, *reduction.model, row.speed, *full.orbit, orbit,
                                      options_.orbit_samples, run_flow_);
    } catch (const NumericalFailure& failure) {
      row.failure = failure.what();
    }
    return row;
  }

  // The chosen model's dimensions beside the full one's, and its cost.

  void run_verdict() {
    if (!options_.verdict) return;
    ModelVerdictOptions judging = *options_.verdict;
    judging.parallel = batch();
    std::vector<pod::NamedBasis> candidates;
    for (const pod::NamedBasis& candidate : candidates_) {
      const Eigen::Index modes = std::min(report_.chosen, candidate.basis.modes());
      candidates.push_back({fmt::format("{} {}s", modes, candidate.name), candidate.basis.truncated(modes)});
    }
    report_.verdict = model_verdict(full_model_.system(options_.speed), report_.full.end, candidates, judging);
    done_ += candidates.size() + 1;
  }

  void run_cost() {
    if (!(options_.cost_duration > 0.0)) return;
    ParallelOptions alone = batch();
    alone.threads = 1;
    rethrow_first(parallel_for(1, alone, [this](std::size_t) {
      report_.cost = measure_cost(full_model_.system(options_.speed), chosen_basis(), report_.full.end,
                                  options_.cost_duration, options_.cost_repeats, run_flow_);
    }));
  }

  static constexpr std::size_t kSunkLevels = 2;  ///< one alone may be within the scatter by chance

  const dynamics::HybridSystem& full_;
  const std::vector<pod::NamedBasis>& candidates_;
  dynamics::State start_;
  ValidationOptions options_;
  Model full_model_;
  dynamics::FlowOptions run_flow_;  ///< of runs whose energy balance nobody reads
  std::vector<FullOrbit> full_orbits_;
  std::vector<Reduction> reductions_;
  std::vector<dynamics::State> attractor_starts_;
  ValidationReport report_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace

std::vector<Eigen::Index> mode_ladder(Eigen::Index most, Eigen::Index chosen) {
  constexpr Eigen::Index kAllUpTo = 12;
  std::vector<Eigen::Index> ladder;
  for (Eigen::Index L = 1; L <= most; ++L) {
    const bool power = (L & (L - 1)) == 0, between = L % 3 == 0 && ((L / 3) & (L / 3 - 1)) == 0;
    if (most <= kAllUpTo || L == most || L == chosen || power || between) ladder.push_back(L);
  }
  return ladder;
}

bool ShareRow::is_chaotic() const { return lyapunov && lyapunov->is_positive(); }

std::string attractor_word(const Settled& settled, const std::optional<LyapunovExponent>& exponent) {
  constexpr double kMostGrowth = 0.01;  // per slip
  if (settled.period.motion != Motion::kAperiodic) return to_string(settled.period.motion);
  if (!exponent) return to_string(Motion::kUndecided);
  if (exponent->is_positive()) return to_string(Motion::kAperiodic);
  const double bound = kErrorsOfPositive * exponent->error;
  const bool zero = std::abs(exponent->nats) <= bound && exponent->nats + bound < kMostGrowth * settled.slip_rate;
  return zero ? "quasi-periodic" : to_string(Motion::kUndecided);
}

ValidationReport validate(const dynamics::HybridSystem& full, const std::vector<pod::NamedBasis>& candidates,
                          const dynamics::State& start, const ValidationOptions& options) {
  check_validation(full, candidates, options);
  return Validation(full, candidates, start, options).run();
}

}  // namespace slipmode::diagnostics
