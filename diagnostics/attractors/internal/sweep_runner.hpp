#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/diagnostics/attractors/sweep.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

/// Inside of sweep.hpp and driven_sweep.hpp, not for use elsewhere.
namespace slipmode::diagnostics::detail {

/// What is done at each value of a sweep of one model or of two with shared starts. Called from several threads.
template <class Result>
struct SweepWork {
  /// The motion that a model (SweptValue::model) settles to at value i. NumericalFailure is recorded.
  std::function<Result(std::size_t i, int model, const dynamics::State& start)> settle;
  /// Where the next value starts when this one ended with this result.
  std::function<dynamics::State(const Result&)> carry;
  int leader = 0;  ///< the model whose end states are carried on
  /// The follower's start from the leader's; empty: there is no follower (which would be model 1 − leader).
  std::function<dynamics::State(const dynamics::State&)> follow = {};
};

/// A sweep as tasks. Task i < m runs the leading model at value i; task m + i runs the follower at value i, once its
/// start is known.
template <class Result>
class SweepRunner {
 public:
  using Point = SweptValue<Result>;

  SweepRunner(SweepWork<Result> work, const std::vector<double>& values, const dynamics::State& start, SweepMode mode,
              std::size_t segments, ParallelOptions parallel, SinkOf<Result> sink)
      : work_(std::move(work)),
        values_(values),
        mode_(mode),
        segments_(segments),
        parallel_(std::move(parallel)),
        sink_(std::move(sink)) {
    if (values.empty()) throw InvalidInput("sweep: expected at least one parameter value, found none");
    if (segments < 1 || segments > values.size()) {
      throw InvalidInput(fmt::format("sweep: expected between 1 and {} segments (the number of values), found {}",
                                     values.size(), segments));
    }
    starts_.assign(values.size(), start);
    points_.resize(work_.follow ? 2 * values.size() : values.size());
    recall();
  }

  /// False when interrupted.
  bool run() {
    try {
      return run_tasks(first_tasks(), points_.size(), parallel_, [this](std::size_t id) { return task(id); });
    } catch (const Interrupted&) {
      return false;
    }
  }

  std::vector<Point> take_leader() { return take(0); }
  std::vector<Point> take_follower() { return take(values_.size()); }

 private:
  [[nodiscard]] bool is_segment_begin(std::size_t i) const {
    if (mode_ == SweepMode::kIndependent || i == 0) return true;
    const std::size_t m = values_.size();
    // Segment of i: the largest s with s·m/S ≤ i, in whole numbers.
    const std::size_t segment = ((i + 1) * segments_ - 1) / m;
    return segment * m / segments_ == i;
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
    if (work_.follow) ready.push_back(values_.size() + i);
  }

  void recall() {
    if (!sink_.recall) return;
    for (std::size_t id = 0; id < points_.size(); ++id) {
      const std::size_t i = id % values_.size();
      std::optional<Point> point = sink_.recall(i, model(id));
      if (!point) continue;
      if (point->parameter != values_[i] || point->index != i || point->model != model(id)) {
        throw InvalidInput(
            fmt::format("sweep: expected the recalled point {} of model {} to belong to parameter {}, "
                        "found {}. The journal belongs to another sweep",
                        i, model(id), values_[i], point->parameter));
      }
      points_[id] = std::move(point);
    }
  }

  [[nodiscard]] int model(std::size_t id) const { return id < values_.size() ? work_.leader : 1 - work_.leader; }

  std::vector<std::size_t> task(std::size_t id) {
    const std::size_t i = id % values_.size();
    const bool leads = id < values_.size();
    if (!points_[id]) {
      points_[id] = compute(i, model(id), leads ? starts_[i] : work_.follow(starts_[i]));
      store(*points_[id]);
    }
    std::vector<std::size_t> ready;
    if (!leads || i + 1 == values_.size() || is_segment_begin(i + 1)) return ready;
    starts_[i + 1] = points_[id]->ok() ? work_.carry(points_[id]->settled) : starts_[i];
    make_ready(i + 1, ready);
    return ready;
  }

  [[nodiscard]] Point compute(std::size_t i, int tag, const dynamics::State& start) const {
    Point point{.index = i, .model = tag, .parameter = values_[i]};
    try {
      point.settled = work_.settle(i, tag, start);
    } catch (const NumericalFailure& failure) {
      point.failure = failure.what();
    }
    return point;
  }

  void store(const Point& point) {
    if (!sink_.store) return;
    const std::lock_guard lock(sink_mutex_);
    sink_.store(point);
  }

  std::vector<Point> take(std::size_t first) {
    std::vector<Point> finished;
    for (std::size_t id = first; id < first + values_.size(); ++id) {
      if (points_[id]) finished.push_back(std::move(*points_[id]));
    }
    return finished;
  }

  SweepWork<Result> work_;
  const std::vector<double>& values_;
  SweepMode mode_;
  std::size_t segments_;
  ParallelOptions parallel_;
  SinkOf<Result> sink_;
  std::vector<dynamics::State> starts_;       ///< of the leader, by value
  std::vector<std::optional<Point>> points_;  ///< by task
  std::mutex sink_mutex_;
};

}  // namespace slipmode::diagnostics::detail
