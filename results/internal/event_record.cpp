#include "results/internal/event_record.hpp"

#include "results/internal/field_record.hpp"

#include <fmt/format.h>

namespace slipmode {

constexpr Limits kEventKinds{.low = 0.0, .high = static_cast<double>(dynamics::EventKind::kJump)};
constexpr Limits kContactModes{.low = -1.0, .high = static_cast<double>(dynamics::ContactMode::kRightFlight)};

template <>
inline constexpr auto kFields<dynamics::Event> = std::tuple{
    required("time", &dynamics::Event::time, "s", "time of the event"),
    required("contact", &dynamics::Event::contact, "", "contact, from 0; -1 for a corner of the drive", {.low = -1.0}),
    required("kind", &dynamics::Event::kind, "", "", kEventKinds),
    required("before", &dynamics::Event::before, "", "mode before", kContactModes),
    required("after", &dynamics::Event::after, "", "mode after", kContactModes),
    required("displacement", &dynamics::Event::displacement, "m", "contact displacement at the event"),
    required("velocity", &dynamics::Event::velocity, "m/s", "contact velocity at the event"),
    required("force", &dynamics::Event::force, "N", "contact force just after the event")};

}  // namespace slipmode

namespace slipmode::results {

template <>
inline constexpr const char* kCodes<dynamics::ContactMode> =
    "-1 slip-, 0 stick, 1 slip+, 2 smooth, 3 contact lost, 4 gap, 5 left stop, 6 right stop, 7 and 8 in flight beyond "
    "the left and the right stop";
template <>
inline constexpr const char* kCodes<dynamics::EventKind> =
    "0 stick, 1 release, 2 reversal, 3 grazing, 4 drive corner, 5 contact lost, 6 contact gained, 7 jump";

void save_events(StoreWriter& store, const std::string& group, const std::vector<dynamics::Event>& events) {
  store.describe_group(group, "events in time order, one entry of each dataset per event");
  save_rows(store, group, events);
}

std::vector<dynamics::Event> load_events(const StoreReader& store, const std::string& group) {
  return load_rows<dynamics::Event>(store, group);
}

void save_modes(StoreWriter& store, const std::string& name, const std::vector<dynamics::ContactMode>& modes,
                const std::string& what) {
  std::vector<std::int64_t> values;
  for (const dynamics::ContactMode mode : modes) values.push_back(static_cast<std::int64_t>(mode));
  store.write(name, values, {"", fmt::format("{}: {}", what, kCodes<dynamics::ContactMode>)});
}

std::vector<dynamics::ContactMode> load_modes(const StoreReader& store, const std::string& name) {
  std::vector<dynamics::ContactMode> modes;
  for (const std::int64_t mode :
       codes(store, name, StoreReader::kAny, -1, static_cast<std::int64_t>(kContactModes.high))) {
    modes.push_back(static_cast<dynamics::ContactMode>(mode));
  }
  return modes;
}

}  // namespace slipmode::results
