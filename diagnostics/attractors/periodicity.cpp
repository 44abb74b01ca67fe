#include <slipmode/diagnostics/attractors/periodicity.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace slipmode::diagnostics {

namespace {

void check(std::span<const SlipState> slips, const PeriodOptions& options, const Eigen::MatrixXd* states) {
  if (!(options.tolerance > 0.0) || options.max_period < 1 || options.repeats < 1 || options.min_matches < 1) {
    throw InvalidInput(
        fmt::format("period detection: expected tolerance > 0, max_period, repeats and min_matches >= 1, found {}, {}, "
                    "{}, {}",
                    options.tolerance, options.max_period, options.repeats, options.min_matches));
  }
  for (std::size_t i = 0; i < slips.size(); ++i) {
    if (slips[i].contact < 0) throw InvalidInput(fmt::format("period detection: slip {} has a negative contact", i));
    if (i > 0 && slips[i].time < slips[i - 1].time) {
      throw InvalidInput(fmt::format("period detection: expected slips in time order, found {} at {} after {} at {}", i,
                                     slips[i].time, i - 1, slips[i - 1].time));
    }
  }
  if (states != nullptr && states->cols() != static_cast<Eigen::Index>(slips.size())) {
    throw InvalidInput(fmt::format("period detection: expected one state column per slip ({}), found {}", slips.size(),
                                   states->cols()));
  }
}

/// The slips sorted by contact, with what is needed to compare two of them.
class SlipHistory {
 public:
  SlipHistory(std::span<const SlipState> slips, const PeriodOptions& options, const Eigen::MatrixXd* states)
      : slips_(slips), options_(options), states_(states) {
    int contacts = 0;
    for (const SlipState& slip : slips) contacts = std::max(contacts, slip.contact + 1);
    by_contact_.resize(static_cast<std::size_t>(contacts));
    for (std::size_t i = 0; i < slips.size(); ++i) {
      by_contact_[static_cast<std::size_t>(slips[i].contact)].push_back(i);
    }
    for (std::size_t c = 0; c < by_contact_.size(); ++c) scale_.push_back(scale_of(c));
    if (states_ != nullptr && states_->cols() > 0) {
      const Eigen::VectorXd mean = states_->rowwise().mean();
      state_scale_ = std::sqrt((states_->colwise() - mean).colwise().squaredNorm().maxCoeff());
      if (state_scale_ == 0.0) state_scale_ = std::max(mean.norm(), 1e-300);
    }
  }

  [[nodiscard]] int section() const {
    std::size_t most = 0;
    int section = -1;
    for (std::size_t c = 0; c < by_contact_.size(); ++c) {
      if (by_contact_[c].size() <= most) continue;
      most = by_contact_[c].size();
      section = static_cast<int>(c);
    }
    return section;
  }

  [[nodiscard]] const std::vector<std::size_t>& of(int contact) const {
    return by_contact_[static_cast<std::size_t>(contact)];
  }

  [[nodiscard]] int contacts() const { return static_cast<int>(by_contact_.size()); }

  [[nodiscard]] const SlipState& slip(std::size_t i) const { return slips_[i]; }

  /// Relative difference of two slips of one contact: displacement, and the state if there is one.
  [[nodiscard]] double difference(std::size_t i, std::size_t j) const {
    const auto contact = static_cast<std::size_t>(slips_[i].contact);
    double worst = std::abs(slips_[i].displacement - slips_[j].displacement) / scale_[contact];
    if (states_ != nullptr) {
      const auto a = static_cast<Eigen::Index>(i);
      const auto b = static_cast<Eigen::Index>(j);
      worst = std::max(worst, (states_->col(a) - states_->col(b)).norm() / state_scale_);
    }
    return worst;
  }

  /// The mismatch when every slip of `contact` later than `begin` has a partner one T before, else nothing.
  [[nodiscard]] std::optional<double> partners(int contact, double begin, double T, double tolerance) const {
    const std::vector<std::size_t>& mine = of(contact);
    double worst = 0.0;
    for (auto late = mine.rbegin(); late != mine.rend() && slip(*late).time > begin; ++late) {
      const double wanted = slip(*late).time - T;
      const auto after =
          std::lower_bound(mine.begin(), mine.end(), wanted, [&](std::size_t i, double t) { return slip(i).time < t; });
      double best = std::numeric_limits<double>::infinity();
      for (auto near = after == mine.begin() ? after : std::prev(after); near != mine.end() && near <= after; ++near) {
        best = std::min(best, std::max(std::abs(slip(*near).time - wanted) / T, difference(*late, *near)));
      }
      if (!(best <= tolerance)) return std::nullopt;
      worst = std::max(worst, best);
    }
    return worst;
  }

  /// Whether a contact's slips approach a period.
  [[nodiscard]] bool is_settling(int contact) const {
    const std::vector<std::size_t>& mine = of(contact);
    for (std::size_t p = 1; p <= static_cast<std::size_t>(options_.max_period) && p < mine.size(); ++p) {
      const auto apart = [&](std::size_t k) { return difference(mine[k + p], mine[k]); };
      if (diagnostics::is_settling(mine.size() - p, p, apart)) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] double scale_of(std::size_t contact) const {
    if (contact < options_.scale.size() && options_.scale[contact] > 0.0) return options_.scale[contact];
    double low = 0.0;
    double high = 0.0;
    for (std::size_t k = 0; k < by_contact_[contact].size(); ++k) {
      const double x = slips_[by_contact_[contact][k]].displacement;
      low = k == 0 ? x : std::min(low, x);
      high = k == 0 ? x : std::max(high, x);
    }
    const double size = std::max(std::abs(low), std::abs(high));
    // Slip states all equal to a few digits are period 1: their tiny range would turn rounding into differences.
    const double scale = high - low > 1e-3 * size ? high - low : size;
    return scale > 0.0 ? scale : 1.0;
  }

  std::span<const SlipState> slips_;
  const PeriodOptions& options_;
  const Eigen::MatrixXd* states_;
  std::vector<std::vector<std::size_t>> by_contact_;
  std::vector<double> scale_;
  double state_scale_ = 1.0;
};

/// How many of the last slips must match their predecessors p slips before.
int matches_needed(const SlipHistory& history, const std::vector<std::size_t>& mine, int p,
                   const PeriodOptions& options) {
  const auto seen = static_cast<int>(mine.size());
  int matches = options.repeats * p;
  while (matches < options.min_matches) {
    const int first = seen - matches - p;
    if (options.long_stretch > 0.0 && first >= 0 &&
        history.slip(mine.back()).time - history.slip(mine[static_cast<std::size_t>(first)]).time >=
            options.long_stretch) {
      break;
    }
    ++matches;
  }
  return matches;
}

/// Largest relative difference, and mean time apart, of the last slips of a contact and those p before.
struct Shift {
  double mismatch = 0.0;
  double T = 0.0;
};

Shift compare_shift(const SlipHistory& history, const std::vector<std::size_t>& mine, int p, int matches) {
  const std::size_t n = mine.size();
  const auto shift = static_cast<std::size_t>(p);
  const std::size_t begin = n - static_cast<std::size_t>(matches);
  const auto lag = [&](std::size_t k) { return history.slip(mine[k]).time - history.slip(mine[k - shift]).time; };
  Shift result;
  for (std::size_t k = begin; k < n; ++k) {
    result.mismatch = std::max(result.mismatch, history.difference(mine[k], mine[k - shift]));
    result.T += lag(k) / matches;
  }
  if (!(result.T > 0.0)) return {.mismatch = std::numeric_limits<double>::infinity()};
  for (std::size_t k = begin; k < n; ++k) {
    result.mismatch = std::max(result.mismatch, std::abs(lag(k) - result.T) / result.T);
  }
  return result;
}

/// True when the last slip of contact `section` differs from the one p before: the usual end of a trial.
bool differs_at_once(const SlipHistory& history, const std::vector<std::size_t>& mine, int p, double tolerance) {
  return history.difference(mine.back(), mine[mine.size() - 1 - static_cast<std::size_t>(p)]) > tolerance;
}

/// The result for shift p of the section contact if all contacts repeat within `tolerance`, else nothing.
std::optional<PeriodResult> try_period(const SlipHistory& history, int section, int p, int matches, double tolerance) {
  const std::vector<std::size_t>& mine = history.of(section);
  if (differs_at_once(history, mine, p, tolerance)) return std::nullopt;
  const Shift shift = compare_shift(history, mine, p, matches);
  if (!(shift.mismatch <= tolerance)) return std::nullopt;
  PeriodResult result{
      .motion = Motion::kPeriodic, .period = p, .T = shift.T, .contact = section, .mismatch = shift.mismatch};
  const std::size_t first = mine[mine.size() - static_cast<std::size_t>(matches)];
  const double begin = history.slip(first).time - 0.5 * shift.T;
  for (int c = 0; c < history.contacts(); ++c) {
    if (c == section) continue;
    const std::optional<double> mismatch = history.partners(c, begin, shift.T, tolerance);
    if (!mismatch) return std::nullopt;
    result.mismatch = std::max(result.mismatch, *mismatch);
  }
  return result;
}

/// `found`, or the smallest of its divisors that is not clearly worse.
PeriodResult prefer_divisor(const SlipHistory& history, const PeriodResult& found, int matches,
                            const PeriodOptions& options) {
  constexpr double kNear = 100.0;
  constexpr double kClearlyWorse = 10.0;
  PeriodResult best = found;
  for (int q = found.period - 1; q >= 1; --q) {
    if (found.period % q != 0) continue;
    std::optional<PeriodResult> divisor = try_period(history, found.contact, q, matches, kNear * options.tolerance);
    if (!divisor) continue;
    const double doubt = found.mismatch / divisor->mismatch;
    best.doubt = std::max(best.doubt, doubt);
    if (doubt * kClearlyWorse < 1.0) continue;
    divisor->doubt = best.doubt;
    best = *divisor;
  }
  return best;
}

}  // namespace

std::vector<SlipState> slip_states(std::span<const dynamics::Event> events) {
  std::vector<SlipState> slips;
  for (const dynamics::Event& event : events) {
    if (event.kind != dynamics::EventKind::kRelease) continue;
    slips.push_back({.time = event.time, .contact = event.contact, .displacement = event.displacement});
  }
  return slips;
}

const char* to_string(Motion motion) {
  switch (motion) {
    case Motion::kPeriodic:
      return "periodic";
    case Motion::kAperiodic:
      return "aperiodic";
    case Motion::kUndecided:
      return "undecided";
    case Motion::kSticking:
      return "sticking";
    case Motion::kSliding:
      return "sliding";
  }
  return "undecided";
}

bool is_settling(std::size_t count, std::size_t p, const std::function<double(std::size_t)>& difference) {
  constexpr std::size_t kParts = 8;
  constexpr double kLeast = 0.9, kNear = 0.1;
  const std::size_t length = count / kParts;
  if (length < std::max<std::size_t>(p, 1)) return false;
  double last = 0.0, later = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {  // backwards: most motions fail at once
    double here = 0.0;
    for (std::size_t k = 1; k <= length; ++k) here = std::max(here, difference(count - part * length - k));
    if (part == 0 ? here > kNear : here <= later) return false;
    if (part == 0) last = here;
    later = here;
  }
  return last < kLeast * later;
}

PeriodResult detect_period(std::span<const SlipState> slips, const PeriodOptions& options,
                           const Eigen::MatrixXd* states) {
  check(slips, options, states);
  const SlipHistory history(slips, options, states);
  const int section = history.section();
  PeriodResult result{.motion = Motion::kUndecided, .contact = section};
  if (section < 0) return result;

  const auto seen = static_cast<int>(history.of(section).size());
  for (int p = 1; p <= options.max_period; ++p) {
    const int matches = matches_needed(history, history.of(section), p, options);
    if (seen < p + matches) return result;
    const std::optional<PeriodResult> found = try_period(history, section, p, matches, options.tolerance);
    if (found) return prefer_divisor(history, *found, matches, options);
  }
  result.motion = history.is_settling(section) ? Motion::kUndecided : Motion::kAperiodic;
  return result;
}

}  // namespace slipmode::diagnostics
