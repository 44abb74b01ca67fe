#include "orbits/branches/internal/branch_walk.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/parallel.hpp>
#include "orbits/branches/internal/balance_branch_solver.hpp"
#include "orbits/branches/internal/branch_solver.hpp"
#include "orbits/branches/internal/branch_tests.hpp"
#include "orbits/internal/describe_orbit.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits {
namespace {

/// Steps are rejected where the tangent turns by more than this (cosine), unless the word changes.
constexpr double kLeastCosine = 0.9;
constexpr double kLandingStep = 1e-4;
/// A mismatch a step of 1e-5 or less away that is no smooth motion's.
constexpr double kJump = 1e-3;
/// Growth of deviations in a period of which double precision leaves too little to close an orbit.
constexpr double kStretches = 1e6;
/// Points looked back upon, and how near counts as the same place (in steps), when a corner is rounded.
constexpr std::size_t kRemembered = 40;
constexpr double kSamePlace = 5.0;

/// One way along a branch.
template <class Solver>
class Walk {
 public:
  using Point = WatchedPoint<Solver>;

  Walk(const Solver& solver, const ContinuationOptions& options) : solver_(solver), options_(options) {}

  [[nodiscard]] Branch follow(const BranchPoint& from, int direction) {
    const auto first = solver_.correct(solver_.unknowns_of(from), solver_.parameter_row());
    if (!first) {
      branch_.end = BranchEnd::kLost;
      branch_.reason =
          fmt::format("the orbit handed in does not close at parameter {:.8g}: solve it there first", from.parameter);
      return std::move(branch_);
    }
    current_ = watched(first->at, static_cast<double>(direction) * solver_.parameter_row());
    add(current_, 0.0);
    first_size_ = solver_.size(current_.at);
    step_ = options_.step;
    try {
      while (!ended_) advance();
    } catch (const InvalidInput& refused) {
      end(BranchEnd::kLost,
          fmt::format("the family refuses a parameter beyond {:.9g}: {}", current_.at.at.parameter, refused.what()));
    } catch (const NumericalFailure& failure) {
      end(BranchEnd::kLost, fmt::format("beyond parameter {:.9g}: {}", current_.at.at.parameter, failure.what()));
    } catch (const Interrupted&) {
      end(BranchEnd::kInterrupted, fmt::format("interrupted beyond parameter {:.9g}", current_.at.at.parameter));
    }
    return std::move(branch_);
  }

 private:
  /// A point with all that is watched; of a family of orbits the middle one.
  [[nodiscard]] Point watched(const typename Solver::Evaluation& at, const Eigen::VectorXd& along) const {
    Point point = watch(solver_, at, along);
    if constexpr (Solver::kByShooting)
      if (const auto middle = solver_.middle_of_family(at, point.orbit)) return watch(solver_, *middle, along);
    return point;
  }

  void add(const Point& point, double step) {
    const double arclength = branch_.points.empty() ? 0.0 : branch_.points.back().arclength + step;
    branch_.points.push_back({.parameter = point.at.at.parameter,
                              .orbit = point.orbit,
                              .arclength = arclength,
                              .balance = point.balance,
                              .other = solver_.other_of(point.at)});
  }

  void end(BranchEnd how, std::string reason) {
    ended_ = true;
    branch_.end = how;
    branch_.reason = std::move(reason);
  }

  /// One accepted step, or the end.
  void advance() {
    if (static_cast<int>(branch_.points.size()) >= options_.max_points)
      return end(BranchEnd::kMaxPoints, fmt::format("{} points were asked", options_.max_points));
    while (true) {
      if (length_of(step_) > ahead().length && finish_at_range()) return;
      int iterations = 0;
      std::optional<Point> next = attempt(step_, iterations);
      const double longer = std::min((iterations <= 4 ? 1.6 : 1.1) * step_, longest_step());
      if (next && accept(std::move(*next))) {
        step_ = longer;
        return;
      }
      step_ *= 0.4;
      if (step_ < options_.min_step) return turn_or_stop();
    }
  }

  /// next_at(), where the flow may fail: at one value it may not be told from which side an event is met.
  [[nodiscard]] std::optional<Point> attempt(double s, int& out_iterations) {
    try {
      failed_.clear();
      return next_at(s, out_iterations);
    } catch (const NumericalFailure& failure) {
      failed_ = failure.what();
      return std::nullopt;
    }
  }

  /// The next point at a length s, if it is one of this branch.
  [[nodiscard]] std::optional<Point> next_at(double s, int& out_iterations) {
    const double length = length_of(s);
    const Eigen::VectorXd row = options_.arclength ? current_.tangent : solver_.parameter_row();
    const auto corrected = solver_.correct(solver_.moved(current_.at, length * current_.tangent, 0.0), row);
    if (!corrected) return std::nullopt;
    out_iterations = corrected->iterations;
    const Eigen::VectorXd way = solver_.difference(corrected->at.at, current_.at.at);
    if ((way - length * current_.tangent).norm() > 0.5 * length + 1e-7) return std::nullopt;  // another branch
    Point next = watched(corrected->at, way);
    keep_orientation(current_, next);
    why_not_ = solver_.curve_end(next.at, next.orbit);
    if (!why_not_.empty()) return std::nullopt;
    const bool lands = !current_.orbit.symmetric && next.orbit.symmetric;
    if (lands && length > kLandingStep) return std::nullopt;  // symmetric orbits are joined in small steps
    const bool kink = next.orbit.word != current_.orbit.word && length < 1e-3;
    if (next.tangent.dot(current_.tangent) < kLeastCosine && !kink) return std::nullopt;
    return next;
  }

  [[nodiscard]] double share() const { return current_.tangent[current_.tangent.size() - 1]; }

  /// The step in the tangent's length.
  [[nodiscard]] double length_of(double s) const {
    return options_.arclength ? s : s / std::max(std::abs(share()), 1e-9);
  }

  /// Where the orbit has outgrown its first size, steps grow with it, as far as the parameter's share in them allows.
  [[nodiscard]] double longest_step() const {
    if (!options_.arclength) return options_.max_step;
    const double grown = solver_.size(current_.at) / first_size_;
    return options_.max_step * std::max(1.0, std::min(grown, 1.0 / std::abs(share())));
  }

  /// The end of a parameter's range that the tangent reaches first, and at which length.
  struct Ahead {
    BranchKey<typename Solver::Unknowns> key;
    double bound = 0.0, length = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Ahead ahead() const {
    Ahead nearest;
    for (const auto& key : solver_.keys()) {
      const double way = key.range() * key.row.dot(current_.tangent);
      const double bound = way < 0 ? key.low : key.high, length = (bound - current_.at.at.*key.value) / way;
      if (way != 0.0 && length < nearest.length) nearest = {key, bound, length};
    }
    return nearest;
  }

  /// False where the branch does not lead there.
  [[nodiscard]] bool accept(Point next) {
    const double taken = current_.tangent.dot(solver_.difference(next.at.at, current_.at.at));
    const bool lands = !current_.orbit.symmetric && next.orbit.symmetric;
    if (options_.locate && !locate(next, taken)) return false;
    if (ended_) return true;
    add(next, taken);
    if (lands) {
      end_joined(SpecialKind::kSymmetryBreaking, next.at.at.parameter);
      return true;
    }
    current_ = std::move(next);
    if constexpr (Solver::kByShooting) keep_off_guards();
    if (branch_.points.size() > 10 && back_at_start(taken))
      end(BranchEnd::kClosed, "the branch is back where it began");
    return true;
  }

  void end_joined(SpecialKind kind, double parameter) {
    end(BranchEnd::kMerged,
        kind == SpecialKind::kHopf
            ? fmt::format("the orbits shrink to a state of rest at parameter {:.9g}: a Hopf point", parameter)
        : kind == SpecialKind::kPeriodDoubling
            ? fmt::format("the orbits became those of half the period at parameter {:.9g}: the branch joins theirs",
                          parameter)
            : fmt::format(
                  "the orbits became symmetric near parameter {:.8g}: the branch joins that of symmetric orbits",
                  parameter));
  }

  /// False where a curve does not go on to the next point: it passes a change of word that is not found between them.
  [[nodiscard]] bool locate(const Point& next, double length) {
    const double tolerance = std::min(options_.locate_tolerance * solver_.range(), 1e-8);
    SpecialPoints<Solver> found = special_points_between(solver_, current_, next, length, tolerance);
    for (SpecialPoint& special : found.points) {
      if (solver_.on_curve() && special.kind != SpecialKind::kCusp && special.uncertainty > tolerance) {
        why_not_ =
            "the word changes, where multipliers jump or turn sharply: " + word_change(current_.orbit, next.orbit);
        return false;
      }
      if (special.kind == SpecialKind::kNonSmoothFold && special.uncertainty > tolerance && length > options_.min_step)
        return false;  // the corner is nearer at shorter steps
      special.before = branch_.points.size() - 1;
      branch_.special.push_back(std::move(special));
    }
    if (found.joins) {
      add(*found.joins, solver_.difference(found.joins->at.at, current_.at.at).norm());
      end_joined(branch_.special.back().kind, branch_.special.back().parameter);
    }
    return true;
  }

  /// The orbit on the end of the range ahead, if the tangent leads there.
  [[nodiscard]] bool finish_at_range() {
    const auto [key, bound, length] = ahead();
    if (length > 1e-12) {
      typename Solver::Unknowns guess = solver_.moved(current_.at, length * current_.tangent, 0.0);
      guess.*key.value = bound;
      const auto corrected = solver_.correct(guess, key.row);
      if (!corrected) return false;
      const Eigen::VectorXd way = solver_.difference(corrected->at.at, current_.at.at);
      if ((way - length * current_.tangent).norm() > 0.5 * length + 1e-7) return false;
      Point last = watched(corrected->at, way);
      if (options_.locate && !locate(last, current_.tangent.dot(way))) return false;
      if (ended_) return true;
      add(last, way.norm());
    }
    end(BranchEnd::kRange, fmt::format("the {}parameter left its range at {:.8g}",
                                       key.value == &Solver::Unknowns::parameter ? "" : "other ", bound));
    return true;
  }

  /// No step leads on along the tangent: where the word changes, the branch may have a kink, or turn back.
  void turn_or_stop() {
    for (const double s : {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3}) {
      if (!options_.arclength || !why_not_.empty()) break;
      for (const double sign : {1.0, -1.0}) {
        auto next = around_corner(s, sign);
        if (!next) continue;
        SpecialPoint corner;
        const double onward = (next->at.at.parameter - current_.at.at.parameter) * current_.fold;
        corner.kind =
            onward < 0 ? SpecialKind::kNonSmoothFold : kind_of_word_change(current_.orbit.word, next->orbit.word);
        corner.parameter = current_.at.at.parameter;
        corner.uncertainty = std::abs(next->at.at.parameter - corner.parameter);
        corner.orbit = current_.orbit;
        corner.balance = current_.balance;
        corner.other = solver_.other_of(current_.at);
        corner.before = branch_.points.size() - 1;
        corner.note = word_change(current_.orbit, next->orbit);
        branch_.special.push_back(std::move(corner));
        add(*next, s);
        current_ = std::move(*next);
        step_ = std::max(s, options_.min_step);
        return;
      }
    }
    see_ahead();
    if (!why_not_.empty())
      return end(BranchEnd::kMerged, fmt::format("at parameter {:.9g} {}", current_.at.at.parameter, why_not_));
    const PeriodicOrbit& last = branch_.points.back().orbit;
    std::string seen = fmt::format("no orbit is found beyond parameter {:.9g}, with steps down to {:.1e}",
                                   current_.at.at.parameter, options_.min_step);
    if (!failed_.empty())
      seen += "; " + failed_;
    else if (!options_.arclength && std::abs(current_.fold) < 0.1)
      seen += "; the branch turns back there (fold): follow it with arclength";
    else if (last.has_grazing || last.grazing < 0.05)
      seen += fmt::format("; a stop is met at {:.1e} of the top speed there: a grazing at which the orbit ends",
                          last.grazing);
    else if (solver_.on_curve())
      seen += "; the curve may end on another one, as folds and losses of symmetry do on grazings";
    else if (const std::string jump = jump_ahead(); !jump.empty())
      seen += "; " + jump;
    else if (last.leading_modulus > kStretches)
      seen += fmt::format("; deviations grow {:.1e} times in a period there, more than shooting holds",
                          last.leading_modulus);
    else
      seen += "; see whether an event meets the orbit's origin, or the family is not continuous there";
    end(BranchEnd::kLost, std::move(seen));
  }

  /// A motion that jumps a little further on, as where friction falls from μ_s to μ_k: mismatches do not shrink with
  /// the way there. Empty where none is seen.
  [[nodiscard]] std::string jump_ahead() const {
    try {
      for (const double s : {1e-7, 1e-6, 1e-5}) {
        const typename Solver::Evaluation there =
            solver_.evaluate(solver_.moved(current_.at, s * current_.tangent, 0.0));
        const PeriodicOrbit orbit = solver_.describe(there);
        if (orbit.word == current_.orbit.word || there.r.norm() < kJump) continue;
        return fmt::format(
            "the motion jumps there, by {:.1e} of its size ({}): where friction falls from its static "
            "to its sliding limit an orbit ends so",
            there.r.norm(), word_change(current_.orbit, orbit));
      }
    } catch (const NumericalFailure&) {
      return {};  // what lies ahead stays unknown
    }
    return {};
  }

  /// A curve that is found no more may have come to where the word changes.
  void see_ahead() {
    for (const double s : {1e-5, 1e-4, 1e-3}) {
      if (!solver_.on_curve() || !why_not_.empty()) return;
      try {
        const auto orbit = solver_.orbit_ahead(current_.at, s * current_.tangent);
        if (orbit && orbit->word != current_.orbit.word)
          why_not_ = "the word changes, where multipliers jump or turn sharply: " + word_change(current_.orbit, *orbit);
      } catch (const NumericalFailure&) {
        return;  // what lies ahead stays unknown
      }
    }
  }

  [[nodiscard]] std::optional<Point> around_corner(double s, double sign) const {
    try {
      const auto across = solver_.evaluate(solver_.moved(current_.at, s * current_.tangent, 0.0));
      const Eigen::VectorXd tangent = sign * solver_.tangent(across, current_.tangent);
      const auto corrected = solver_.correct(solver_.moved(current_.at, s * tangent, 0.0), tangent);
      if (!corrected) return std::nullopt;
      Point next = watched(corrected->at, solver_.difference(corrected->at.at, current_.at.at));
      const bool near = solver_.difference(next.at.at, current_.at.at).norm() < 3.0 * s;
      const bool goes_on = near && next.orbit.word != current_.orbit.word && !was_here(next, s);
      return goes_on ? std::optional(std::move(next)) : std::nullopt;
    } catch (const NumericalFailure&) {
      return std::nullopt;
    }
  }

  /// True when one of the last points is the same orbit within s: the way round a corner led back.
  [[nodiscard]] bool was_here(const Point& next, double s) const {
    const std::size_t count = branch_.points.size();
    for (std::size_t k = count > kRemembered ? count - kRemembered : 0; k < count; ++k) {
      const BranchPoint& old = branch_.points[k];
      const double modulus = std::max(old.orbit.leading_modulus, next.orbit.leading_modulus);
      if (old.orbit.word == next.orbit.word &&
          std::abs(old.parameter - next.at.at.parameter) <= kSamePlace * s * solver_.range() &&
          std::abs(old.orbit.period - next.orbit.period) <= kSamePlace * s * old.orbit.period &&
          std::abs(old.orbit.leading_modulus - next.orbit.leading_modulus) <= 0.05 * modulus)
        return true;
    }
    return false;
  }

  /// An orbit's origin may drift onto an event as the branch goes on, where derivatives jump: it is then set anew.
  void keep_off_guards() {
    const PeriodicOrbit& orbit = current_.orbit;
    const double distance = distance_to_events(orbit.start.time, orbit.period, orbit.events);
    if (distance > 0.01 * orbit.period) return;
    const double shift = middle_of_longest_stretch(orbit.start.time, orbit.period, orbit.events);
    if (distance_to_events(orbit.start.time + shift, orbit.period, orbit.events) < 2.0 * distance) return;
    try {
      const double share = shift / orbit.period;
      const typename Solver::Evaluation later = solver_.shifted(current_.at, share);
      typename Solver::Evaluation ahead = solver_.evaluate(solver_.moved(current_.at, 1e-4 * current_.tangent, 0.0));
      ahead = solver_.shifted(ahead, share);
      current_ = watched(later, solver_.difference(ahead.at, later.at));
    } catch (const NumericalFailure&) {
      return;  // the origin stays where it is
    }
  }

  [[nodiscard]] bool back_at_start(double taken) const {
    const BranchPoint& first = branch_.points.front();
    if (std::abs(first.parameter - current_.at.at.parameter) > taken * solver_.range()) return false;
    const typename Solver::Unknowns began = solver_.unknowns_of(first);
    const typename Solver::Evaluation here = with_origin_of(began);
    const Eigen::VectorXd way = solver_.difference(began, here.at);
    if (way.norm() >= taken) return false;
    // Another part of the branch may pass as near: of this part the orbit beside the first one is to be the first one.
    constexpr double kSame = 1e-6;
    const Eigen::VectorXd tangent = solver_.tangent(here, way);
    const auto beside = solver_.correct(solver_.moved(here, tangent.dot(way) * tangent, 0.0), tangent);
    return beside && solver_.difference(began, beside->at.at).norm() < kSame;
  }

  /// The current point with its origin at another one's phase of the drive, where origins move.
  [[nodiscard]] typename Solver::Evaluation with_origin_of(const typename Solver::Unknowns& other) const {
    if constexpr (Solver::kByShooting) {
      double share = (other.phase - current_.at.at.phase) / current_.orbit.order;
      if (share < 0) share += 1.0 / current_.orbit.order;
      if (share > 0) return solver_.shifted(current_.at, share);
    }
    return current_.at;
  }

  const Solver& solver_;
  const ContinuationOptions& options_;
  Branch branch_;
  Point current_;
  double step_ = 0.0, first_size_ = 0.0;
  bool ended_ = false;
  std::string failed_;   ///< how the flow failed in the last attempt
  std::string why_not_;  ///< what kept the last attempt on a curve from going on
};

/// The second way's points behind the first's start, in order along the branch.
Branch joined(Branch backward, Branch forward) {
  Branch out;
  const std::size_t count = backward.points.size();
  const double whole = count > 0 ? backward.points.back().arclength : 0.0;
  for (std::size_t k = count; k-- > 1;) {
    out.points.push_back(std::move(backward.points[k]));
    out.points.back().arclength = whole - out.points.back().arclength;
  }
  for (std::size_t k = backward.special.size(); k-- > 0;) {
    out.special.push_back(std::move(backward.special[k]));
    out.special.back().before = count - 2 - std::min(out.special.back().before, count - 2);
  }
  const std::size_t offset = out.points.size();
  for (BranchPoint& point : forward.points) {
    point.arclength += whole;
    out.points.push_back(std::move(point));
  }
  for (SpecialPoint& special : forward.special) {
    special.before += offset;
    out.special.push_back(std::move(special));
  }
  out.end = is_complete(backward.end) ? forward.end : backward.end;
  out.reason = "one way: " + backward.reason + "; other way: " + forward.reason;
  return out;
}

}  // namespace

void check_continuation(double parameter, const ContinuationOptions& options) {
  const double low = std::min(options.from, options.to), high = std::max(options.from, options.to);
  if (!(high > low && std::isfinite(high) && std::isfinite(low)))
    throw InvalidInput(fmt::format("the range of a continuation needs two different finite ends, not {} and {}",
                                   options.from, options.to));
  if (!(parameter >= low && parameter <= high))
    throw InvalidInput(
        fmt::format("the continuation starts at {}, outside its range {} … {}", parameter, options.from, options.to));
  if (!(options.step > 0 && options.min_step > 0 && options.max_step >= options.min_step && options.max_points >= 1))
    throw InvalidInput("continuation steps must be positive, max_step ≥ min_step, max_points ≥ 1");
}

template <class Solver>
Branch walk_branch(const Solver& solver, const ContinuationOptions& options, const BranchPoint& from) {
  const int direction = options.direction < 0 ? -1 : 1;
  Branch first = Walk<Solver>(solver, options).follow(from, direction);
  if (!options.both_ways || first.end == BranchEnd::kClosed || first.end == BranchEnd::kInterrupted) return first;
  return joined(Walk<Solver>(solver, options).follow(from, -direction), std::move(first));
}

template Branch walk_branch(const BranchSolver&, const ContinuationOptions&, const BranchPoint&);
template Branch walk_branch(const BalanceBranchSolver&, const ContinuationOptions&, const BranchPoint&);

}  // namespace slipmode::orbits
