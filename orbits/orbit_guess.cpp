#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace slipmode::orbits {
namespace {

using dynamics::State;

constexpr double kWatched = 20'000.0;
/// Of a displacement: less is rounding.
constexpr double kMoves = 1e-9;

/// Largest coordinate of a set of states, displacements and velocities apart.
struct Size {
  double q = 0.0, v = 0.0;
};

Size size_of(const std::vector<State>& states) {
  Size size;
  for (const State& s : states) {
    size.q = std::max(size.q, s.q.cwiseAbs().maxCoeff());
    size.v = std::max(size.v, s.v.cwiseAbs().maxCoeff());
  }
  return {size.q > 0 ? size.q : 1.0, size.v > 0 ? size.v : 1.0};
}

double difference(const State& a, const State& b, const Size& size) {
  return std::max((a.q - b.q).cwiseAbs().maxCoeff() / size.q, (a.v - b.v).cwiseAbs().maxCoeff() / size.v);
}

/// Where a motion without events may come back: the first contact's displacement on its way up through its mean,
/// between samples by straight lines.
std::vector<State> upward_passes(const dynamics::Trajectory& run) {
  std::vector<State> passes;
  if (run.contact_q.rows() == 0) return passes;
  const Eigen::VectorXd y = run.contact_q.row(0).array() - run.contact_q.row(0).mean();
  if (y.cwiseAbs().maxCoeff() <= kMoves * run.contact_q.row(0).cwiseAbs().maxCoeff()) return passes;
  for (Eigen::Index k = 1; k < y.size(); ++k) {
    if (!(y[k - 1] < 0.0 && y[k] >= 0.0)) continue;
    const double share = y[k - 1] / (y[k - 1] - y[k]);
    State pass = run.final_state;
    pass.time = run.times[k - 1] + share * (run.times[k] - run.times[k - 1]);
    pass.q = (1.0 - share) * run.q.col(k - 1) + share * run.q.col(k);
    pass.v = (1.0 - share) * run.v.col(k - 1) + share * run.v.col(k);
    passes.push_back(std::move(pass));
  }
  return passes;
}

struct Watched {
  std::vector<State> passes;  ///< at the events of the section that recurrence_guess() names
  State end;
};

Watched watched(const dynamics::HybridSystem& system, const State& start, double duration) {
  using dynamics::EventKind;
  const auto rank = [](EventKind kind) {
    return kind == EventKind::kRelease ? 0 : kind == EventKind::kReversal ? 1 : 2;
  };
  std::map<std::tuple<int, int, EventKind>, std::vector<State>> sections;
  const auto note = [&](const dynamics::Event& event, const State& state) {
    if (event.contact >= 0) sections[{rank(event.kind), event.contact, event.kind}].push_back(state);
    return true;
  };
  const dynamics::Trajectory run = simulate(system, start,
                                            {.duration = duration,
                                             .sample = duration / kWatched,
                                             .keep_events = false,
                                             .flow = {.tolerance = 1e-12, .audit = false},
                                             .on_event = note});
  for (auto& [which, passes] : sections)
    if (passes.size() >= 2) return {std::move(passes), run.final_state};
  return {upward_passes(run), run.final_state};
}

/// The best return of at most `max_returns`, or a shorter one as recurrence_guess() says.
RecurrenceGuess best_return(const std::vector<State>& passes, int max_returns) {
  const Size size = size_of(passes);
  std::vector<RecurrenceGuess> best;  // for each number of returns
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t p = 1; p <= static_cast<std::size_t>(max_returns) && p < passes.size(); ++p) {
    RecurrenceGuess guess{{}, 0.0, std::numeric_limits<double>::infinity()};
    for (std::size_t k = p; k < passes.size(); ++k) {
      const double mismatch = difference(passes[k], passes[k - p], size);
      if (mismatch < guess.mismatch) guess = {passes[k - p], passes[k].time - passes[k - p].time, mismatch};
    }
    smallest = std::min(smallest, guess.mismatch);
    best.push_back(std::move(guess));
  }
  return *std::find_if(best.begin(), best.end(),
                       [&](const RecurrenceGuess& guess) { return guess.mismatch <= std::max(3.0 * smallest, 1e-4); });
}

}  // namespace

State settle_guess(const dynamics::HybridSystem& system, const State& start, double periods, double unit) {
  const double period = system.drive().period().value_or(unit);
  if (!(period > 0 && periods >= 0 && std::isfinite(periods)))
    throw InvalidInput(
        fmt::format("settling takes a number of periods ≥ 0 (found {}) of a length > 0 s (found {}); a "
                    "constant drive has no period, so give `unit`",
                    periods, period));
  return advanced(system, start, periods * period);
}

RecurrenceGuess recurrence_guess(const dynamics::HybridSystem& system, const State& start, double transient,
                                 double duration, int max_returns) {
  if (!(transient >= 0 && duration > 0 && max_returns >= 1))
    throw InvalidInput(
        fmt::format("a recurrence needs a transient ≥ 0, a duration > 0 and max_returns ≥ 1; found {}, "
                    "{} and {}",
                    transient, duration, max_returns));
  constexpr int kWatches = 8;
  constexpr double kNear = 1e-3;
  Watched seen = watched(system, advanced(system, start, transient), duration);
  if (seen.passes.size() < 2)
    throw NumericalFailure(
        fmt::format("no event and no swing came twice in {} s: the motion may rest, or slide steadily; else simulate "
                    "longer (time.duration)",
                    duration),
        start.time + transient, stacked(start), std::numeric_limits<double>::quiet_NaN());
  RecurrenceGuess first = best_return(seen.passes, max_returns);
  RecurrenceGuess last = first;
  for (int stretch = 1; stretch < kWatches && last.mismatch > kNear; ++stretch) {
    seen = watched(system, seen.end, duration);
    if (seen.passes.size() < 2) return first;
    last = best_return(seen.passes, max_returns);
  }
  return last.mismatch <= kNear ? last : first;
}

}  // namespace slipmode::orbits
