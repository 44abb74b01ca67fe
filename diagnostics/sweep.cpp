#include "diagnostics/sweep.hpp"

#include "core/errors.hpp"

#include <fmt/format.h>

#include <cmath>
#include <mutex>

namespace slipmode::diagnostics {

namespace {

constexpr double kMaxValues = 1e7;

void check(const std::vector<double>& values, const SweepOptions& options) {
  if (values.empty()) throw InvalidInput("sweep: expected at least one parameter value, found none");
  if (options.segments < 1 || options.segments > values.size()) {
    throw InvalidInput(fmt::format("sweep: expected between 1 and {} segments (the number of values), found {}",
                                   values.size(), options.segments));
  }
}

/// A sweep of one model or of two with shared starts, as tasks. Task i < m runs the leading model (the one whose end
/// states are carried on) at value i; task m + i runs the follower at value i, once its start is known.
class SweepRun {
 public:
  SweepRun(const Model& leader, int leader_tag, const Model* follower, const std::vector<double>& values,
           const dynamics::State& start, const SweepOptions& options)
      : leader_(leader), leader_tag_(leader_tag), follower_(follower), values_(values), options_(options) {
    const std::size_t m = values.size();
    starts_.assign(m, restarted(start));
    points_.resize(follower == nullptr ? m : 2 * m);
    options_.settle.stop = options.parallel.stop;
    recall();
  }

  /// False when interrupted.
  bool run() {
    try {
      return run_tasks(first_tasks(), points_.size(), options_.parallel, [this](std::size_t id) { return work(id); });
    } catch (const Interrupted&) {
      return false;
    }
  }

  std::vector<SweepPoint> take_leader() { return take(0); }
  std::vector<SweepPoint> take_follower() { return take(values_.size()); }

 private:
  [[nodiscard]] bool is_segment_begin(std::size_t i) const {
    if (options_.mode == SweepMode::kIndependent || i == 0) return true;
    const std::size_t m = values_.size();
    const std::size_t segments = options_.segments;
    // Segment of i: the largest s with s·m/S ≤ i, in whole numbers.
    const std::size_t segment = ((i + 1) * segments - 1) / m;
    return segment * m / segments == i;
  }

  [[nodiscard]] std::vector<std::size_t> first_tasks() const {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (is_segment_begin(i)) make_ready(i, ready);
    }
    return ready;
  }

  void make_ready(std::size_t i, std::vector<std::size_t>& ready) const {
    ready.push_back(i);
    if (follower_ != nullptr) ready.push_back(values_.size() + i);
  }

  void recall() {
    if (!options_.sink.recall) return;
    for (std::size_t id = 0; id < points_.size(); ++id) {
      const std::size_t i = id % values_.size();
      std::optional<SweepPoint> point = options_.sink.recall(i, tag(id));
      if (!point) continue;
      if (point->parameter != values_[i] || point->index != i || point->model != tag(id)) {
        throw InvalidInput(
            fmt::format("sweep: expected the recalled point {} of model {} to belong to parameter {}, "
                        "found {}. The journal belongs to another sweep",
                        i, tag(id), values_[i], point->parameter));
      }
      points_[id] = std::move(point);
    }
  }

  [[nodiscard]] int tag(std::size_t id) const { return id < values_.size() ? leader_tag_ : 1 - leader_tag_; }

  std::vector<std::size_t> work(std::size_t id) {
    const std::size_t i = id % values_.size();
    if (!points_[id]) {
      points_[id] = id < values_.size() ? compute(leader_, i, id, starts_[i])
                                        : compute(*follower_, i, id, lifted(leader_, starts_[i]));
      store(*points_[id]);
    }
    std::vector<std::size_t> ready;
    if (id >= values_.size() || i + 1 == values_.size() || is_segment_begin(i + 1)) return ready;
    starts_[i + 1] = points_[id]->ok() ? restarted(points_[id]->settled.end) : starts_[i];
    make_ready(i + 1, ready);
    return ready;
  }

  [[nodiscard]] SweepPoint compute(const Model& model, std::size_t i, std::size_t id,
                                   const dynamics::State& start) const {
    SweepPoint point{.index = i, .model = tag(id), .parameter = values_[i]};
    try {
      point.settled = settle(model.system(values_[i]), start, options_.settle);
      point.settled.mean_energy += model.energy_offset;
    } catch (const NumericalFailure& failure) {
      point.failure = failure.what();
    }
    return point;
  }

  void store(const SweepPoint& point) {
    if (!options_.sink.store) return;
    const std::lock_guard lock(sink_mutex_);
    options_.sink.store(point);
  }

  std::vector<SweepPoint> take(std::size_t first) {
    std::vector<SweepPoint> finished;
    for (std::size_t id = first; id < first + values_.size(); ++id) {
      if (points_[id]) finished.push_back(std::move(*points_[id]));
    }
    return finished;
  }

  const Model& leader_;
  int leader_tag_;
  const Model* follower_;
  const std::vector<double>& values_;
  SweepOptions options_;
  std::vector<dynamics::State> starts_;            ///< of the leader, by value
  std::vector<std::optional<SweepPoint>> points_;  ///< by task
  std::mutex sink_mutex_;
};

}  // namespace

std::vector<double> sweep_values(double from, double to, double step) {
  const double range = to - from;
  if (!std::isfinite(range) || !std::isfinite(step) || (step == 0.0 && range != 0.0)) {
    throw InvalidInput(
        fmt::format("sweep range: expected finite numbers and a step other than 0, found {}:{}:{}", from, to, step));
  }
  if (range == 0.0) return {from};
  const double count = std::floor(std::abs(range / step) + 1e-3);
  if (count >= kMaxValues) {
    throw InvalidInput(fmt::format("sweep range: expected at most {} values, found {} in {}:{}:{}", kMaxValues,
                                   count + 1, from, to, step));
  }
  std::vector<double> values;
  const double signed_step = std::copysign(step, range);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
    values.push_back(from + static_cast<double>(i) * signed_step);
  }
  return values;
}

SweepResult sweep(const Model& model, const std::vector<double>& values, const dynamics::State& start,
                  const SweepOptions& options) {
  check(values, options);
  SweepRun run(model, 0, nullptr, values, start, options);
  const bool finished = run.run();
  return {.points = run.take_leader(), .interrupted = !finished};
}

PairedSweep paired_sweep(const Model& full, const Model& reduced, const std::vector<double>& values,
                         const dynamics::State& start, const SweepOptions& options) {
  check(values, options);
  if (!reduced.basis) throw InvalidInput("paired sweep: expected a reduced model with its basis, found none");
  SweepRun run(reduced, 1, &full, values, start, options);
  const bool finished = run.run();
  PairedSweep result;
  result.reduced = run.take_leader();
  result.full = run.take_follower();
  result.interrupted = !finished;
  return result;
}

}  // namespace slipmode::diagnostics
