#include "selftest/timeline.hpp"

#include <algorithm>

namespace slipmode::selftest {

using dynamics::ContactMode;

namespace {

ContactMode without_flight(ContactMode mode) {
  return mode == ContactMode::kLeftFlight || mode == ContactMode::kRightFlight ? ContactMode::kGap : mode;
}

}  // namespace

Timeline::Timeline(const dynamics::Trajectory& run, int contact) {
  const ContactMode last = without_flight(run.final_state.modes[static_cast<std::size_t>(contact)]);
  modes_.push_back(last);
  bool first = true;
  for (const dynamics::Event& e : run.events) {
    if (e.contact != contact || e.before == e.after) continue;
    const ContactMode before = without_flight(e.before), after = without_flight(e.after);
    if (first) modes_.front() = before;
    if (modes_.back() != before) broken_ = true;
    first = false;
    times_.push_back(e.time);
    modes_.push_back(after);
  }
  if (modes_.back() != last) broken_ = true;
}

ContactMode Timeline::at(double t) const {
  return modes_[static_cast<std::size_t>(std::ranges::upper_bound(times_, t) - times_.begin())];
}

}  // namespace slipmode::selftest
