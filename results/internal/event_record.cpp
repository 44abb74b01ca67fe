#include "results/internal/event_record.hpp"

#include "results/internal/checked_read.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <limits>

namespace slipmode::results {

namespace {

constexpr std::int64_t kLastEventKind = static_cast<std::int64_t>(dynamics::EventKind::kJump);
constexpr std::int64_t kLastMode = static_cast<std::int64_t>(dynamics::ContactMode::kRightFlight);

template <class Get>
Eigen::VectorXd gather(const std::vector<dynamics::Event>& events, Get get) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(events.size()));
  std::ranges::transform(events, values.begin(), get);
  return values;
}

template <class Get>
std::vector<std::int64_t> gather_codes(const std::vector<dynamics::Event>& events, Get get) {
  std::vector<std::int64_t> values(events.size());
  std::ranges::transform(events, values.begin(),
                         [&](const auto& event) { return static_cast<std::int64_t>(get(event)); });
  return values;
}

}  // namespace

void save_events(StoreWriter& store, const std::string& group, const std::vector<dynamics::Event>& events) {
  using dynamics::Event;
  store.describe_group(group, "events in time order, one entry of each dataset per event");
  store.write(group + "/time", gather(events, [](const Event& e) { return e.time; }), {"s", "time of the event"});
  store.write(group + "/contact", gather_codes(events, [](const Event& e) { return e.contact; }),
              {"", "contact, from 0; -1 for a corner of the drive"});
  store.write(
      group + "/kind", gather_codes(events, [](const Event& e) { return e.kind; }),
      {"", "0 stick, 1 release, 2 reversal, 3 grazing, 4 drive corner, 5 contact lost, 6 contact gained, 7 jump"});
  store.write(group + "/before", gather_codes(events, [](const Event& e) { return e.before; }),
              {"", std::string("mode before: ") + kModeWords});
  store.write(group + "/after", gather_codes(events, [](const Event& e) { return e.after; }),
              {"", std::string("mode after: ") + kModeWords});
  store.write(group + "/displacement", gather(events, [](const Event& e) { return e.displacement; }),
              {"m", "contact displacement at the event"});
  store.write(group + "/velocity", gather(events, [](const Event& e) { return e.velocity; }),
              {"m/s", "contact velocity at the event"});
  store.write(group + "/force", gather(events, [](const Event& e) { return e.force; }),
              {"N", "contact force just after the event"});
}

std::vector<dynamics::Event> load_events(const StoreReader& store, const std::string& group) {
  const Eigen::VectorXd time = finite_vector(store, group + "/time");
  const Eigen::Index count = time.size();
  const auto contact = codes(store, group + "/contact", count, -1, std::numeric_limits<int>::max());
  const auto kind = codes(store, group + "/kind", count, 0, kLastEventKind);
  const auto before = codes(store, group + "/before", count, -1, kLastMode);
  const auto after = codes(store, group + "/after", count, -1, kLastMode);
  const Eigen::VectorXd displacement = finite_vector(store, group + "/displacement", count);
  const Eigen::VectorXd velocity = finite_vector(store, group + "/velocity", count);
  const Eigen::VectorXd force = finite_vector(store, group + "/force", count);
  std::vector<dynamics::Event> events(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    events[i] = {time(k),
                 static_cast<int>(contact[i]),
                 static_cast<dynamics::EventKind>(kind[i]),
                 static_cast<dynamics::ContactMode>(before[i]),
                 static_cast<dynamics::ContactMode>(after[i]),
                 displacement(k),
                 velocity(k),
                 force(k)};
  }
  return events;
}

void save_modes(StoreWriter& store, const std::string& name, const std::vector<dynamics::ContactMode>& modes,
                const std::string& what) {
  std::vector<std::int64_t> values;
  for (const dynamics::ContactMode mode : modes) values.push_back(static_cast<std::int64_t>(mode));
  store.write(name, values, {"", fmt::format("{}: {}", what, kModeWords)});
}

std::vector<dynamics::ContactMode> load_modes(const StoreReader& store, const std::string& name) {
  std::vector<dynamics::ContactMode> modes;
  for (const std::int64_t mode : codes(store, name, StoreReader::kAny, -1, kLastMode)) {
    modes.push_back(static_cast<dynamics::ContactMode>(mode));
  }
  return modes;
}

}  // namespace slipmode::results
