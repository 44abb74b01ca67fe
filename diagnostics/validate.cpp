#include "diagnostics/validate.hpp"

#include "core/errors.hpp"
#include "diagnostics/ensemble_run.hpp"
#include "diagnostics/validation_checks.hpp"
#include "rom/reduce.hpp"

#include <fmt/format.h>

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

Record appended(Record record, const Record& next) {
  if (record.q.cols() == 0) return next;
  const Eigen::Index columns = record.q.cols();
  record.q.conservativeResize(Eigen::NoChange, columns + next.q.cols());
  record.v.conservativeResize(Eigen::NoChange, columns + next.v.cols());
  record.q.rightCols(next.q.cols()) = next.q;
  record.v.rightCols(next.v.cols()) = next.v;
  return record;
}

/// The work of one validation, part after part; each part runs its items in parallel.
class Validation {
 public:
  Validation(const dynamics::HybridSystem& full, const std::vector<Candidate>& candidates, const dynamics::State& start,
             const ValidationOptions& options)
      : full_(full),
        candidates_(candidates),
        start_(restarted(start)),
        options_(options),
        full_model_(belt_model(full)),
        full_orbits_(options.orbit_speeds.size()) {
    options_.settle.stop = options.parallel.stop;
    options_.lyapunov.stop = options.parallel.stop;
    report_.speed = options.speed;
    report_.chosen = options.chosen > 0 ? options.chosen : modes_for_share(candidates.front().captured, 0.99);
    prepare_reductions();
    total_ = 3 + full_orbits_.size() + reductions_.size() * (1 + full_orbits_.size()) +
             2 * options.sweep_values.size() + (options.cost_duration > 0.0 ? 1 : 0);
  }

  ValidationReport run() {
    try {
      run_full();
      run_reduced();
      run_sweep();
      run_cost();
    } catch (const Interrupted&) {
      report_.interrupted = true;
    }
    return std::move(report_);
  }

 private:
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

  [[nodiscard]] dynamics::State on_subspace(const pod::Basis& basis, const dynamics::State& state) const {
    return restarted(rom::restrict_state(full_.structure(), basis, state));
  }

  // The full model alone: its attractor, itself again from elsewhere, its exponent, its orbits.

  void run_full() {
    Settled again;
    LyapunovExponent exponent;
    run_items(3 + full_orbits_.size(), [&](std::size_t i) {
      const dynamics::HybridSystem system = full_model_.system(options_.speed);
      if (i == 0) settle_full(system);
      if (i == 1) again = settle(system, starts_about(1).back(), attractor_settling());
      if (i == 2) exponent = largest_exponent(system, start_, options_.lyapunov);
      if (i > 2) full_orbits_[i - 3] = find_orbit(options_.orbit_speeds[i - 3]);
    });
    report_.noise = attractor_distance(report_.full, again);
    if (report_.full.period.motion == Motion::kAperiodic) report_.lyapunov = exponent;
  }

  void settle_full(const dynamics::HybridSystem& system) {
    report_.full = settle(system, start_, attractor_settling());
    dynamics::State state = report_.full.end;
    for (int k = 0; k < options_.horizon_starts; ++k) {
      attractor_starts_.push_back(state);
      const dynamics::SimulateOptions gap{
          .duration = options_.horizon_gap, .keep_events = false, .flow = options_.settle.flow};
      state = continued(system, dynamics::simulate(system, state, gap).final_state);
    }
  }

  /// The given start and `count` random ones about it, so that runs from two of them share nothing but the attractor.
  [[nodiscard]] std::vector<dynamics::State> starts_about(Eigen::Index count) const {
    std::vector<dynamics::State> starts = {start_};
    if (count == 0) return starts;
    const auto centre = RandomStateOptions::Centre::kRest;
    for (const dynamics::State& shift : random_states(full_, {.count = count, .spread = 0.1, .centre = centre})) {
      starts.push_back({.time = 0.0, .q = start_.q + shift.q, .v = start_.v + shift.v});
    }
    return starts;
  }

  /// Long blocks: of a chaotic motion, means over a short record are mostly scatter.
  [[nodiscard]] SettleOptions attractor_settling() const {
    SettleOptions settling = options_.settle;
    settling.block = std::max(settling.block, 0.2 * settling.limit);
    settling.energy_time = std::max(settling.energy_time, settling.block);
    settling.energy_samples = std::max(settling.energy_samples, 16384);
    settling.max_slips = std::max(settling.max_slips, 4000);
    return settling;
  }

  [[nodiscard]] SettleOptions orbit_settling() const {
    SettleOptions settling = options_.settle;
    settling.period.tolerance = options_.orbit_tolerance;
    settling.energy_samples = 0;
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

  // Every reduced model: its row of the energy-share table, its cells of the orbit table.

  void run_reduced() {
    const std::size_t per_reduction = 1 + full_orbits_.size();
    std::vector<ShareRow> shares(reductions_.size());
    std::vector<OrbitRow> orbits(reductions_.size() * full_orbits_.size());
    run_items(reductions_.size() * per_reduction, [&](std::size_t i) {
      const std::size_t r = i / per_reduction;
      const std::size_t part = i % per_reduction;
      if (part == 0) {
        shares[r] = share_row(reductions_[r]);
      } else {
        orbits[r * full_orbits_.size() + part - 1] = orbit_row(reductions_[r], part - 1);
      }
    });
    for (std::size_t r = 0; r < reductions_.size(); ++r) {
      report_.candidates[reductions_[r].candidate].shares.push_back(std::move(shares[r]));
    }
    for (std::size_t o = 0; o < full_orbits_.size(); ++o) {
      for (std::size_t r = 0; r < reductions_.size(); ++r) {
        OrbitRow& row = orbits[r * full_orbits_.size() + o];
        report_.candidates[reductions_[r].candidate].orbits.push_back(std::move(row));
      }
    }
  }

  [[nodiscard]] ShareRow share_row(const Reduction& reduction) const {
    ShareRow row{.modes = reduction.modes, .failure = reduction.failure};
    row.energy = 100.0 * candidates_[reduction.candidate].captured(reduction.modes - 1);
    row.start_error = distance_to(reduction.basis);
    if (!reduction.model) return row;
    try {
      const dynamics::HybridSystem system = reduction.model->system(options_.speed);
      const dynamics::State start = on_subspace(reduction.basis, report_.full.end);
      row.attractor = settle(system, start, attractor_settling());
      row.attractor->mean_energy += reduction.model->energy_offset;
      row.distance = attractor_distance(report_.full, *row.attractor);
      if (row.attractor->period.motion == Motion::kAperiodic) {
        row.lyapunov = largest_exponent(system, row.attractor->end, options_.lyapunov);
      }
      row.horizon = up_to_horizon(reduction);
    } catch (const InvalidInput& no_motion) {
      row.failure = no_motion.what();
    } catch (const NumericalFailure& failure) {
      row.failure = failure.what();
    }
    return row;
  }

  /// Over the records of all shared starts. @throws InvalidInput  if the full model does not move
  [[nodiscard]] Deviation up_to_horizon(const Reduction& reduction) const {
    Record full;
    Record reduced;
    for (const dynamics::State& state : attractor_starts_) {
      const SharedRun run =
          run_shared(full_model_, *reduction.model, options_.speed, on_subspace(reduction.basis, state),
                     options_.horizon, options_.sample, options_.settle.flow);
      full = appended(std::move(full), run.full);
      reduced = appended(std::move(reduced), run.reduced);
    }
    return deviation(full_.structure(), full, reduced);
  }

  /// Root mean square distance of the attractor's states to the basis, of their size about their mean [%].
  [[nodiscard]] double distance_to(const pod::Basis& basis) const {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(full_.size());
    for (const dynamics::State& state : attractor_starts_) mean += state.q / double(attractor_starts_.size());
    double lost = 0.0;
    double size = 0.0;
    for (const dynamics::State& state : attractor_starts_) {
      const dynamics::State back = rom::lift(basis, on_subspace(basis, state));
      lost += (state.q - back.q).squaredNorm() + (state.v - back.v).squaredNorm();
      size += (state.q - mean).squaredNorm() + state.v.squaredNorm();
    }
    return size > 0.0 ? 100.0 * std::sqrt(lost / size) : 0.0;
  }

  [[nodiscard]] OrbitRow orbit_row(const Reduction& reduction, std::size_t index) const {
    OrbitRow row{.speed = options_.orbit_speeds[index], .modes = reduction.modes, .failure = reduction.failure};
    const FullOrbit& full = full_orbits_[index];
    if (!full.orbit) row.failure = "full model: " + full.failure;
    if (!full.orbit || !reduction.model) return row;
    try {
      const Orbit orbit = settle_to_orbit(reduction.model->system(row.speed),
                                          on_subspace(reduction.basis, full.orbit->states.front()), orbit_settling());
      row.comparison = compare_orbits(full_.structure(), full_model_, *reduction.model, row.speed, *full.orbit, orbit,
                                      options_.orbit_samples, options_.settle.flow);
    } catch (const NumericalFailure& failure) {
      row.failure = failure.what();
    }
    return row;
  }

  // The chosen model along the belt speeds, and its cost.

  [[nodiscard]] pod::Basis chosen_basis() const { return candidates_.front().basis.truncated(report_.chosen); }

  void run_sweep() {
    if (options_.sweep_values.empty()) return;
    const pod::Basis basis = chosen_basis();
    report_.sweep =
        paired_sweep(full_model_, reduced_belt_model(full_, basis), options_.sweep_values, on_subspace(basis, start_),
                     {.mode = options_.sweep_mode,
                      .segments = options_.sweep_segments,
                      .settle = options_.settle,
                      .parallel = batch(),
                      .sink = options_.sink});
    done_ += 2 * options_.sweep_values.size();
    if (report_.sweep->interrupted) throw Interrupted();
    report_.bifurcation = compare_sweeps(report_.sweep->full, report_.sweep->reduced);
  }

  void run_cost() {
    if (!(options_.cost_duration > 0.0)) return;
    ParallelOptions alone = batch();
    alone.threads = 1;
    rethrow_first(parallel_for(1, alone, [this](std::size_t) {
      report_.cost = measure_cost(full_model_.system(options_.speed), chosen_basis(), start_, options_.cost_duration,
                                  options_.cost_repeats, options_.settle.flow);
    }));
  }

  const dynamics::HybridSystem& full_;
  const std::vector<Candidate>& candidates_;
  dynamics::State start_;
  ValidationOptions options_;
  Model full_model_;
  std::vector<FullOrbit> full_orbits_;
  std::vector<Reduction> reductions_;
  std::vector<dynamics::State> attractor_starts_;
  ValidationReport report_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace

ValidationReport validate(const dynamics::HybridSystem& full, const std::vector<Candidate>& candidates,
                          const dynamics::State& start, const ValidationOptions& options) {
  check_validation(full, candidates, options);
  return Validation(full, candidates, start, options).run();
}

}  // namespace slipmode::diagnostics
