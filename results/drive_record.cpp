#include "results/internal/contact_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {

namespace {

void save_force(StoreWriter& store, const std::string& group, const friction::Force& force) {
  std::vector<double> amplitude, phase;
  std::vector<std::int64_t> order, direction;
  for (const friction::ForceHarmonic& own : force.harmonics) {
    amplitude.push_back(own.amplitude);
    phase.push_back(own.phase);
    order.push_back(own.order);
    direction.push_back(own.direction);
  }
  store.describe_group(group, "force on the structure: sum of amplitude sin(order omega t + phase) along directions");
  store.write(group + "/kind", std::string("force"), {"", "kind of drive"});
  store.write(group + "/omega", force.omega, {"rad/s", "angular frequency of order 1"});
  store.write(group + "/amplitude", amplitude, {"N", "of each harmonic"});
  store.write(group + "/phase", phase, {"rad", "of each harmonic at time 0"});
  store.write(group + "/order", order, {"", "of each harmonic"});
  store.write(group + "/direction", direction, {"", "row of force_directions each harmonic acts along, from 0"});
}

friction::Force load_force(const StoreReader& store, const std::string& group) {
  friction::Force force{store.number(group + "/omega"), {}};
  const Eigen::VectorXd amplitude = store.vector(group + "/amplitude");
  const Eigen::VectorXd phase = store.vector(group + "/phase", amplitude.size());
  const std::vector<std::int64_t> order = store.integers(group + "/order", amplitude.size());
  const std::vector<std::int64_t> direction = store.integers(group + "/direction", amplitude.size());
  for (Eigen::Index k = 0; k < amplitude.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    force.harmonics.push_back({.amplitude = amplitude(k),
                               .phase = phase(k),
                               .order = static_cast<int>(order[at]),
                               .direction = static_cast<int>(direction[at])});
  }
  return force;
}

}  // namespace

void save_drive(StoreWriter& store, const std::string& group, const friction::Drive& drive) {
  if (const friction::Shaker* shaker = drive.shaker()) {
    store.describe_group(group, "shaker under the contacts: displacement amplitude sin(2 pi frequency t + phase)");
    store.write(group + "/kind", std::string("shaker"), {"", "kind of drive"});
    store.write(group + "/amplitude", shaker->amplitude, {"m", "amplitude"});
    store.write(group + "/frequency", shaker->frequency_hz, {"Hz", "frequency"});
    store.write(group + "/phase", shaker->phase, {"rad", "phase at time 0"});
    return;
  }
  if (const friction::Force* force = drive.force()) return save_force(store, group, *force);
  const friction::Belt& belt = *drive.belt();
  store.describe_group(group, "belt under the contacts");
  store.write(group + "/kind", std::string("belt"), {"", "kind of drive"});
  store.write(group + "/speed", belt.speed, {"m/s", "speed at the start"});
  store.write(group + "/end_speed", belt.end_speed, {"m/s", "speed after the ramp"});
  store.write(group + "/ramp_begin", belt.ramp_begin, {"s", "start of the ramp"});
  store.write(group + "/ramp_end", belt.ramp_end, {"s", "end of the ramp; not after ramp_begin: no ramp"});
}

friction::Drive load_drive(const StoreReader& store, const std::string& group) {
  const std::string kind = store.text(group + "/kind");
  if (kind == "shaker") {
    return friction::Shaker{store.number(group + "/amplitude"), store.number(group + "/frequency"),
                            store.number(group + "/phase")};
  }
  if (kind == "force") return load_force(store, group);
  if (kind != "belt") store.fail(group + "/kind", fmt::format("'{}'; expected belt, shaker or force", kind));
  return friction::Belt{store.number(group + "/speed"), store.number(group + "/end_speed"),
                        store.number(group + "/ramp_begin"), store.number(group + "/ramp_end")};
}

}  // namespace slipmode::results
