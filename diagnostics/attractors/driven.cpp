#include <slipmode/diagnostics/attractors/driven.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/diagnostics/attractors/periodicity.hpp>
#include <slipmode/diagnostics/model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

namespace slipmode::diagnostics {

namespace {

using dynamics::ContactMode;
using dynamics::EventKind;

bool is_whole(double value) { return std::isfinite(value) && value == std::floor(value); }

double period_of(const dynamics::HybridSystem& system) {
  if (const std::optional<double> period = system.drive().period()) return *period;
  throw InvalidInput("driven motion: expected a shaker or a force, found a belt; belts are for settle()");
}

void check(const dynamics::HybridSystem& system, const Readings& readings, const DrivenOptions& options) {
  if (!is_whole(options.cycles) || !is_whole(options.kept) || !(options.kept >= 1.0) ||
      !(options.cycles > options.kept)) {
    throw InvalidInput(
        fmt::format("driven motion: expected whole numbers of cycles, 1 <= kept < cycles, found {} of "
                    "{} kept",
                    options.kept, options.cycles));
  }
  if (options.samples < 1 || !(options.micro_stick >= 0.0) || !(options.exponent_cycles >= 0.0)) {
    throw InvalidInput(
        fmt::format("driven motion: expected samples >= 1, micro_stick >= 0 and exponent_cycles >= 0, found {}, {}, {}",
                    options.samples, options.micro_stick, options.exponent_cycles));
  }
  const Eigen::Index m = readings.rows.rows();
  if ((m > 0 && readings.rows.cols() != system.size()) ||
      (readings.offset.size() != 0 && readings.offset.size() != m)) {
    throw InvalidInput(
        fmt::format("driven motion: expected readings of {} degrees of freedom, one offset each, found "
                    "{} x {} and {} offsets",
                    system.size(), m, readings.rows.cols(), readings.offset.size()));
  }
}

/// What one contact did from `begin` to `end`, told by its events.
class ContactHistory {
 public:
  ContactHistory(double begin, ContactMode mode) : since_(begin), mode_(mode) {}

  void turn(const dynamics::Event& event) {
    if (event.kind == EventKind::kJump) {
      ++jumps_;
      slides_ = true;
    }
    if (event.kind == EventKind::kSeparation) ++separations_;
    if (event.after == mode_) return;
    close(event.time);
    mode_ = event.after;
    since_ = event.time;
  }
  void close(double time) {
    if (mode_ == ContactMode::kStick) {
      stuck_ += time - since_;
      longest_ = std::max(longest_, time - since_);
    } else if (time > since_) {
      slides_ = true;
    }
    since_ = time;
  }

  [[nodiscard]] double stuck() const { return stuck_; }
  [[nodiscard]] double longest() const { return longest_; }
  [[nodiscard]] bool slides() const { return slides_; }
  [[nodiscard]] std::int64_t jumps() const { return jumps_; }
  [[nodiscard]] std::int64_t separations() const { return separations_; }

 private:
  double since_;
  ContactMode mode_;
  double stuck_ = 0.0, longest_ = 0.0;
  bool slides_ = false;
  std::int64_t jumps_ = 0, separations_ = 0;
};

/// The mode each contact had when its first event came, or has kept to the end.
std::vector<ContactMode> first_modes(const dynamics::Trajectory& run) {
  std::vector<ContactMode> modes = run.final_state.modes;
  for (auto event = run.events.rbegin(); event != run.events.rend(); ++event) {
    if (event->contact >= 0) modes[static_cast<std::size_t>(event->contact)] = event->before;
  }
  return modes;
}

/// Stops are met and left: that is no stick, no slip and no loss of a contact.
void judge_contacts(const dynamics::HybridSystem& system, const dynamics::Trajectory& run, double begin, double end,
                    double T, double micro_stick, DrivenMotion& out) {
  std::vector<ContactHistory> histories;
  for (const ContactMode mode : first_modes(run)) histories.emplace_back(begin, mode);
  for (const dynamics::Event& event : run.events) {
    if (event.contact >= 0) histories[static_cast<std::size_t>(event.contact)].turn(event);
  }
  bool rubs = false, slides = false;
  std::vector<double> stick_time;
  for (std::size_t c = 0; c < histories.size(); ++c) {
    ContactHistory& history = histories[c];
    history.close(end);
    stick_time.push_back(history.stuck());
    if (friction::clearance(system.contacts()[c].law) != nullptr) continue;
    rubs = true;
    slides = slides || history.slides();
    out.longest_stick = std::max(out.longest_stick, history.longest() / T);
    out.jumps += history.jumps();
    out.separations += history.separations();
  }
  out.stick_fraction = stick_share(system, stick_time, end - begin);
  out.label = !rubs                              ? DrivenLabel::kNoFriction
              : !slides                          ? DrivenLabel::kStick
              : out.longest_stick <= micro_stick ? DrivenLabel::kSlip
                                                 : DrivenLabel::kStickSlip;
}

/// Every `step`-th column, `count` of them.
Eigen::MatrixXd every(const Eigen::MatrixXd& samples, Eigen::Index step, Eigen::Index count) {
  return samples(Eigen::all, Eigen::seqN(0, count, step));
}

/// Largest less smallest value of each row.
Eigen::VectorXd reach(const Eigen::MatrixXd& samples) {
  return samples.rowwise().maxCoeff() - samples.rowwise().minCoeff();
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& c) {
  Eigen::MatrixXd all(a.rows() + b.rows() + c.rows(), a.cols());
  all << a, b, c;
  return all;
}

/// Largest difference of columns p apart among columns [first, last], relative to the scale of each row.
double mismatch(const Eigen::MatrixXd& points, const Eigen::VectorXd& scale, Eigen::Index p, Eigen::Index first,
                Eigen::Index last) {
  double largest = 0.0;
  for (Eigen::Index k = std::max(first, p); k <= last; ++k) {
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (scale(i) > 0.0) largest = std::max(largest, std::abs(points(i, k) - points(i, k - p)) / scale(i));
    }
  }
  return largest;
}

/// True where nothing happened at any contact, every law is linear in between, and something damps: what is not the
/// drive's own dies out.
bool is_damped_and_linear(const dynamics::HybridSystem& system, const dynamics::Trajectory& run) {
  const bool damped = std::visit([](const auto& C) { return C.norm() > 0.0; }, system.structure().C());
  return damped && run.events.empty() && std::ranges::all_of(system.contacts(), [](const friction::Contact& contact) {
           return friction::is_piecewise_linear(contact.law);
         });
}

/// The period such a motion is on its way to, whatever beats with it: the drive's. Undecided unless it draws nearer.
DrivenPeriod linear_period(const Eigen::MatrixXd& points, const Eigen::VectorXd& scale) {
  const Eigen::Index last = points.cols() - 1, half = last / 2;
  const double early = mismatch(points, scale, 1, 1, half), late = mismatch(points, scale, 1, half + 1, last);
  if (half < 1 || !(late < early)) return {.mismatch = std::numeric_limits<double>::quiet_NaN()};
  return {DrivenRepeat::kSettling, 1, late};
}

bool settles_by(const Eigen::MatrixXd& points, const Eigen::VectorXd& scale, Eigen::Index p) {
  return is_settling(static_cast<std::size_t>(points.cols() - p), static_cast<std::size_t>(p), [&](std::size_t k) {
    const Eigen::Index later = static_cast<Eigen::Index>(k) + p;
    return mismatch(points, scale, p, later, later);
  });
}

}  // namespace

const char* to_string(DrivenLabel label) {
  switch (label) {
    case DrivenLabel::kStick:
      return "stick";
    case DrivenLabel::kStickSlip:
      return "stick-slip";
    case DrivenLabel::kSlip:
      return "slip";
    case DrivenLabel::kNoFriction:
      return "no friction";
  }
  return "";
}

const char* to_string(DrivenRepeat repeat) {
  switch (repeat) {
    case DrivenRepeat::kPeriodic:
      return "periodic";
    case DrivenRepeat::kSettling:
      return "settling";
    case DrivenRepeat::kAperiodic:
      return "aperiodic";
    case DrivenRepeat::kUndecided:
      return "undecided";
  }
  return "";
}

Eigen::MatrixXd Readings::of(const Eigen::MatrixXd& q) const {
  if (rows.rows() == 0) return Eigen::MatrixXd(0, q.cols());
  Eigen::MatrixXd values = rows * q;
  if (offset.size() > 0) values.colwise() += offset;
  return values;
}

DrivenPeriod driven_period(const Eigen::MatrixXd& points, const Eigen::VectorXd& scale, double tolerance,
                           int max_period) {
  constexpr Eigen::Index kRepeats = 3, kFewest = 20;
  // In tolerances: so near to repeating, a slow decay that beats is as likely as no period.
  constexpr double kNearly = 100.0;
  if (!(tolerance > 0.0) || max_period < 1 || scale.size() != points.rows()) {
    throw InvalidInput(
        fmt::format("period of sections: expected tolerance > 0, max_period >= 1 and {} scales, found "
                    "{}, {} and {}",
                    points.rows(), tolerance, max_period, scale.size()));
  }
  const Eigen::Index last = points.cols() - 1;
  DrivenPeriod settling{.mismatch = std::numeric_limits<double>::quiet_NaN()};
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index p = 1; p <= max_period; ++p) {
    const Eigen::Index compared = std::max(kRepeats * p, kFewest);
    if (last + 1 < compared + p) break;
    const double late = mismatch(points, scale, p, last + 1 - compared, last);
    if (late <= tolerance) return {DrivenRepeat::kPeriodic, static_cast<int>(p), late};
    nearest = std::min(nearest, late);
    if (settling.period == 0 && settles_by(points, scale, p)) {
      settling = {DrivenRepeat::kSettling, static_cast<int>(p), late};
    }
  }
  if (settling.period > 0) return settling;
  if (nearest < kNearly * tolerance)
    settling.mismatch = nearest;
  else if (std::isfinite(nearest))
    settling.repeat = DrivenRepeat::kAperiodic;
  return settling;
}

dynamics::State at_first_section(const dynamics::HybridSystem& system, const dynamics::State& start) {
  const double first = system.drive().section_time();
  if (start.time > 0.0) return dynamics::handed_on(system, start, first);
  if (first == 0.0) return start;
  return dynamics::simulate(system, start, {.duration = first, .keep_events = false}).final_state;
}

DrivenMotion settle_driven(const dynamics::HybridSystem& system, const Readings& readings, const dynamics::State& start,
                           const DrivenOptions& options) {
  check(system, readings, options);
  const double T = period_of(system);
  const dynamics::State begin = at_first_section(system, start);
  const double transient = (options.cycles - options.kept) * T, duration = options.cycles * T;
  const dynamics::Trajectory run = dynamics::simulate(system, begin,
                                                      {.duration = duration,
                                                       .transient = transient,
                                                       .sample = T / static_cast<double>(options.samples),
                                                       .flow = options.flow});

  DrivenMotion out{.frequency_hz = system.drive().frequency_hz()};
  const auto step = static_cast<Eigen::Index>(options.samples), kept = static_cast<Eigen::Index>(options.kept);
  const Eigen::Index count = kept * step;  // the last instant, where the next period begins, is left out
  const auto q = run.q.leftCols(count), v = run.v.leftCols(count);
  const Eigen::MatrixXd values = readings.of(q);
  out.readings = every(values, step, kept);
  out.contact_q = every(run.contact_q, step, kept);
  out.contact_v = every(run.contact_v, step, kept);
  out.mean = values.rowwise().mean();
  out.rms = (values.colwise() - out.mean).rowwise().norm() / std::sqrt(static_cast<double>(count));
  const Eigen::MatrixXd points = stacked(out.readings, out.contact_q, out.contact_v);
  const Eigen::VectorXd scale = reach(stacked(values, run.contact_q.leftCols(count), run.contact_v.leftCols(count)));
  const bool linear = is_damped_and_linear(system, run);
  out.period = driven_period(points, scale, options.tolerance, linear ? 1 : options.max_period);
  if (linear && out.period.repeat != DrivenRepeat::kPeriodic) out.period = linear_period(points, scale);
  judge_contacts(system, run, begin.time + transient, begin.time + duration, T, options.micro_stick, out);
  out.events = run.statistics.events;
  out.mean_energy = mean_energy(system, q, v);
  out.audit_residual = options.flow.audit ? run.audit.residual() : std::numeric_limits<double>::quiet_NaN();
  out.end = run.final_state;
  if (options.exponent_cycles >= 1.0) {
    out.exponent = largest_exponent(system, out.end,
                                    {.transient = 0.0,
                                     .duration = std::floor(options.exponent_cycles) * T,
                                     .interval = T,
                                     .flow = options.flow,
                                     .stop = options.stop});
    if (out.exponent->is_positive() && out.period.repeat != DrivenRepeat::kPeriodic)
      out.period = {.repeat = DrivenRepeat::kAperiodic};
  }
  return out;
}

}  // namespace slipmode::diagnostics
