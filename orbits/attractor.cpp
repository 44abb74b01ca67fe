#include <slipmode/orbits/attractor.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits {

namespace {

bool is_stopped(const AttractorOptions& options) {
  return options.stop != nullptr && options.stop->load(std::memory_order_relaxed);
}

void check(const dynamics::HybridSystem& system, const Section& section, const AttractorOptions& options) {
  if (!(options.transient >= 0.0) || !(options.duration > 0.0) || !(options.sample > 0.0) ||
      options.sample > options.duration) {
    throw InvalidInput(
        fmt::format("attractor: expected transient >= 0, duration > 0, 0 < sample <= duration, found {}, {}, {}",
                    options.transient, options.duration, options.sample));
  }
  if (section.is_stroboscopic() && !system.drive().period()) {
    throw InvalidInput(
        "attractor: expected a drive with a period for a stroboscopic section, found a belt. Choose the "
        "events of a contact");
  }
  if (section.contact >= static_cast<int>(system.contacts().size())) {
    throw InvalidInput(fmt::format("attractor: expected a section contact below {}, found {}", system.contacts().size(),
                                   section.contact));
  }
  if (options.basis && options.basis->modes() != system.size()) {
    throw InvalidInput(fmt::format("attractor: expected a basis of {} vectors, the size of the model, found {}",
                                   system.size(), options.basis->modes()));
  }
}

/// One run, cut at the events of a contact.
void record_events(const dynamics::HybridSystem& system, const dynamics::State& start, const AttractorOptions& options,
                   Attractor& out_attractor) {
  const Section section = out_attractor.section;
  const double begin = start.time + options.transient;
  dynamics::SimulateOptions run{.duration = options.transient + options.duration,
                                .transient = options.transient,
                                .sample = options.sample,
                                .keep_events = false,
                                .flow = options.flow};
  run.on_event = [&](const dynamics::Event& event, const dynamics::State& state) {
    if (event.time >= begin && event.contact == section.contact && event.kind == section.event) {
      out_attractor.passages.push_back(state);
    }
    return !is_stopped(options);
  };
  const dynamics::Trajectory motion = dynamics::simulate(system, start, run);
  if (is_stopped(options)) throw Interrupted();
  out_attractor.samples = points_of(motion.q, motion.v, options.basis);
}

/// Period after period of the drive.
void record_periods(const dynamics::HybridSystem& system, const dynamics::State& start, const AttractorOptions& options,
                    Attractor& out_attractor) {
  const double period = system.drive().period().value();
  out_attractor.period = period;
  const auto dropped = static_cast<Eigen::Index>(std::ceil(options.transient / period - 1e-9));
  const auto kept = static_cast<Eigen::Index>(std::max(1.0, std::floor(options.duration / period + 1e-9)));
  // A whole number of samples per period keeps them equally spaced over the whole record.
  const auto per_period = static_cast<Eigen::Index>(std::max(1.0, std::round(period / options.sample)));
  dynamics::SimulateOptions run{.duration = period, .keep_events = false, .flow = options.flow};
  dynamics::State state = start;
  for (Eigen::Index k = -dropped; k < kept; ++k) {
    if (is_stopped(options)) throw Interrupted();
    run.sample = k < 0 ? 0.0 : period / static_cast<double>(per_period);
    const dynamics::Trajectory motion = dynamics::simulate(system, state, run);
    if (k >= 0) {
      out_attractor.passages.push_back(state);
      const Eigen::MatrixXd part =
          points_of(motion.q.leftCols(per_period), motion.v.leftCols(per_period), options.basis);
      if (k == 0) out_attractor.samples.resize(part.rows(), kept * per_period);
      out_attractor.samples.middleCols(k * per_period, per_period) = part;
    }
    state = motion.final_state;
    state.time = start.time;
  }
}

}  // namespace

Section default_section(const dynamics::HybridSystem& system) {
  if (system.drive().period()) return Section::stroboscopic();
  const std::vector<friction::Contact>& contacts = system.contacts();
  const auto sticks = [](const friction::Contact& one) { return friction::sticks(friction::kind(one.law)); };
  const auto first = std::ranges::find_if(contacts, sticks);
  if (first == contacts.end()) return {.event = dynamics::EventKind::kReversal};
  return {.contact = static_cast<int>(first - contacts.begin())};
}

Metric Metric::of(const Eigen::MatrixXd& samples) {
  if (samples.cols() < 1) throw InvalidInput("metric: expected at least one sample, found none");
  Metric metric{.mean = samples.rowwise().mean(), .rms = {}};
  metric.rms = (samples.colwise() - metric.mean).rowwise().norm() / std::sqrt(static_cast<double>(samples.cols()));
  return metric;
}

Eigen::MatrixXd Metric::scaled(const Eigen::MatrixXd& points) const {
  if (points.rows() != mean.size()) {
    throw InvalidInput(fmt::format("metric: expected points of size {}, found {}", mean.size(), points.rows()));
  }
  // What rounding leaves of a coordinate at rest must not count as motion.
  const Eigen::VectorXd floor = (1e-12 * mean.cwiseAbs()).array().max(1e-12 * rms.maxCoeff());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(rms.size());
  for (Eigen::Index i = 0; i < rms.size(); ++i) {
    if (rms(i) > floor(i)) weight(i) = 1.0 / (rms(i) * std::sqrt(static_cast<double>(rms.size())));
  }
  return weight.asDiagonal() * (points.colwise() - mean);
}

Eigen::MatrixXd points_of(const std::vector<dynamics::State>& states, const std::optional<pod::Basis>& basis) {
  if (states.empty()) return {};
  const auto count = static_cast<Eigen::Index>(states.size());
  Eigen::MatrixXd q(states.front().q.size(), count), v(states.front().q.size(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    q.col(k) = states[static_cast<std::size_t>(k)].q;
    v.col(k) = states[static_cast<std::size_t>(k)].v;
  }
  return points_of(q, v, basis);
}

Eigen::MatrixXd points_of(const Eigen::MatrixXd& q, const Eigen::MatrixXd& v, const std::optional<pod::Basis>& basis) {
  Eigen::MatrixXd points(2 * (basis ? basis->vectors.rows() : q.rows()), q.cols());
  if (!basis) {
    points << q, v;
    return points;
  }
  points << basis->vectors * q, basis->vectors * v;
  if (basis->mean.size() > 0) points.topRows(basis->mean.size()).colwise() += basis->mean;
  return points;
}

Attractor record_attractor(const dynamics::HybridSystem& system, const dynamics::State& start,
                           const AttractorOptions& options) {
  Attractor attractor{.section = options.section.value_or(default_section(system)), .basis = options.basis};
  check(system, attractor.section, options);
  if (attractor.section.is_stroboscopic()) {
    record_periods(system, start, options, attractor);
  } else {
    record_events(system, start, options, attractor);
  }
  if (attractor.passages.size() < 2) {
    throw NumericalFailure(fmt::format("attractor: expected at least two passages of the section in {} time units, "
                                       "found {}. Record longer, or choose a contact that sticks",
                                       options.duration, attractor.passages.size()),
                           start.time, start.q, std::numeric_limits<double>::quiet_NaN());
  }
  attractor.points = points_of(attractor.passages, attractor.basis);
  attractor.metric = options.metric.value_or(Metric::of(attractor.samples));
  return attractor;
}

}  // namespace slipmode::orbits
