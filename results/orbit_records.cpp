#include <slipmode/results/orbit_records.hpp>

#include <slipmode/results/records.hpp>
#include "results/internal/checked_read.hpp"
#include "results/internal/event_record.hpp"
#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {

namespace {

using orbits::PeriodicOrbit;

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
  store.describe_group(group, "a periodic orbit; states and matrices in the order (q, q', internal)");
  save(store, group + "/start", orbit.start);
  store.write(group + "/kind", std::string(orbits::to_string(orbit.kind)), {"", "what sets the period"});
  store.write(group + "/monodromy", orbit.monodromy, {"", "fundamental matrix over one period"});
  store.write(group + "/multipliers", real_and_imaginary(orbit.multipliers),
              {"1", "Floquet multipliers by modulus, multiplier x (real, imaginary)"});
  store.write(group + "/stability", std::string(orbits::to_string(orbit.stability)), {"", "stability"});
  store.write(group + "/half_multipliers", real_and_imaginary(orbit.half_multipliers),
              {"1", "of the half-period map with reflection; empty: no symmetry"});
  save_events(store, group + "/events", orbit.events);
  save_regimes(store, group + "/regimes", orbit.regimes);
  save_fields(store, group, orbit);
}

PeriodicOrbit load_orbit(const StoreReader& store, const std::string& group) {
  using orbits::OrbitKind;
  using orbits::Stability;
  auto orbit = load_fields<PeriodicOrbit>(store, group);
  orbit.start = load_state(store, group + "/start");
  const Eigen::Index n = 2 * orbit.start.q.size() + orbit.start.internal.size();
  orbit.kind = enum_of(store, group + "/kind", {OrbitKind::kDriven, OrbitKind::kSelfExcited});
  orbit.monodromy = finite_matrix(store, group + "/monodromy", n, n);
  orbit.multipliers = complex_of(finite_matrix(store, group + "/multipliers", n, 2));
  orbit.stability =
      enum_of(store, group + "/stability", {Stability::kStable, Stability::kUnstable, Stability::kMarginal});
  orbit.half_multipliers = complex_of(finite_matrix(store, group + "/half_multipliers", StoreReader::kAny, 2));
  orbit.events = load_events(store, group + "/events");
  orbit.regimes = load_regimes(store, group + "/regimes");
  return orbit;
}

}  // namespace slipmode::results
