#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits {
namespace {

using dynamics::State;

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
                                 double duration, int max_returns, int contact,
                                 std::optional<dynamics::EventKind> section) {
  if (!(transient >= 0 && duration > 0 && max_returns >= 1))
    throw InvalidInput(
        fmt::format("a recurrence needs a transient ≥ 0, a duration > 0 and max_returns ≥ 1; found {}, "
                    "{} and {}",
                    transient, duration, max_returns));
  const auto c = static_cast<std::size_t>(contact);
  const bool slides = c < system.contacts().size() && !friction::sticks(friction::kind(system.contacts()[c].law));
  const dynamics::EventKind kind =
      section.value_or(slides ? dynamics::EventKind::kReversal : dynamics::EventKind::kRelease);
  std::vector<State> passes;
  const auto note = [&](const dynamics::Event& event, const State& state) {
    if (event.contact == contact && event.kind == kind) passes.push_back(state);
    return true;
  };
  static_cast<void>(simulate(
      system, advanced(system, start, transient),
      {.duration = duration, .keep_events = false, .flow = {.tolerance = 1e-12, .audit = false}, .on_event = note}));
  if (passes.size() < 2)
    throw NumericalFailure(
        fmt::format("the section (events of one kind at contact {}) was passed {} times in {} s; two "
                    "passages make a return. Simulate longer, or choose another section",
                    contact + 1, passes.size(), duration),
        start.time + transient, stacked(start), std::numeric_limits<double>::quiet_NaN());
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

}  // namespace slipmode::orbits
