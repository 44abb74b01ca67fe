#include <slipmode/orbits/periodic_orbit.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits {
namespace {

using dynamics::ContactMode;

constexpr double kClock = 4.0 * std::numeric_limits<double>::epsilon();
/// Of the time looked at: what rounding leaves between contacts that by their motion change together, as the elements
/// of a joint that turns and slides on again.
constexpr double kTogether = 1e-10;

/// True where a clearance exerts no force.
bool is_free(ContactMode mode) {
  return mode == ContactMode::kGap || mode == ContactMode::kLeftFlight || mode == ContactMode::kRightFlight;
}

std::string symbols_of(const std::vector<ContactMode>& modes) {
  std::string result;
  for (const ContactMode mode : modes) result += regime_symbol(mode);
  return result;
}

}  // namespace

char regime_symbol(ContactMode mode) {
  switch (mode) {
    case ContactMode::kSlipNegative:
      return '-';
    case ContactMode::kStick:
      return '0';
    case ContactMode::kSlipPositive:
      return '+';
    case ContactMode::kSmooth:
      return '~';
    case ContactMode::kSeparated:
      return 'x';
    case ContactMode::kGap:
    case ContactMode::kLeftFlight:
    case ContactMode::kRightFlight:
      return 'g';
    case ContactMode::kLeftStop:
      return 'l';
    case ContactMode::kRightStop:
      return 'r';
  }
  return '?';
}

std::vector<RegimeSpan> regime_sequence(double start_time, std::vector<ContactMode> modes,
                                        std::span<const dynamics::Event> events) {
  std::vector<RegimeSpan> result{{start_time, std::move(modes)}};
  for (const dynamics::Event& event : events) {
    if (event.contact < 0 || event.before == event.after) continue;
    RegimeSpan next{event.time, result.back().modes};
    next.modes[static_cast<std::size_t>(event.contact)] = event.after;
    const double apart = event.time - result.back().time;
    const double together = std::max(kClock * std::abs(event.time), kTogether * (events.back().time - start_time));
    if (apart <= together && result.size() > 1) {
      next.time = result.back().time;
      result.back() = std::move(next);
    } else {
      result.push_back(std::move(next));
    }
  }
  return result;
}

std::string word_of(std::span<const RegimeSpan> regimes) {
  std::vector<std::string> letters;
  for (const RegimeSpan& span : regimes) {
    std::string next = symbols_of(span.modes);
    if (letters.empty() || letters.back() != next) letters.push_back(std::move(next));
  }
  while (letters.size() > 1 && letters.front() == letters.back()) letters.pop_back();
  std::vector<std::string> smallest = letters;
  for (std::size_t k = 1; k < letters.size(); ++k) {
    std::rotate(letters.begin(), letters.begin() + 1, letters.end());
    smallest = std::min(smallest, letters);
  }
  std::string word;
  for (const std::string& letter : smallest) word += (word.empty() ? "" : " ") + letter;
  return word;
}

int crossings_of(std::span<const RegimeSpan> regimes) {
  int crossings = 0;
  for (std::size_t k = 0; k < regimes.size(); ++k) {
    const std::vector<ContactMode>& before = regimes[k].modes;
    const std::vector<ContactMode>& after = regimes[(k + 1) % regimes.size()].modes;
    for (std::size_t c = 0; c < before.size(); ++c)
      crossings += before[c] != after[c] && !(is_free(before[c]) && is_free(after[c])) ? 1 : 0;
  }
  return crossings;
}

std::string abridged(const std::string& word) {
  constexpr std::size_t kLongest = 80;
  return word.size() > kLongest ? word.substr(0, kLongest - 3) + "..." : word;
}

}  // namespace slipmode::orbits
