#include <slipmode/orbits/skeleton.hpp>

#include <slipmode/core/errors.hpp>
#include "orbits/internal/skeleton_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace slipmode::orbits {

namespace {

/// What became of one candidate.
struct Refined {
  PeriodicOrbit orbit;
  detail::Passages passages;
  Eigen::MatrixXd scaled;  ///< the passages in the attractor's metric
  std::string refusal;     ///< empty, or why there is no orbit
  bool tried = false;
};

void check(const dynamics::HybridSystem& system, const Attractor& attractor, const SkeletonOptions& options) {
  if (options.passages_per_segment < 1 || !(options.same > 0.0) || !(options.radius > 0.0) || options.samples < 1) {
    throw InvalidInput(fmt::format(
        "skeleton: expected passages_per_segment >= 1, same > 0, radius > 0, samples >= 1, found {}, {}, {}, {}",
        options.passages_per_segment, options.same, options.radius, options.samples));
  }
  if (attractor.passages.empty() || attractor.passages.front().q.size() != system.size()) {
    throw InvalidInput(
        fmt::format("skeleton: expected passages of a model of size {}, found {}", system.size(),
                    attractor.passages.empty() ? "none" : std::to_string(attractor.passages.front().q.size())));
  }
}

class Search {
 public:
  Search(const dynamics::HybridSystem& system, const Attractor& attractor, const SkeletonOptions& options,
         Skeleton known)
      : system_(system), attractor_(attractor), options_(options), skeleton_(std::move(known)) {
    skeleton_.radius = options.radius;
    for (const SkeletonOrbit& member : skeleton_.orbits) {
      listed_.push_back({attractor.metric.scaled(member.points), member.orbit.period});
    }
  }

  Skeleton run(const std::vector<Candidate>& candidates) {
    first_ = skeleton_.candidates.size();
    skeleton_.candidates.insert(skeleton_.candidates.end(), candidates.begin(), candidates.end());
    refine_all();
    gather();
    describe_all();
    std::stable_sort(
        skeleton_.orbits.begin(), skeleton_.orbits.end(), [](const SkeletonOrbit& a, const SkeletonOrbit& b) {
          return std::tie(a.orbit.period, a.orbit.leading_modulus) < std::tie(b.orbit.period, b.orbit.leading_modulus);
        });
    return std::move(skeleton_);
  }

 private:
  /// Side by side; a failure of the flow refuses its candidate, anything else is thrown on.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& item, const ParallelOptions& parallel) {
    const BatchResult batch = parallel_for(count, parallel, item);
    for (const std::exception_ptr& error : batch.errors) {
      if (error) std::rethrow_exception(error);
    }
    skeleton_.interrupted = skeleton_.interrupted || batch.interrupted;
  }

  void refine_all() {
    refined_.resize(skeleton_.candidates.size() - first_);
    for_each(
        refined_.size(), [this](std::size_t k) { refine(k); }, options_.parallel);
  }

  void refine(std::size_t k) {
    Refined& out = refined_[k];
    out.tried = true;
    const Candidate& candidate = skeleton_.candidates[first_ + k];
    try {
      accept(polished(shoot(system_, candidate.state, shooting(candidate, candidate.length)), candidate.length), out);
      if (!out.refusal.empty()) return;
      const Eigen::Index least = detail::least_length(out.scaled, options_.same);
      if (least == out.scaled.cols()) return;
      Candidate shorter{
          .state = out.orbit.start,
          .period = out.orbit.period * static_cast<double>(least) / static_cast<double>(out.scaled.cols())};
      accept(shoot(system_, shorter.state, shooting(shorter, least)), out);
    } catch (const NumericalFailure& failure) {
      out.refusal = failure.what();
    }
  }

  /// Several segments bring an orbit near from afar, one segment closes it to rounding.
  [[nodiscard]] ShootingResult polished(ShootingResult found, Eigen::Index length) const {
    constexpr double kNear = 1e-6;
    if (found.converged() || !(found.orbit.residual < kNear)) return found;
    ShootingOptions single = shooting({.period = found.orbit.period}, length);
    single.segments = 1;
    return shoot(system_, found.orbit.start, single);
  }

  [[nodiscard]] ShootingOptions shooting(const Candidate& candidate, Eigen::Index length) const {
    ShootingOptions shooting = options_.shooting;
    shooting.order = static_cast<int>(length);
    shooting.period = candidate.period;
    shooting.segment_guesses = candidate.nodes;
    const Eigen::Index per_segment = options_.passages_per_segment;
    shooting.segments = static_cast<int>(candidate.nodes.empty() ? (length + per_segment - 1) / per_segment
                                                                 : static_cast<Eigen::Index>(candidate.nodes.size()));
    return shooting;
  }

  void accept(ShootingResult found, Refined& out) const {
    out.orbit = std::move(found.orbit);
    if (!found.converged()) {
      out.refusal = std::move(found.message);
      return;
    }
    out.passages =
        detail::passages_of(system_, out.orbit, attractor_.section, attractor_.passages.front().time, attractor_.basis);
    if (out.passages.offsets.size() == 0) {
      out.refusal = fmt::format("the orbit of period {:.6g} it leads to does not cross the section", out.orbit.period);
      return;
    }
    out.scaled = attractor_.metric.scaled(out.passages.points);
  }

  /// One entry per orbit, in the order of the candidates.
  void gather() {
    const std::size_t known = listed_.size();
    for (std::size_t k = 0; k < refined_.size(); ++k) {
      if (!refined_[k].tried) continue;
      if (!refined_[k].refusal.empty()) {
        skeleton_.refusals.push_back({.candidate = first_ + k, .reason = refined_[k].refusal});
        continue;
      }
      const Listed found{refined_[k].scaled, refined_[k].orbit.period};
      const auto same =
          std::find_if(listed_.begin(), listed_.end(), [&](const Listed& one) { return is_same(one, found); });
      if (same != listed_.end()) {
        ++skeleton_.orbits[static_cast<std::size_t>(same - listed_.begin())].hits;
        continue;
      }
      listed_.push_back(found);
      skeleton_.orbits.push_back(
          {.orbit = refined_[k].orbit, .length = refined_[k].scaled.cols(), .candidate = first_ + k, .hits = 1});
    }
    described_ = known;
  }

  /// An orbit as it is told from others.
  struct Listed {
    Eigen::MatrixXd scaled;  ///< its passages in the attractor's metric
    double period = 0.0;
  };

  [[nodiscard]] bool is_same(const Listed& a, const Listed& b) const {
    return a.scaled.cols() == b.scaled.cols() && std::abs(a.period - b.period) <= options_.same * a.period &&
           detail::cyclic_distance(a.scaled, b.scaled) <= options_.same;
  }

  void describe_all() {
    const Eigen::MatrixXd samples = attractor_.metric.scaled(attractor_.samples);
    const Eigen::MatrixXd passages = attractor_.metric.scaled(attractor_.points);
    ParallelOptions parallel = options_.parallel;
    // What was found before an interruption is described in full.
    parallel.stop = nullptr;
    parallel.progress = {};
    for_each(
        skeleton_.orbits.size() - described_,
        [&](std::size_t k) {
          SkeletonOrbit& member = skeleton_.orbits[described_ + k];
          const Refined& from = refined_[member.candidate - first_];
          member.points = from.passages.points;
          member.intervals = detail::intervals_of(from.passages, member.orbit.period);
          member.path = detail::path_of(system_, member.orbit, from.passages, options_.samples, attractor_.basis);
          member.share = detail::share_near(samples, attractor_.metric.scaled(member.path), options_.radius);
          member.off_attractor = detail::farthest(from.scaled, passages);
        },
        parallel);
  }

  const dynamics::HybridSystem& system_;
  const Attractor& attractor_;
  const SkeletonOptions& options_;
  std::vector<Refined> refined_;
  std::vector<Listed> listed_;  ///< by orbit of the skeleton, before it is sorted
  std::size_t first_ = 0;       ///< candidate that refined_ begins with
  std::size_t described_ = 0;   ///< orbits that were known before
  Skeleton skeleton_;
};

}  // namespace

std::vector<Candidate> close_return_candidates(const Attractor& attractor, const ReturnOptions& options) {
  std::vector<Candidate> candidates;
  for (const CloseReturn& found : section_returns(attractor.metric.scaled(attractor.points), options)) {
    const dynamics::State& state = attractor.passages[static_cast<std::size_t>(found.begin)];
    const dynamics::State& back = attractor.passages[static_cast<std::size_t>(found.begin + found.length)];
    candidates.push_back({.state = state,
                          .period = attractor.section.is_stroboscopic()
                                        ? static_cast<double>(found.length) * attractor.period
                                        : back.time - state.time,
                          .length = found.length,
                          .distance = found.distance,
                          .origin = fmt::format("passage {}", found.begin)});
  }
  return candidates;
}

Skeleton find_skeleton(const dynamics::HybridSystem& system, const Attractor& attractor, const SkeletonOptions& options,
                       const std::vector<Candidate>& more) {
  check(system, attractor, options);
  std::vector<Candidate> candidates = close_return_candidates(attractor, options.returns);
  candidates.insert(candidates.end(), more.begin(), more.end());
  return Search(system, attractor, options, {}).run(candidates);
}

Skeleton extended_skeleton(const dynamics::HybridSystem& system, const Attractor& attractor, Skeleton known,
                           const SkeletonOptions& options, const std::vector<Candidate>& more) {
  check(system, attractor, options);
  return Search(system, attractor, options, std::move(known)).run(more);
}

}  // namespace slipmode::orbits
