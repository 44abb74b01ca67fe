#include <slipmode/results/orbit_records.hpp>

#include <slipmode/results/records.hpp>
#include "results/internal/checked_read.hpp"
#include "results/internal/event_record.hpp"

#include <fmt/format.h>
#include <limits>

namespace slipmode::results {

namespace {

using orbits::PeriodicOrbit;

constexpr std::int64_t kMost = std::numeric_limits<int>::max();

Eigen::MatrixXd real_and_imaginary(const Eigen::VectorXcd& values) {
  Eigen::MatrixXd parts(values.size(), 2);
  parts.col(0) = values.real();
  parts.col(1) = values.imag();
  return parts;
}

Eigen::VectorXcd complex_of(const Eigen::MatrixXd& parts) {
  Eigen::VectorXcd values(parts.rows());
  values.real() = parts.col(0);
  values.imag() = parts.col(1);
  return values;
}

void save_regimes(StoreWriter& store, const std::string& group, const std::vector<orbits::RegimeSpan>& regimes) {
  std::vector<double> times;
  std::vector<dynamics::ContactMode> modes;
  for (const orbits::RegimeSpan& span : regimes) {
    times.push_back(span.time);
    modes.insert(modes.end(), span.modes.begin(), span.modes.end());
  }
  store.describe_group(group, "regimes passed, in time order");
  store.write(group + "/time", times, {"s", "beginning of each regime"});
  save_modes(store, group + "/modes", modes, "what each contact does, regime after regime, all contacts of each");
}

std::vector<orbits::RegimeSpan> load_regimes(const StoreReader& store, const std::string& group) {
  const Eigen::VectorXd times = finite_vector(store, group + "/time");
  const std::vector<dynamics::ContactMode> modes = load_modes(store, group + "/modes");
  const auto count = static_cast<std::size_t>(times.size());
  if (count > 0 && modes.size() % count != 0) {
    store.fail(group,
               fmt::format("has {} modes for {} regimes; the file is damaged, make it again", modes.size(), count));
  }
  const std::size_t contacts = count > 0 ? modes.size() / count : 0;
  std::vector<orbits::RegimeSpan> regimes;
  for (std::size_t r = 0; r < count; ++r) {
    const auto first = modes.begin() + static_cast<std::ptrdiff_t>(r * contacts);
    regimes.push_back({times(static_cast<Eigen::Index>(r)), {first, first + static_cast<std::ptrdiff_t>(contacts)}});
  }
  return regimes;
}

int count_of(const StoreReader& store, const std::string& name) {
  const std::int64_t value = store.integer(name);
  if (value < 0 || value > kMost) store.fail(name, fmt::format("{}; expected 0 to {}", value, kMost));
  return static_cast<int>(value);
}

/// One of the words an enum's values are called, as a value.
template <class Enum>
Enum enum_of(const StoreReader& store, const std::string& name, std::initializer_list<Enum> values) {
  const std::string word = store.text(name);
  for (const Enum value : values) {
    if (word == orbits::to_string(value)) return value;
  }
  store.fail(name, fmt::format("'{}' is not known; make the file again", word));
}

}  // namespace

void save(StoreWriter& store, const std::string& group, const PeriodicOrbit& orbit) {
  const auto whole = [](int value) { return static_cast<std::int64_t>(value); };
  const auto yes = [](bool value) { return static_cast<std::int64_t>(value); };
  store.describe_group(group, "a periodic orbit; states and matrices in the order (q, q', internal)");
  save(store, group + "/start", orbit.start);
  store.write(group + "/period", orbit.period, {"s", "period"});
  store.write(group + "/kind", std::string(orbits::to_string(orbit.kind)), {"", "what sets the period"});
  store.write(group + "/order", whole(orbit.order), {"", "period over that of the drive; 1 when self-excited"});
  store.write(group + "/repeats", whole(orbit.repeats), {"", "how often a shorter orbit is passed within the period"});
  store.write(group + "/monodromy", orbit.monodromy, {"", "fundamental matrix over one period"});
  store.write(group + "/multipliers", real_and_imaginary(orbit.multipliers),
              {"1", "Floquet multipliers by modulus, multiplier x (real, imaginary)"});
  store.write(group + "/trivial_multipliers", whole(orbit.trivial_multipliers),
              {"", "multipliers 1 that belong to a family, not to stability"});
  store.write(group + "/leading_modulus", orbit.leading_modulus, {"1", "largest modulus without the trivial ones"});
  store.write(group + "/stability", std::string(orbits::to_string(orbit.stability)), {"", "stability"});
  store.write(group + "/zero_multipliers", whole(orbit.zero_multipliers), {"", "multipliers that are zero"});
  store.write(group + "/superstable", yes(orbit.superstable), {"", "1: all but the trivial multipliers are zero"});
  store.write(group + "/half_multipliers", real_and_imaginary(orbit.half_multipliers),
              {"1", "of the half-period map with reflection; empty: no symmetry"});
  save_events(store, group + "/events", orbit.events);
  save_regimes(store, group + "/regimes", orbit.regimes);
  store.write(group + "/word", orbit.word, {"", "cyclic sequence of regimes, a letter per contact"});
  store.write(group + "/crossings", whole(orbit.crossings), {"", "events that change the force law of a contact"});
  store.write(group + "/symmetric", yes(orbit.symmetric), {"", "1: x(T/2) = -x(0)"});
  store.write(group + "/asymmetry", orbit.asymmetry, {"1", "mismatch of x(T/2) + x(0)"});
  store.write(group + "/grazing", orbit.grazing, {"1", "least speed at which a stop is reached, relative"});
  store.write(group + "/has_grazing", yes(orbit.has_grazing), {"", "1: a grazing, or nearly one"});
  store.write(group + "/family", orbit.family,
              {"", "directions of the family it is one of, as columns; empty: isolated"});
  store.write(group + "/family_note", orbit.family_note, {"", "the family in words; empty: isolated"});
  store.write(group + "/residual", orbit.residual, {"1", "largest mismatch after a period, relative"});
  store.write(group + "/iterations", whole(orbit.iterations), {"", "Newton steps"});
  store.write(group + "/residuals", orbit.residuals, {"1", "before each Newton step and after the last"});
}

PeriodicOrbit load_orbit(const StoreReader& store, const std::string& group) {
  using orbits::OrbitKind;
  using orbits::Stability;
  PeriodicOrbit orbit;
  orbit.start = load_state(store, group + "/start");
  const Eigen::Index n = 2 * orbit.start.q.size() + orbit.start.internal.size();
  orbit.period = store.number(group + "/period");
  orbit.kind = enum_of(store, group + "/kind", {OrbitKind::kDriven, OrbitKind::kSelfExcited});
  orbit.order = count_of(store, group + "/order");
  orbit.repeats = count_of(store, group + "/repeats");
  orbit.monodromy = finite_matrix(store, group + "/monodromy", n, n);
  orbit.multipliers = complex_of(finite_matrix(store, group + "/multipliers", n, 2));
  orbit.trivial_multipliers = count_of(store, group + "/trivial_multipliers");
  orbit.leading_modulus = store.number(group + "/leading_modulus");
  orbit.stability =
      enum_of(store, group + "/stability", {Stability::kStable, Stability::kUnstable, Stability::kMarginal});
  orbit.zero_multipliers = count_of(store, group + "/zero_multipliers");
  orbit.superstable = count_of(store, group + "/superstable") != 0;
  orbit.half_multipliers = complex_of(finite_matrix(store, group + "/half_multipliers", StoreReader::kAny, 2));
  orbit.events = load_events(store, group + "/events");
  orbit.regimes = load_regimes(store, group + "/regimes");
  orbit.word = store.text(group + "/word");
  orbit.crossings = count_of(store, group + "/crossings");
  orbit.symmetric = count_of(store, group + "/symmetric") != 0;
  orbit.asymmetry = store.number(group + "/asymmetry");
  orbit.grazing = store.number(group + "/grazing");
  orbit.has_grazing = count_of(store, group + "/has_grazing") != 0;
  orbit.family = finite_matrix(store, group + "/family");
  orbit.family_note = store.text(group + "/family_note");
  orbit.residual = store.number(group + "/residual");
  orbit.iterations = count_of(store, group + "/iterations");
  const Eigen::VectorXd residuals = finite_vector(store, group + "/residuals");
  orbit.residuals.assign(residuals.begin(), residuals.end());
  return orbit;
}

}  // namespace slipmode::results
