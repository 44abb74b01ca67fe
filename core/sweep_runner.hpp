#pragma once

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include <slipmode/core/sharing.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// Everything that is found value by value of a parameter: sweeps, stroboscopic maps, rows of maps, exponents.

namespace slipmode {

enum class SweepMode {
  kIndependent,  ///< every value starts from the same state
  /// Every value starts from the end state of the one before it. A chain is sequential: `segments` chains run side by
  /// side, each from the common start, so one segment is the sequential sweep of the literature.
  kFollow,
};

/// One value of a sweep, finished. Result: what is kept of the motion there (Settled, DrivenMotion, Strobe, …).
template <class Result>
struct SweptValue {
  std::size_t index = 0;  ///< into the values
  int model = 0;          ///< 0: the only or the full model, 1: the reduced model of a paired sweep
  double parameter = 0.0;
  Result settled = {};       ///< empty where it failed; settled.end is in the model's own coordinates
  std::string failure = {};  ///< empty, or why the value failed; the sweep went on

  [[nodiscard]] bool ok() const { return failure.empty(); }
};
/// Where finished values go at once and where earlier ones come from, so that a sweep can be resumed.
/// Calls come one at a time (never two at once), from any thread, in the order in which values finish.
template <class Result>
struct SinkOf {
  /// The point finished in an earlier run, if there is one. Must give back settled.end to the last bit: following
  /// values start there. Asked once per (index, model) before anything runs. Empty function: nothing to resume.
  std::function<std::optional<SweptValue<Result>>(std::size_t index, int model)> recall = {};
  /// Keeps a point just finished. An exception thrown here ends the sweep. Empty function: nothing kept.
  std::function<void(const SweptValue<Result>&)> store = {};
  /// True for a value that is left to another process. `piece` numbers what can be computed alone: a value, or a chain
  /// of those that follow each other. Asked once per value not recalled, before anything runs. Empty: none is left.
  std::function<bool(std::size_t piece, std::size_t index, int model, double parameter)> leave = {};
  std::size_t first_piece = 0;  ///< of this sweep, among the pieces of the study that it is part of
  /// Of pieces that are not left, with processes that run beside this one. Afterwards recall gives what the others
  /// found: to the one that leads, and to all where `for_all` says that all go on from it.
  Sharing sharing = {};
  bool for_all = false;
};
/// A sweep, finished or not.
template <class Result>
struct SweepOf {
  /// In the order of the values; those finished, when interrupted or when some were left to others.
  std::vector<SweptValue<Result>> points;
  bool interrupted = false;
};

/// How many pieces of a sweep can be computed alone, see SinkOf::leave.
[[nodiscard]] inline std::size_t sweep_pieces(std::size_t values, SweepMode mode, std::size_t segments) {
  return mode == SweepMode::kIndependent ? values : segments;
}

namespace detail {

/// @throws InvalidInput  for no values, or segments that are none or more than the values
void check_sweep(std::size_t values, std::size_t segments);
[[noreturn]] void refuse_recalled(std::size_t index, int model, double expected, double found);

}  // namespace detail

/// What is done at each value of a sweep of one model or of two with shared starts. Called from several threads.
template <class Result, class Start>
struct SweepWork {
  /// What is found with a model (SweptValue::model) at value i. NumericalFailure is recorded.
  std::function<Result(std::size_t i, int model, const Start& start)> settle;
  /// Where the next value starts when this one ended with this result.
  std::function<Start(const Result&)> carry;
  int leader = 0;  ///< the model whose end states are carried on
  /// The follower's start from the leader's; empty: there is no follower (which would be model 1 − leader).
  std::function<Start(const Start&)> follow = {};
};

/// A sweep as tasks. Task i < m runs the leading model at value i; task m + i runs the follower at value i, once its
/// start is known.
template <class Result, class Start>
class SweepRunner {
 public:
  using Point = SweptValue<Result>;

  SweepRunner(SweepWork<Result, Start> work, const std::vector<double>& values, const Start& start, SweepMode mode,
              std::size_t segments, ParallelOptions parallel, SinkOf<Result> sink)
      : work_(std::move(work)),
        values_(values),
        mode_(mode),
        segments_(segments),
        parallel_(std::move(parallel)),
        sink_(std::move(sink)) {
    detail::check_sweep(values.size(), segments);
    starts_.assign(values.size(), start);
    points_.resize(work_.follow ? 2 * values.size() : values.size());
    left_.assign(points_.size(), 0);
    recall();
    leave();
  }

  /// False when interrupted.
  bool run() {
    if (sink_.sharing.begin) return run_shared();
    const auto mine = static_cast<std::size_t>(std::ranges::count(left_, 0));
    return run_tasks_of(first_tasks(), mine, parallel_);
  }

  SweepOf<Result> run_alone() {
    const bool finished = run();
    return {.points = take_leader(), .interrupted = !finished};
  }

  std::vector<Point> take_leader() { return take(0); }
  std::vector<Point> take_follower() { return take(values_.size()); }

 private:
  bool run_tasks_of(std::vector<std::size_t> ready, std::size_t total, const ParallelOptions& parallel,
                    const std::function<std::vector<std::size_t>()>& more = {}) {
    try {
      return run_tasks(
          std::move(ready), total, parallel, [this](std::size_t id) { return task(id); }, more);
    } catch (const Interrupted&) {
      return false;
    }
  }

  bool run_shared() {
    const auto open = static_cast<std::size_t>(
        std::ranges::count_if(points_, [](const std::optional<Point>& point) { return !point; }));
    sink_.sharing.begin(open_pieces(), points_.size() - open, points_.size(), parallel_);
    ParallelOptions own = parallel_;
    own.progress = {};  // of all processes, which the sharing tells
    const bool finished = sink_.sharing.end(run_tasks_of({}, 0, own, [this] { return tasks_taken(); }), sink_.for_all);
    recall();
    return finished;
  }

  [[nodiscard]] std::size_t piece_of(std::size_t i) const {
    return mode_ == SweepMode::kIndependent ? i : segment_of(i);
  }

  /// Pieces of which a value is neither known nor left.
  [[nodiscard]] std::vector<std::size_t> open_pieces() const {
    std::vector<char> open(sweep_pieces(values_.size(), mode_, segments_), 0);
    for (std::size_t id = 0; id < points_.size(); ++id)
      if (!points_[id] && left_[id] == 0) open[piece_of(id % values_.size())] = 1;
    std::vector<std::size_t> pieces;
    for (std::size_t piece = 0; piece < open.size(); ++piece)
      if (open[piece] != 0) pieces.push_back(piece);
    return pieces;
  }

  std::vector<std::size_t> tasks_taken() const {
    std::vector<std::size_t> ready;
    for (const std::size_t piece : sink_.sharing.take())
      make_ready(mode_ == SweepMode::kIndependent ? piece : piece * values_.size() / segments_, ready);
    return ready;
  }

  [[nodiscard]] bool is_segment_begin(std::size_t i) const {
    return mode_ == SweepMode::kIndependent || segment_of(i) * values_.size() / segments_ == i;
  }

  /// The largest s with s·m/S ≤ i, in whole numbers.
  [[nodiscard]] std::size_t segment_of(std::size_t i) const { return ((i + 1) * segments_ - 1) / values_.size(); }

  [[nodiscard]] std::vector<std::size_t> first_tasks() const {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (is_segment_begin(i)) make_ready(i, ready);
    }
    return ready;
  }

  void make_ready(std::size_t i, std::vector<std::size_t>& ready) const {
    for (std::size_t id = i; id < points_.size(); id += values_.size())
      if (left_[id] == 0) ready.push_back(id);
  }

  void recall() {
    if (!sink_.recall) return;
    for (std::size_t id = 0; id < points_.size(); ++id) {
      if (points_[id]) continue;
      const std::size_t i = id % values_.size();
      std::optional<Point> point = sink_.recall(i, model(id));
      if (!point) continue;
      if (point->parameter != values_[i] || point->index != i || point->model != model(id)) {
        detail::refuse_recalled(i, model(id), values_[i], point->parameter);
      }
      points_[id] = std::move(point);
    }
  }

  void leave() {
    if (!sink_.leave) return;
    for (std::size_t id = 0; id < points_.size(); ++id) {
      const std::size_t i = id % values_.size();
      left_[id] = !points_[id] && sink_.leave(sink_.first_piece + piece_of(i), i, model(id), values_[i]) ? 1 : 0;
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

  [[nodiscard]] Point compute(std::size_t i, int tag, const Start& start) const {
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

  SweepWork<Result, Start> work_;
  const std::vector<double>& values_;
  SweepMode mode_;
  std::size_t segments_;
  ParallelOptions parallel_;
  SinkOf<Result> sink_;
  std::vector<Start> starts_;                 ///< of the leader, by value
  std::vector<std::optional<Point>> points_;  ///< by task
  std::vector<char> left_;                    ///< by task: 1 where another process computes it
  std::mutex sink_mutex_;
};

}  // namespace slipmode
