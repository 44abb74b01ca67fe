#include <slipmode/diagnostics/exponents/lyapunov.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include <slipmode/core/random.hpp>
#include <slipmode/core/to_vector.hpp>
#include <slipmode/diagnostics/model.hpp>
#include "diagnostics/series/internal/stretches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>
#include <vector>

namespace slipmode::diagnostics {

namespace {

/// Exponent and its scatter from the log growth of every interval.
LyapunovExponent summarise(const std::vector<double>& logs, double interval) {
  const Eigen::RowVectorXd rates = to_vector(logs).transpose();
  LyapunovExponent result{.nats = rates.sum() / (static_cast<double>(rates.size()) * interval),
                          .renormalisations = static_cast<int>(logs.size())};
  result.bits = result.nats / std::numbers::ln2;
  result.error = rates.size() < kStretches ? kNone : standard_error(stretch_means(rates))(0) / interval;
  return result;
}

/// Distances below rounding of the state say nothing: they count as rounding.
double floored(double distance, double size) {
  return std::max(distance, std::numeric_limits<double>::epsilon() * std::max(size, 1e-300));
}

bool is_compliant(const friction::Contact& contact) {
  return friction::kind(contact.law) == friction::LawKind::kCompliant;
}

/// Difference of two states, contacts' own states included.
struct Separation {
  Eigen::VectorXd q, v, internal;

  /// Energy norm; what contact springs store of a difference in stretch counts.
  [[nodiscard]] double norm(const dynamics::HybridSystem& system) const {
    double energy = system.structure().energy(q, v);
    for (std::size_t c = 0; c < system.contacts().size() && internal.size() > 0; ++c) {
      if (!is_compliant(system.contacts()[c])) continue;
      const double stretch = internal(system.internal_begin(static_cast<int>(c)));
      energy += 0.5 * friction::spring_stiffness(system.contacts()[c].law) * stretch * stretch;
    }
    return std::sqrt(energy);
  }
  void scale(double factor) {
    q *= factor;
    v *= factor;
    internal *= factor;
  }
};

/// A state beside the reference. Behind a contact spring the modes cannot be told from the sliding speed: there they
/// are the reference's; a rigid contact that slides the other way is given that way.
dynamics::State neighbour_of(const dynamics::HybridSystem& system, const dynamics::State& reference,
                             const Separation& separation) {
  dynamics::State state = {.time = reference.time, .q = reference.q + separation.q, .v = reference.v + separation.v};
  if (reference.internal.size() == 0) return state;
  state.internal = reference.internal + separation.internal;
  state.modes = reference.modes;
  for (std::size_t c = 0; c < state.modes.size(); ++c) {
    const friction::Contact& contact = system.contacts()[c];
    const bool slides = std::abs(static_cast<int>(state.modes[c])) == 1;
    if (is_compliant(contact) || !slides) continue;
    const double sliding = system.drive().velocity(state.time) - contact.direction.dot(state.v);
    state.modes[c] = sliding > 0.0 ? dynamics::ContactMode::kSlipPositive : dynamics::ContactMode::kSlipNegative;
  }
  return state;
}

/// Takes out of δv the directions in which the reference is stuck.
void hold_stuck(const dynamics::HybridSystem& system, const dynamics::State& reference, Separation& separation) {
  std::vector<Eigen::Index> stuck;
  for (std::size_t c = 0; c < reference.modes.size(); ++c) {
    if (reference.modes[c] == dynamics::ContactMode::kStick && !is_compliant(system.contacts()[c]))
      stuck.push_back(static_cast<Eigen::Index>(c));
  }
  if (stuck.empty()) return;
  Eigen::MatrixXd W(system.size(), static_cast<Eigen::Index>(stuck.size()));
  for (std::size_t k = 0; k < stuck.size(); ++k) {
    W.col(static_cast<Eigen::Index>(k)) = system.contacts()[static_cast<std::size_t>(stuck[k])].direction;
  }
  const Eigen::MatrixXd gram = W.transpose() * W;
  separation.v -= W * gram.ldlt().solve(W.transpose() * separation.v);
}

/// Norm of a structure at rest but for a contact that moves with its counterpart at its fastest: sliding speeds round
/// by that, however little of it friction passes on.
double size_of_drive(const dynamics::HybridSystem& system, double begin, double duration) {
  constexpr int kLooks = 16;
  double speed = 0.0, largest = 0.0;
  for (int k = 0; k <= kLooks; ++k)
    speed = std::max(speed, std::abs(system.drive().velocity(begin + duration * k / kLooks)));
  for (const friction::Contact& contact : system.contacts()) {
    const Eigen::VectorXd v = speed / contact.direction.squaredNorm() * contact.direction;
    largest = std::max(largest, system.structure().energy(Eigen::VectorXd::Zero(v.size()), v));
  }
  return std::sqrt(largest);
}

void check(const LyapunovOptions& options) {
  if (!(options.transient >= 0.0) || !(options.interval > 0.0) || !(options.duration >= options.interval) ||
      !(options.separation > 0.0)) {
    throw InvalidInput(
        fmt::format("Lyapunov exponent: expected transient >= 0, interval > 0, duration >= interval and "
                    "separation > 0, found {}, {}, {}, {}",
                    options.transient, options.interval, options.duration, options.separation));
  }
}

/// The end of a run; nothing else is kept.
dynamics::State advance(const dynamics::HybridSystem& system, const dynamics::State& from, double duration,
                        const dynamics::FlowOptions& flow) {
  const dynamics::SimulateOptions run{.duration = duration, .keep_events = false, .flow = flow};
  return dynamics::simulate(system, from, run).final_state;
}

}  // namespace

LyapunovExponent benettin(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& step, Eigen::VectorXd state,
                          Eigen::VectorXd direction, int steps, double time_step, double separation) {
  if (steps < 1 || !(time_step > 0.0) || !(separation > 0.0) || !(direction.norm() > 0.0) ||
      direction.size() != state.size()) {
    throw InvalidInput(
        fmt::format("Lyapunov exponent: expected steps >= 1, time step > 0, separation > 0 and a "
                    "direction of size {} that is not zero, found {}, {}, {}, size {}, norm {}",
                    state.size(), steps, time_step, separation, direction.size(), direction.norm()));
  }
  std::vector<double> logs;
  logs.reserve(static_cast<std::size_t>(steps));
  direction *= separation / direction.norm();
  for (int k = 0; k < steps; ++k) {
    const Eigen::VectorXd neighbour = step(state + direction);
    state = step(state);
    direction = neighbour - state;
    const double distance = floored(direction.norm(), state.norm());
    logs.push_back(std::log(distance / separation));
    if (direction.norm() == 0.0) direction.setConstant(distance);
    direction *= separation / direction.norm();
  }
  return summarise(logs, time_step);
}

LyapunovExponent largest_exponent(const dynamics::HybridSystem& system, const dynamics::State& start,
                                  const LyapunovOptions& options) {
  check(options);
  dynamics::FlowOptions flow = options.flow;
  flow.audit = false;
  dynamics::State reference = system.drive().period() ? start : dynamics::handed_on(system, start);
  if (options.transient > 0.0) reference = advance(system, reference, options.transient, flow);

  Random random(options.seed);
  Separation separation{.q = Eigen::VectorXd(system.size()),
                        .v = Eigen::VectorXd(system.size()),
                        .internal = Eigen::VectorXd::Zero(reference.internal.size())};
  for (double& x : separation.q) x = random.normal();
  for (double& x : separation.v) x = random.normal();

  const auto intervals = static_cast<std::size_t>(std::floor(options.duration / options.interval + 1e-9));
  std::vector<double> logs;
  logs.reserve(intervals);
  const auto size_of = [&] { return std::sqrt(system.structure().energy(reference.q, reference.v)); };
  double largest = std::max(size_of(), size_of_drive(system, reference.time, options.interval));
  for (std::size_t k = 0; k < intervals; ++k) {
    if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) throw Interrupted();
    hold_stuck(system, reference, separation);
    const double apart = options.separation * (largest > 0.0 ? largest : 1.0);
    separation.scale(apart / separation.norm(system));
    const dynamics::State end = advance(system, neighbour_of(system, reference, separation), options.interval, flow);
    reference = advance(system, reference, options.interval, flow);
    separation = {.q = end.q - reference.q, .v = end.v - reference.v, .internal = Eigen::VectorXd()};
    if (reference.internal.size() > 0) separation.internal = end.internal - reference.internal;
    const double size = size_of();
    largest = std::max(largest, size);
    logs.push_back(std::log(floored(separation.norm(system), size) / apart));
    if (separation.q.isZero(0.0) && separation.v.isZero(0.0)) separation.q.setOnes();
  }
  return summarise(logs, options.interval);
}

}  // namespace slipmode::diagnostics
