#include "trade/internal/motion.hpp"

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/to_vector.hpp>
#include <slipmode/diagnostics/model.hpp>
#include <slipmode/diagnostics/series/point_sets.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::trade {

namespace {

/// Numbers a piece of a record may hold.
constexpr double kPiece = 2e6;

bool tells_stick(const dynamics::HybridSystem& system) {
  return std::ranges::any_of(system.contacts(), [](const friction::Contact& contact) {
    return friction::sticks(friction::kind(contact.law));
  });
}

dynamics::Trajectory run(const Case& model, const dynamics::State& start, dynamics::SimulateOptions options,
                         const StopFlag* stop) {
  options.flow = model.flow;
  if (stop != nullptr) options.on_event = [stop](const auto&, const auto&) { return !stop->load(); };
  dynamics::Trajectory done = dynamics::simulate(model.model.system, start, options);
  if (stop != nullptr && stop->load()) throw Interrupted();
  return done;
}

/// A record gathered piece by piece.
class Gathered {
 public:
  Gathered(const Case& model, const Schedule& schedule)
      : model_(model), schedule_(schedule), sum_(Eigen::VectorXd::Zero(model.model.system.size())) {}

  /// @param columns  samples of the piece; one more, at its end, begins the next
  void add(const dynamics::Trajectory& piece, Eigen::Index columns) {
    const auto q = piece.q.leftCols(columns), v = piece.v.leftCols(columns);
    const fem::Structure& structure = model_.model.system.structure();
    kinetic_ += 0.5 * v.cwiseProduct(fem::multiply(structure.M(), v)).sum();
    strain_ += 0.5 * q.cwiseProduct(fem::multiply(structure.K(), q)).sum();
    sum_ += q.rowwise().sum();
    stuck_ += stick_share(model_.model.system, piece.statistics.stick_time, 1.0);
    out_.events += piece.statistics.events;
    add_points(piece, model_.model.readings.of(q));
    count_ += columns;
  }

  [[nodiscard]] Motion take(dynamics::State end) {
    const auto count = static_cast<double>(count_);
    const Eigen::VectorXd mean = sum_ / count;
    const double about = 0.5 * mean.dot(fem::multiply(model_.model.system.structure().K(), mean).col(0));
    out_.energy = (kinetic_ + strain_) / count - about;
    out_.stick = tells_stick(model_.model.system) ? stuck_ / (schedule_.sample * count) : kNone;
    out_.end = std::move(end);
    return std::move(out_);
  }

 private:
  void add_points(const dynamics::Trajectory& piece, const Eigen::MatrixXd& readings) {
    out_.readings.insert(out_.readings.end(), readings.data(), readings.data() + readings.size());
    if (schedule_.per_section > 0) {
      for (Eigen::Index k = 0; k < readings.cols(); k += schedule_.per_section) out_.points.push_back(readings(0, k));
      return;
    }
    for (const dynamics::Event& event : piece.events) {
      if (event.kind == dynamics::EventKind::kRelease && event.contact == 0) out_.points.push_back(event.displacement);
    }
  }

  const Case& model_;
  const Schedule& schedule_;
  Eigen::VectorXd sum_;
  double kinetic_ = 0.0, strain_ = 0.0, stuck_ = 0.0;
  Eigen::Index count_ = 0;
  Motion out_;
};

double rms(const std::vector<double>& values) {
  const Eigen::ArrayXd all = to_vector(values).array();
  return std::sqrt((all - all.mean()).square().mean());
}

/// Of the reading's rms [%].
double distance(const std::vector<double>& a, const std::vector<double>& b, double scale) {
  if (a.empty() || b.empty() || !(scale > 0.0)) return kNone;
  return 100.0 * diagnostics::wasserstein(a, b) / scale;
}

constexpr Eigen::Index kQuantiles = 400;

/// Of a set, at the middles of equal shares; of NaN where there is none.
Eigen::VectorXd quantiles(std::vector<double> values) {
  if (values.empty()) return Eigen::VectorXd::Constant(kQuantiles, kNone);
  std::ranges::sort(values);
  return Eigen::VectorXd::NullaryExpr(kQuantiles, [&](Eigen::Index k) {
    const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(kQuantiles);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
  });
}

/// What a measure compares of a motion.
Eigen::VectorXd compared_by(Measure measure, const Motion& motion) {
  switch (measure) {
    case Measure::kPoints:
      return quantiles(motion.points);
    case Measure::kSpread:
      return quantiles(motion.readings);
    case Measure::kEnergy:
      return Eigen::VectorXd::Constant(1, motion.energy);
    case Measure::kStick:
      return Eigen::VectorXd::Constant(1, motion.stick);
    case Measure::kDx:
    case Measure::kDe:
      break;
  }
  return Eigen::VectorXd::Constant(1, kNone);
}

/// What a difference is told in [%]: the reading's rms, the mean energy, the time.
double unit_of(Measure measure, const std::vector<Motion>& reference) {
  double sum = 0.0;
  for (const Motion& motion : reference) {
    sum += measure == Measure::kStick ? 1.0 : measure == Measure::kEnergy ? motion.energy : rms(motion.readings);
  }
  return sum / (100.0 * static_cast<double>(reference.size()));
}

}  // namespace

Motion run_motion(const Case& model, const dynamics::State& start, double transient, const Schedule& schedule,
                  const StopFlag* stop) {
  const dynamics::HybridSystem& system = model.model.system;
  dynamics::State state = start;
  if (transient > 0.0) {
    state = run(model, state, {.duration = transient, .keep_events = false}, stop).final_state;
  }
  const auto total = static_cast<Eigen::Index>(std::llround(schedule.duration / schedule.sample));
  const Eigen::Index section = std::max<Eigen::Index>(schedule.per_section, 1);
  const auto fits = static_cast<Eigen::Index>(kPiece / (2.0 * static_cast<double>(system.size())));
  const Eigen::Index piece = section * std::max<Eigen::Index>(1, fits / section);
  Gathered record(model, schedule);
  for (Eigen::Index done = 0; done < total;) {
    const Eigen::Index columns = std::min(piece, total - done);
    const dynamics::Trajectory part = run(
        model, state, {.duration = static_cast<double>(columns) * schedule.sample, .sample = schedule.sample}, stop);
    record.add(part, columns);
    state = part.final_state;
    done += columns;
  }
  return record.take(std::move(state));
}

Values motion_distance(const Motion& reference, const Motion& other) {
  Values values;
  values.fill(kNone);
  const double scale = rms(reference.readings);
  at(values, Measure::kPoints) = distance(reference.points, other.points, scale);
  at(values, Measure::kSpread) = distance(reference.readings, other.readings, scale);
  at(values, Measure::kEnergy) = 100.0 * std::abs(other.energy - reference.energy) / reference.energy;
  at(values, Measure::kStick) = 100.0 * std::abs(other.stick - reference.stick);
  return values;
}

MotionChange motion_change(const std::vector<Motion>& reference, const std::vector<Motion>& other) {
  const std::size_t runs = reference.size();
  if (runs < 2 || other.size() != runs) {
    throw InvalidInput(fmt::format("change of motions: expected as many runs of both, two or more, found {} and {}",
                                   runs, other.size()));
  }
  MotionChange change;
  for (std::size_t m = 0; m < kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    std::vector<Eigen::VectorXd> differences;
    Eigen::VectorXd mean;
    for (std::size_t k = 0; k < runs; ++k) {
      differences.push_back(compared_by(measure, other[k]) - compared_by(measure, reference[k]));
      mean = k == 0 ? differences[0] : Eigen::VectorXd(mean + differences[k]);
    }
    mean /= static_cast<double>(runs);
    double scatter = 0.0;
    for (const Eigen::VectorXd& difference : differences) {
      const double apart = (difference - mean).cwiseAbs().mean();
      scatter += apart * apart;
    }
    const auto pairs = static_cast<double>(runs * (runs - 1));
    const double unit = unit_of(measure, reference), noise = std::sqrt(scatter / pairs);
    const double apart = mean.cwiseAbs().mean();
    const bool has_unit = unit > 0.0;
    change.noise[m] = has_unit ? noise / unit : kNone;
    const double left = apart * apart - noise * noise;
    change.error[m] = !has_unit || std::isnan(left) ? kNone : std::sqrt(std::max(0.0, left)) / unit;
  }
  return change;
}

Values motion_scatter(const std::vector<Motion>& motions) {
  if (motions.size() < 2) {
    throw InvalidInput(fmt::format("scatter of motions: expected two or more, found {}", motions.size()));
  }
  Values sum{};
  double pairs = 0.0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Values values = motion_distance(motions[i], motions[j]);
      for (std::size_t m = 0; m < kMeasures; ++m) sum[m] += values[m] * values[m];
      pairs += 1.0;
    }
  }
  for (double& value : sum) value = std::sqrt(value / pairs);
  return sum;
}

}  // namespace slipmode::trade
