#include "orbits/internal/describe_orbit.hpp"

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::orbits {
namespace {

using dynamics::Event;
using dynamics::State;

/// A flight that is back in the gap is the gap: the flow passes that without an event.
void name_gaps(const dynamics::HybridSystem& system, State& state) {
  for (std::size_t c = 0; c < state.modes.size(); ++c) {
    const bool left = state.modes[c] == dynamics::ContactMode::kLeftFlight;
    if (!left && state.modes[c] != dynamics::ContactMode::kRightFlight) continue;
    const friction::Contact& contact = system.contacts()[c];
    const friction::Clearance& law = *friction::clearance(contact.law);
    const double y = contact.direction.dot(state.q) + contact.offset;
    const bool beyond = left ? -y >= law.left->gap : y >= law.right->gap;
    if (!beyond) state.modes[c] = dynamics::ContactMode::kGap;
  }
}

/// Event times after the start, in [0, period), ascending.
std::vector<double> event_phases(double start_time, double period, const std::vector<Event>& events) {
  std::vector<double> phases;
  for (const Event& e : events) {
    const double phase = std::fmod(e.time - start_time, period);
    phases.push_back(phase < 0 ? phase + period : phase);
  }
  std::sort(phases.begin(), phases.end());
  return phases;
}

State reflected(State state) {
  state.q = -state.q;
  state.v = -state.v;
  state.internal = -state.internal;
  return state;
}

/// True when the orbit keeps to one linear regime: then all of Φ's fixed directions lead to orbits, as far as there is
/// room.
bool stays_linear(const dynamics::HybridSystem& system, const PeriodicOrbit& orbit) {
  return orbit.events.empty() &&
         std::all_of(system.contacts().begin(), system.contacts().end(),
                     [](const friction::Contact& contact) { return is_piecewise_linear(contact.law); });
}

/// Directions along which neighbours of the orbit are orbits too: null space of (Φ − 1), less the flow direction, as
/// far as a finite shift along it closes as well.
Eigen::MatrixXd orbit_family(ShootingProblem& problem, const ShootingEvaluation& at, const PeriodicOrbit& orbit) {
  const Eigen::VectorXd& scale = problem.scale();
  const Eigen::Index n = scale.size();
  Eigen::MatrixXd J = scale.cwiseInverse().asDiagonal() * orbit.monodromy * scale.asDiagonal();
  J.diagonal().array() -= 1.0;
  if (problem.period_unknown()) {
    J.conservativeResize(n + 1, n);
    J.row(n) = at.rate.back().transpose().normalized();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeFullV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  const bool linear = stays_linear(problem.system(), orbit);
  std::vector<Eigen::VectorXd> found;
  for (Eigen::Index i = n; i-- > 0 && sigma[i] <= 1e-9 * sigma[0];) {
    const Eigen::VectorXd direction = svd.matrixV().col(i);
    bool closes = true;
    for (const double shift : {1e-4, -1e-4}) {
      if (linear) break;
      const State moved = with_coordinates(orbit.start, stacked(orbit.start) + shift * scale.cwiseProduct(direction));
      const State end = problem.end_of(moved, orbit.period);
      closes &= problem.scaled(stacked(end) - stacked(moved)).cwiseAbs().maxCoeff() <= 1e-9;
    }
    if (closes) found.push_back(scale.cwiseProduct(direction).normalized());
  }
  Eigen::MatrixXd family(n, static_cast<Eigen::Index>(found.size()));
  for (std::size_t k = 0; k < found.size(); ++k) family.col(static_cast<Eigen::Index>(k)) = found[k];
  return family;
}

double closest_to_grazing(const std::vector<Event>& events) {
  double slowest = std::numeric_limits<double>::infinity(), fastest = 0.0;
  for (const Event& e : events) {
    fastest = std::max(fastest, std::abs(e.velocity));
    const bool reaches = e.kind == dynamics::EventKind::kContact && e.before == dynamics::ContactMode::kGap;
    if (reaches) slowest = std::min(slowest, std::abs(e.velocity));
  }
  return std::isfinite(slowest) && fastest > 0 ? slowest / fastest : 1.0;
}

/// The largest k for which the state is back after a k-th of the period: a divisor of the order, or of the events.
int count_repeats(ShootingProblem& problem, const PeriodicOrbit& orbit) {
  const int whole = orbit.kind == OrbitKind::kDriven ? orbit.order : static_cast<int>(orbit.events.size());
  for (int k = whole; k > 1; --k) {
    if (whole % k != 0) continue;
    const State part = problem.end_of(orbit.start, orbit.period / k);
    if (problem.scaled(stacked(part) - stacked(orbit.start)).cwiseAbs().maxCoeff() < 1e-6) return k;
  }
  return 1;
}

/// Start, period, fundamental matrix and events; the second half of a half-period orbit is run here.
void add_motion(PeriodicOrbit& orbit, ShootingProblem& problem, const ShootingEvaluation& at,
                const ShootingOptions& options) {
  const Eigen::VectorXd& scale = problem.scale();
  Eigen::MatrixXd product = at.transfer[0];
  for (std::size_t k = 1; k < at.transfer.size(); ++k) product = at.transfer[k] * product;
  orbit.events = at.events;
  if (options.half_period) {
    orbit.half_multipliers = sorted_eigenvalues(-product);
    State second = reflected(orbit.start);
    second.time = at.ends.back().time;
    second.modes = at.ends.back().modes;
    const dynamics::TangentResult half = problem.flow().run(runnable(problem.system(), second), 0.5 * orbit.period);
    orbit.events.insert(orbit.events.end(), half.events.begin(), half.events.end());
    orbit.start.modes = half.end.modes;
    product = scale.cwiseInverse().asDiagonal() * half.monodromy * scale.asDiagonal() * product;
  }
  orbit.monodromy = scale.asDiagonal() * product * scale.cwiseInverse().asDiagonal();
}

void add_symmetry(PeriodicOrbit& orbit, const ShootingProblem& problem, const ShootingEvaluation& at,
                  const ShootingOptions& options) {
  if (options.half_period) {
    orbit.symmetric = true;
    orbit.asymmetry = orbit.residual;
    return;
  }
  if (at.half_state.size() == 0) return;
  orbit.asymmetry = (at.half_state + problem.scaled(stacked(orbit.start))).cwiseAbs().maxCoeff();
  orbit.symmetric = orbit.asymmetry <= options.symmetry_tolerance;
  if (orbit.symmetric) orbit.half_multipliers = sorted_eigenvalues(-at.half_transfer);
}

}  // namespace

double middle_of_longest_stretch(double start_time, double period, const std::vector<Event>& events) {
  const std::vector<double> phases = event_phases(start_time, period, events);
  if (phases.empty()) return 0.0;
  double longest = phases.front() + period - phases.back();
  double middle = phases.back() + 0.5 * longest;
  for (std::size_t k = 1; k < phases.size(); ++k) {
    const double stretch = phases[k] - phases[k - 1];
    if (stretch <= longest * (1.0 + 1e-9)) continue;
    longest = stretch;
    middle = phases[k - 1] + 0.5 * stretch;
  }
  return std::fmod(middle, period);
}

double distance_to_events(double start_time, double period, const std::vector<Event>& events) {
  const std::vector<double> phases = event_phases(start_time, period, events);
  if (phases.empty()) return std::numeric_limits<double>::infinity();
  return std::min(phases.front(), period - phases.back());
}

PeriodicOrbit describe_orbit(ShootingProblem& problem, const ShootingEvaluation& at, const ShootingOptions& options) {
  PeriodicOrbit orbit;
  orbit.start = at.point.nodes[0];
  orbit.start.modes = at.ends.back().modes;
  name_gaps(problem.system(), orbit.start);
  orbit.period = at.point.period;
  orbit.kind = problem.kind();
  orbit.order = problem.kind() == OrbitKind::kDriven ? options.order : 1;
  orbit.residual = at.largest;
  add_motion(orbit, problem, at, options);
  add_symmetry(orbit, problem, at, options);
  orbit.repeats = count_repeats(problem, orbit);
  orbit.family = orbit_family(problem, at, orbit);
  if (orbit.family.cols() > 0)
    orbit.family_note = "one of a family of " + std::to_string(orbit.family.cols()) +
                        (orbit.family.cols() == 1 ? " parameter" : " parameters") +
                        ": shifted along `family` it is an orbit again, as of a structure that nothing holds there";
  orbit.trivial_multipliers = (problem.period_unknown() ? 1 : 0) + static_cast<int>(orbit.family.cols());
  set_stability(orbit, options.marginal_band);
  orbit.grazing = closest_to_grazing(orbit.events);
  orbit.has_grazing = orbit.grazing < 1e-4 || std::any_of(orbit.events.begin(), orbit.events.end(), [](const Event& e) {
                        return e.kind == dynamics::EventKind::kGrazing;
                      });
  orbit.regimes = regime_sequence(orbit.start.time, orbit.start.modes, orbit.events);
  orbit.crossings = crossings_of(orbit.regimes);
  orbit.word = word_of(orbit.regimes);
  return orbit;
}

}  // namespace slipmode::orbits
