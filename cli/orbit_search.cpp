#include "cli/orbit_search.hpp"

#include <fmt/format.h>
#include <charconv>
#include <cmath>

namespace slipmode::cli {
namespace {

/// The order that a period stands for under a periodic drive.
int order_of(double period, double drive) {
  constexpr double kClose = 1e-9;  // relative: what a period given with ten digits may miss
  const double ratio = period / drive;
  const double nearest = std::max(1.0, std::round(ratio));
  if (std::abs(ratio - nearest) <= kClose * nearest) return static_cast<int>(nearest);
  throw InvalidInput(fmt::format(
      "--period {:.12g}: no multiple of the drive's {:.12g} (it is {:.6g} of them); valid: {:.12g}, or --order {}",
      period, drive, ratio, nearest * drive, static_cast<int>(nearest)));
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    double value = 0.0;
    const auto [stopped, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc() || stopped != text.data() + end || !std::isfinite(value)) {
      throw InvalidInput(fmt::format("--start {}: '{}' is no number; valid: settle, initial, or q1,...,qn,v1,...,vn",
                                     text, text.substr(begin, end - begin)));
    }
    numbers.push_back(value);
    begin = end + 1;
  }
  return numbers;
}

dynamics::State given_state(const std::string& text, Eigen::Index n) {
  const std::vector<double> numbers = numbers_of(text);
  if (static_cast<Eigen::Index>(numbers.size()) != 2 * n) {
    throw InvalidInput(
        fmt::format("--start: {} values for {} degrees of freedom; expected {}: displacements, then "
                    "velocities",
                    numbers.size(), n, 2 * n));
  }
  const Eigen::Map<const Eigen::VectorXd> x(numbers.data(), 2 * n);
  return {.q = x.head(n), .v = x.tail(n)};
}

/// Under a periodic drive the guess settles for whole periods.
dynamics::State settled(const OrbitSearch& search, const studies::Family& model, double drive) {
  const double periods = search.settle > 0.0 ? search.settle : model.scene().time.transient / drive;
  return orbits::settle_guess(model.own(), model.start(), std::round(periods));
}

SearchStart self_excited(const OrbitSearch& search, const studies::Family& model, orbits::ShootingOptions options) {
  if (search.order != 1) {
    throw InvalidInput(
        fmt::format("--order {}: counts periods of the drive, and this drive has none; valid: --period", search.order));
  }
  options.period = search.period;
  const dynamics::State start = model.start();
  if (search.start != "settle") {
    if (search.period <= 0.0) {
      throw InvalidInput(
          fmt::format("--start {}: the drive has no period, so --period is needed with it", search.start));
    }
    return {search.start == "initial" ? start : model.own_state(given_state(search.start, model.scene().size())),
            options};
  }
  const scene::TimeSpec& time = model.scene().time;
  const double transient = search.settle > 0.0 ? search.settle : time.transient;
  const double duration = time.duration - time.transient;
  const orbits::RecurrenceGuess guess = orbits::recurrence_guess(model.own(), start, transient, duration);
  if (options.period <= 0.0) options.period = guess.period;
  return {guess.state, options};
}

}  // namespace

void add_search_options(CLI::App& command, OrbitSearch& search) {
  command.add_option("SCENE", search.scene, "scene file (TOML)")->required();
  command.add_option("--model", search.model, "full, or rom:FILE with a result of 'slipmode reduce'");
  command.add_option("--order", search.order, "period in periods of the drive")->check(CLI::PositiveNumber);
  command.add_option("--period", search.period, "period: a multiple of the drive's; on a belt a guess")
      ->check(CLI::PositiveNumber);
  command.add_option("--segments", search.segments, "segments of multiple shooting; 1: single shooting")
      ->check(CLI::Range(1, 10000));
  command.add_option("--start", search.start,
                     "where Newton's method begins: settle (a run from [initial]), initial, or q1,...,qn,v1,...,vn");
  command
      .add_option("--settle", search.settle,
                  "length of that run, in periods of the drive, or time on a belt; 0: as [time] says")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--tolerance", search.tolerance, "bound on the orbit's relative mismatch after a period")
      ->check(CLI::PositiveNumber);
  command.add_option("--iterations", search.iterations, "Newton steps at most")->check(CLI::PositiveNumber);
  command.add_flag("--symmetric", search.half, "look for a symmetric orbit by its half period");
}

SearchStart search_start(const OrbitSearch& search, const studies::Family& model) {
  orbits::ShootingOptions options{.order = search.order,
                                  .segments = search.segments,
                                  .tolerance = search.tolerance,
                                  .max_iterations = search.iterations,
                                  .half_period = search.half};
  options.flow.method = model.scene().flow.method;
  const std::optional<double> drive = model.own().drive().period();
  if (!drive) return self_excited(search, model, options);
  if (search.period > 0.0) {
    const int order = order_of(search.period, *drive);
    if (search.order != 1 && search.order != order) {
      throw InvalidInput(
          fmt::format("--order {}: --period {} is order {}; give one of them", search.order, search.period, order));
    }
    options.order = order;
  }
  if (search.start != "settle" && search.start != "initial") {
    return {model.own_state(given_state(search.start, model.scene().size())), options};
  }
  if (search.start == "initial") return {model.start(), options};
  return {settled(search, model, *drive), options};
}

}  // namespace slipmode::cli
