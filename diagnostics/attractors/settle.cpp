#include <slipmode/diagnostics/attractors/settle.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::diagnostics {

namespace {

void check(const SettleOptions& options) {
  if (!(options.block > 0.0) || !(options.transient >= 0.0) || !(options.limit >= options.block)) {
    throw InvalidInput(fmt::format("settle: expected block > 0, transient >= 0, limit >= block, found {}, {}, {}",
                                   options.block, options.transient, options.limit));
  }
  if (!(options.patience >= 0.0)) {
    throw InvalidInput(fmt::format("settle: expected patience >= 0, found {}", options.patience));
  }
  if (options.max_slips < 1 || options.energy_samples < 0) {
    throw InvalidInput(fmt::format("settle: expected max_slips >= 1 and energy_samples >= 0, found {}, {}",
                                   options.max_slips, options.energy_samples));
  }
}

void check_stop(const SettleOptions& options) {
  if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) throw Interrupted();
}

/// Reach of each contact's motion, seen at its events.
class Reach {
 public:
  explicit Reach(std::size_t contacts)
      : low_(contacts, std::numeric_limits<double>::infinity()),
        high_(contacts, -std::numeric_limits<double>::infinity()) {}

  void add(const std::vector<dynamics::Event>& events) {
    for (const dynamics::Event& event : events) {
      if (event.contact < 0) continue;
      const auto c = static_cast<std::size_t>(event.contact);
      low_[c] = std::min(low_[c], event.displacement);
      high_[c] = std::max(high_[c], event.displacement);
    }
  }

  /// One per contact; 0 where nothing moved, which lets detect_period choose.
  [[nodiscard]] std::vector<double> scale() const {
    std::vector<double> scale(low_.size());
    for (std::size_t c = 0; c < scale.size(); ++c) scale[c] = std::max(0.0, high_[c] - low_[c]);
    return scale;
  }

 private:
  std::vector<double> low_, high_;
};

/// Over the first `samples` samples of a run, or as many as there are.
double mean_energy(const dynamics::HybridSystem& system, const dynamics::Trajectory& run, Eigen::Index samples) {
  const Eigen::Index columns = std::min(samples, run.q.cols());
  if (columns == 0) return std::numeric_limits<double>::quiet_NaN();
  return diagnostics::mean_energy(system, run.q.leftCols(columns), run.v.leftCols(columns));
}

/// Energy of a state about steady sliding, which falls while a motion without events dies out.
double energy_about_sliding(const dynamics::HybridSystem& system, const dynamics::State& state) {
  const Eigen::VectorXd centre = sliding_equilibrium(system).q;
  return system.structure().energy(state.q - centre, state.v);
}

/// The slips of the last period: those after the section contact's slip before last by one period.
std::vector<SlipState> last_period(const std::vector<SlipState>& slips, const PeriodResult& period) {
  int left = period.period;
  std::size_t end = slips.size();
  while (end > 0 && slips[end - 1].contact != period.contact) --end;
  std::size_t begin = end;
  while (begin > 0) {
    if (slips[begin - 1].contact == period.contact && left-- == 0) break;
    --begin;
  }
  return {slips.begin() + static_cast<std::ptrdiff_t>(begin), slips.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// Advances block by block and keeps what the verdict needs.
class Settling {
 public:
  Settling(const dynamics::HybridSystem& system, const dynamics::State& start, const SettleOptions& options)
      : system_(system), options_(options), reach_(system.contacts().size()) {
    out_.end = start;
    out_.mean_energy = std::numeric_limits<double>::quiet_NaN();
    if (!options_.flow.audit) out_.audit_residual = std::numeric_limits<double>::quiet_NaN();
    if (options_.period.long_stretch == 0.0) {
      options_.period.long_stretch = std::min(options_.block, 0.5 * options_.limit);
    }
    if (options_.transient > 0.0) run({.duration = options_.transient, .keep_events = false});
  }

  Settled run_all() {
    const bool own_scale = options_.period.scale.empty();
    double waited = 0.0, limit = options_.limit;
    while (true) {
      check_stop(options_);
      const double until = std::min(waited + options_.block, limit);
      const dynamics::State begin = out_.end;
      const dynamics::Trajectory block = run_block(until - waited, until >= limit);
      waited = until;
      if (own_scale) options_.period.scale = reach_.scale();
      out_.period = detect_period(slips_, options_.period);
      if (out_.period.motion == Motion::kPeriodic && out_.period.doubt <= kNoDoubt) break;
      const bool quiet = block.events.empty();
      if (quiet && out_.stick_fraction == 0.0 && !is_growing(begin)) {
        out_.period = {.motion = Motion::kSliding};
        break;
      }
      if (quiet && is_at_rest()) {
        out_.period = {.motion = Motion::kSticking};
        break;
      }
      if (waited >= limit) {
        if (limit > options_.limit || !patience_will_tell(waited)) break;
        limit *= 1.0 + options_.patience;
      }
    }
    if (slips_.empty() && out_.period.motion == Motion::kUndecided && out_.stick_fraction >= 1.0) {
      out_.period.motion = Motion::kSticking;
    }
    keep_slips();
    if (out_.period.motion == Motion::kPeriodic) {
      measure_energy(out_.period.T);
    } else if (waited < options_.limit) {
      measure_energy(options_.block);
    }
    return std::move(out_);
  }

 private:
  dynamics::Trajectory run(dynamics::SimulateOptions simulate_options) {
    simulate_options.flow = options_.flow;
    dynamics::Trajectory part = dynamics::simulate(system_, out_.end, simulate_options);
    out_.end = part.final_state;
    out_.time += simulate_options.duration;
    out_.events += part.statistics.events;
    if (options_.flow.audit) {
      out_.audit_residual = std::max(out_.audit_residual, std::abs(part.audit.residual()));
    }
    return part;
  }

  /// Only the block known to be the last is sampled: the other blocks' mean energy nobody needs.
  dynamics::Trajectory run_block(double length, bool last) {
    const double sample = last && options_.energy_samples > 0 ? length / options_.energy_samples : 0.0;
    dynamics::Trajectory block = run({.duration = length, .sample = sample});
    if (last) out_.mean_energy = mean_energy(system_, block, options_.energy_samples);
    reach_.add(block.events);
    const std::vector<SlipState> slips = slip_states(block.events);
    slips_.insert(slips_.end(), slips.begin(), slips.end());
    forget_old_slips();
    out_.stick_fraction = stick_share(system_, block.statistics.stick_time, length);
    out_.slip_rate = static_cast<double>(slips.size()) / length;
    return block;
  }

  /// True when motion without events gains energy over the block, as on its way to a first stick. Structures with a
  /// rigid-body motion have no equilibrium to measure from: they are given the time.
  [[nodiscard]] bool is_growing(const dynamics::State& begin) const {
    try {
      return energy_about_sliding(system_, out_.end) > 1.001 * energy_about_sliding(system_, begin);
    } catch (const InvalidInput&) {
      return true;
    }
  }

  /// In a run of its own, of one period or, where it was not known which block is the last, of another one.
  void measure_energy(double time) {
    if (options_.energy_samples == 0) return;
    const double sample = time / options_.energy_samples;
    dynamics::FlowOptions flow = options_.flow;
    flow.audit = false;
    const dynamics::Trajectory run =
        dynamics::simulate(system_, out_.end, {.duration = time, .sample = sample, .keep_events = false, .flow = flow});
    out_.mean_energy = mean_energy(system_, run, options_.energy_samples);
  }

  /// Stuck to a belt that does not move: nothing will ever happen again.
  [[nodiscard]] bool is_at_rest() const {
    return out_.stick_fraction >= 1.0 && system_.drive().is_constant() &&
           system_.drive().velocity(out_.end.time) == 0.0;
  }

  /// True when there are too few slips for a verdict, and enough by the end of patience if they go on coming like this.
  [[nodiscard]] bool patience_will_tell(double waited) const {
    constexpr double kReserve = 1.05;  // slips come irregularly
    if (options_.patience == 0.0 || out_.period.motion != Motion::kUndecided || slips_.empty()) return false;
    const auto seen = static_cast<double>(std::ranges::count(slips_, out_.period.contact, &SlipState::contact));
    const double needed = kReserve * (options_.period.repeats + 1.0) * options_.period.max_period;
    return needed * waited <= seen * (1.0 + options_.patience) * options_.limit;
  }

  void forget_old_slips() {
    const int seen = (options_.period.repeats + 1) * options_.period.max_period;
    const auto needed = static_cast<std::size_t>(seen + options_.period.min_matches + options_.max_slips);
    const std::size_t keep = needed * std::max<std::size_t>(system_.contacts().size(), 1);
    if (slips_.size() > keep) slips_.erase(slips_.begin(), slips_.end() - static_cast<std::ptrdiff_t>(keep));
  }

  void keep_slips() {
    if (out_.period.motion == Motion::kPeriodic) {
      out_.slips = last_period(slips_, out_.period);
      return;
    }
    const std::size_t count = std::min(slips_.size(), static_cast<std::size_t>(options_.max_slips));
    out_.slips.assign(slips_.end() - static_cast<std::ptrdiff_t>(count), slips_.end());
  }

  static constexpr double kNoDoubt = 0.01;

  const dynamics::HybridSystem& system_;
  SettleOptions options_;
  Reach reach_;
  std::vector<SlipState> slips_;
  Settled out_;
};

}  // namespace

Settled settle(const dynamics::HybridSystem& system, const dynamics::State& start, const SettleOptions& options) {
  check(options);
  check_stop(options);
  return Settling(system, dynamics::handed_on(system, start), options).run_all();
}

Orbit settle_to_orbit(const dynamics::HybridSystem& system, const dynamics::State& start,
                      const SettleOptions& settling) {
  SettleOptions options = settling;
  options.flow.audit = false;
  options.energy_samples = 0;
  const Settled settled = settle(system, start, options);
  if (settled.period.motion != Motion::kPeriodic) {
    throw NumericalFailure(fmt::format("orbit: expected periodic motion within {} time units (tolerance {}), found {} "
                                       "motion. Raise the limit or choose another start",
                                       options.limit, options.period.tolerance, to_string(settled.period.motion)),
                           settled.end.time, settled.end.q, settled.period.mismatch);
  }
  const auto count = static_cast<std::size_t>(settled.period.period);
  std::vector<dynamics::State> states;
  Orbit orbit{.period = settled.period.period, .T = settled.period.T};
  dynamics::SimulateOptions run{.duration = 2.5 * settled.period.T, .flow = options.flow};
  run.on_event = [&](const dynamics::Event& event, const dynamics::State& state) {
    if (event.kind != dynamics::EventKind::kRelease || event.contact != settled.period.contact) return true;
    states.push_back(state);
    if (orbit.displacements.size() < count) orbit.displacements.push_back(event.displacement);
    return states.size() < 2 * count;
  };
  (void)dynamics::simulate(system, settled.end, run);
  if (states.size() < 2 * count) {
    throw NumericalFailure(
        fmt::format("orbit: expected {} slips in two periods of {}, found {}", 2 * count, orbit.T, states.size()),
        settled.end.time, settled.end.q, settled.period.mismatch);
  }
  double size = 0.0;
  double gap = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    size = std::max(size, std::hypot(states[k].q.norm(), states[k].v.norm()));
    gap = std::max(gap,
                   std::hypot((states[k + count].q - states[k].q).norm(), (states[k + count].v - states[k].v).norm()));
  }
  orbit.mismatch = size > 0.0 ? gap / size : gap;
  orbit.T = states[count].time - states[0].time;
  states.resize(count);
  orbit.states = std::move(states);
  return orbit;
}

}  // namespace slipmode::diagnostics
