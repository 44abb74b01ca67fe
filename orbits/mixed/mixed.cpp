#include <slipmode/orbits/mixed/mixed.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/prepare.hpp>
#include <slipmode/orbits/shooting.hpp>
#include "orbits/internal/describe_orbit.hpp"
#include "orbits/mixed/internal/mixed_problem.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

namespace slipmode::orbits {
namespace {

using dynamics::HybridSystem;
using dynamics::State;
using MixedDescent = Descent<MixedEvaluation>;

constexpr dynamics::FlowOptions kFlow{.tolerance = 1e-13, .audit = false};

void check(const HybridSystem& system, const MixedOptions& options) {
  const auto refuse = [](const std::string& text) { throw InvalidInput(text); };
  if (options.harmonics < 1) refuse(fmt::format("harmonics: {}; valid: 1 or more", options.harmonics));
  if (options.order < 1) refuse(fmt::format("order: {}; valid: 1 or more", options.order));
  if (options.reach < 0) refuse(fmt::format("reach: {}; valid: 0 or more", options.reach));
  if (system.drive().force() == nullptr)
    refuse("the mixed method needs a force drive (drive.kind = \"force\"); find this orbit by shooting");
  for (std::size_t c = 0; c < system.contacts().size(); ++c)
    if (const friction::Contact& contact = system.contacts()[c]; !friction::is_piecewise_linear(contact.law))
      refuse(
          fmt::format("the mixed method holds piecewise-linear laws (contact.{}.law = \"coulomb\", \"compliant\", "
                      "\"iwan\" or \"clearance\"), and contact '{}' has another law; find this orbit by shooting, "
                      "which holds every law",
                      c, contact.name));
}

/// Newton's method. A start that the flow refuses is one of several, and no fault of the caller's.
MixedDescent descend_from(MixedProblem& problem, const MixedPoint& from, double tolerance, int& budget) {
  MixedDescent d;
  try {
    d = descend(problem, from, tolerance, budget);
  } catch (const InvalidInput& refused) {
    d.failure = refused.what();
  }
  budget -= d.iterations;
  return d;
}

/// The same, taken up again from between events where the origin lies on one: there the derivative is none.
MixedDescent search(MixedProblem& problem, const MixedPoint& from, double tolerance, int& budget) {
  MixedDescent d = descend_from(problem, from, tolerance, budget);
  if (!d.begun) return d;
  const double T = problem.period(), start = d.best.point.start.time;
  if (!(distance_to_events(start, T, d.best.events) < 1e-6 * T)) return d;
  MixedPoint shifted = d.best.point;
  try {
    const HybridSystem near = problem.system_at(shifted);
    shifted.start = advanced(near, runnable(near, shifted.start), middle_of_longest_stretch(start, T, d.best.events));
  } catch (const NumericalFailure&) {
    return d;
  }
  MixedDescent again = descend_from(problem, shifted, tolerance, budget);
  return again.begun && again.best.largest <= std::max(d.best.largest, tolerance) ? again : d;
}

/// The near part after some periods under its coupling forces.
MixedPoint settled(const MixedProblem& problem, MixedPoint point, int periods) {
  const HybridSystem near = problem.system_at(point);
  point.start = advanced(near, point.start, periods * problem.period());
  point.start.time = 0.0;
  return point;
}

/// What the whole structure does after many periods, from rest: the near part's state, and the coupling by its motion.
MixedPoint settled_whole(const HybridSystem& system, const Partition& partition, double period) {
  constexpr double kPeriods = 100.0;
  const Eigen::Index H = partition.harmonics(), nb = partition.coupled(), samples = 16 * (H + 4);
  const State from = settle_guess(system, system.rest(), kPeriods);
  const dynamics::Trajectory run = simulate(
      system, from,
      {.duration = period, .sample = period / static_cast<double>(samples), .keep_events = false, .flow = kFlow});
  MixedPoint out{{.time = 0.0, .q = from.q(partition.near()), .v = from.v(partition.near())}, partition.own_coupling()};
  out.start.internal = from.internal;
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(nb * partition.block());
  for (Eigen::Index b = 0; b < nb; ++b)
    for (Eigen::Index k = 0; k <= H; ++k) {
      std::complex<double> sum = 0.0;
      for (Eigen::Index i = 0; i < samples; ++i)
        sum += run.q(partition.near()[static_cast<std::size_t>(partition.boundary(b))], i) *
               std::polar(1.0, -static_cast<double>(k) * partition.omega() * (run.times[i] - from.time));
      put_phasor((k == 0 ? 1.0 : 2.0) / static_cast<double>(samples) * sum, b, H, k, motion);
    }
  if (nb > 0) out.coupling += partition.coupling_by(motion);
  return out;
}

/// The guess with its coupling forces in harmonics up to H. @throws InvalidInput  of another near part
MixedPoint point_of(const MixedStart& guess, const Partition& partition) {
  const Eigen::Index nb = partition.coupled(), n = std::ssize(partition.near());
  const Eigen::Index own = nb == 0 ? 0 : (guess.coupling.size() / nb - 1) / 2;
  if (guess.near.q.size() != n || guess.near.v.size() != n || guess.coupling.size() != nb * (2 * own + 1))
    throw InvalidInput(
        fmt::format("guess: {} displacements and {} numbers of coupling; valid: {}, and 2 H + 1 for each "
                    "of {} coupled degrees of freedom",
                    guess.near.q.size(), guess.coupling.size(), n, nb));
  MixedPoint out{guess.near, partition.own_coupling()};
  for (Eigen::Index b = 0; b < nb; ++b)
    for (Eigen::Index k = 0; k <= std::min(own, partition.harmonics()); ++k)
      put_phasor(phasor(guess.coupling, b, own, k), b, partition.harmonics(), k, out.coupling);
  return out;
}

/// From the linear response, settled near the contacts; else with contacts' forces grown from nothing, by steps whose
/// length follows Newton's method; else from what the whole structure settles to.
MixedDescent search_cold(const HybridSystem& system, const Partition& partition, MixedProblem& problem,
                         const MixedPoint& linear, const MixedOptions& options, int& budget) {
  constexpr int kPeriods = 10, kDirect = 12, kPath = 24;
  constexpr double kFirstShare = 0.02, kLeastStep = 1e-3, kEnough = 1e-6;
  MixedDescent best;
  const auto keep = [&](MixedDescent found) {
    if (!found.begun && !best.begun) best.failure = found.failure;
    if (found.begun && (!best.begun || found.best.largest < best.best.largest)) best = std::move(found);
    return best.begun && best.best.largest <= options.tolerance;
  };
  const auto at_full = [&](const MixedPoint& from, int most) {
    int own = std::min(most, budget);
    budget -= own;
    const bool found = keep(search(problem, from, options.tolerance, own));
    budget += own;
    return found;
  };
  const auto guess = [&](const auto& make) -> std::optional<MixedPoint> {
    try {
      return make();
    } catch (const NumericalFailure& failure) {
      if (!best.begun) best.failure = failure.what();
    }
    return std::nullopt;
  };
  if (const auto near = guess([&] { return settled(problem, linear, kPeriods); }); near && at_full(*near, kDirect))
    return best;
  MixedPoint now = linear;
  double share = 0.0, step = kFirstShare;
  int path = std::min(kPath, budget);
  budget -= path;
  while (path > 0 && step >= kLeastStep) {
    const double next = std::min(1.0, share + step);
    problem.set_share(next);
    if (next == 1.0) {
      if (keep(search(problem, now, options.tolerance, path))) {
        budget += path;
        return best;
      }
    } else {
      MixedDescent found = search(problem, now, kEnough, path);
      if (found.begun && found.best.largest <= kEnough) {
        now = found.best.point;
        share = next;
        step *= 2.0;
        continue;
      }
    }
    step *= 0.4;
  }
  budget += path;
  problem.set_share(1.0);
  if (const auto whole = guess([&] { return settled_whole(system, partition, problem.period()); }))
    keep(search(problem, *whole, options.tolerance, budget));
  return best;
}

/// Contacts' own states as the start leaves them, relaxed.
MixedPoint linear_point(const Partition& partition, const MixedProblem& problem) {
  Partition::Response response = partition.without_contacts();
  MixedPoint point{std::move(response.near), std::move(response.coupling)};
  point.start = advanced(problem.system_at(point), point.start, 0.0);
  return point;
}

}  // namespace

int least_harmonics(const HybridSystem& system, const MixedOptions& options) {
  check(system, options);
  return highest_harmonic_on(system, parts_of(system, options.reach).rest, options.order);
}

std::vector<Eigen::Index> near_dofs(const HybridSystem& system, int reach) { return parts_of(system, reach).near; }

MixedOrbit mixed_orbit(const HybridSystem& system, const MixedOptions& options) {
  check(system, options);
  const Partition partition(system, options.reach, options.order, options.harmonics);
  MixedProblem problem(partition, kFlow);
  constexpr int kFromGuess = 12;
  int budget = options.max_iterations;
  MixedDescent found;
  if (options.guess) {
    int own = std::min(kFromGuess, budget);
    budget -= own;
    found = search(problem, point_of(*options.guess, partition), options.tolerance, own);
    budget += own;
  }
  if (!found.begun || found.best.largest > options.tolerance)
    found = search_cold(system, partition, problem, linear_point(partition, problem), options, budget);
  MixedOrbit out;
  out.order = options.order;
  out.omega = partition.omega();
  out.harmonics = options.harmonics;
  out.near = partition.near();
  out.coupled = static_cast<int>(partition.coupled());
  out.iterations = options.max_iterations - budget;
  out.residual = found.best.largest;
  out.converged = found.begun && found.best.largest <= options.tolerance;
  if (!out.converged) {
    out.message = fmt::format(
        "no mixed orbit of {} harmonics found: residual {:.2e} after {} Newton steps (asked {:.0e}){}. Try other "
        "harmonics, more degrees of freedom near the contacts (reach), or shooting",
        options.harmonics, out.residual, out.iterations, options.tolerance,
        found.failure.empty() ? "" : "; " + found.failure);
    return out;
  }
  const auto near = std::make_shared<const HybridSystem>(problem.system_at(found.best.point));
  ShootingOptions shooting{.flow = kFlow};
  ShootingProblem own(*near, shooting, OrbitKind::kDriven);
  own.use_scale(problem.scale().head(2 * near->size() + near->internal_size()));
  const ShootingPoint start{.nodes = {found.best.point.start}, .period = problem.period()};
  out.near_orbit = describe_orbit(own, own.evaluate(start), shooting);
  out.near_system = near;
  out.coupling = found.best.point.coupling;
  out.rest = partition.rest_under(found.best.motion);
  return out;
}

MixedEquations mixed_equations(const HybridSystem& system, const MixedOptions& options, const State& near_start,
                               const Eigen::VectorXd& coupling) {
  check(system, options);
  const Partition partition(system, options.reach, options.order, options.harmonics);
  MixedProblem problem(partition, kFlow);
  if (coupling.size() != partition.coupled() * partition.block())
    throw InvalidInput(fmt::format("coupling: {} numbers; valid: {} for each of {} coupled degrees of freedom",
                                   coupling.size(), partition.block(), partition.coupled()));
  MixedPoint point{near_start, coupling};
  point.start = advanced(problem.system_at(point), point.start, 0.0);
  MixedEvaluation at = problem.evaluate(point);
  const Eigen::VectorXd start = stacked(point.start);
  Eigen::VectorXd all(start.size() + coupling.size());
  all << start, coupling;
  return {std::move(all), problem.scale(), std::move(at.newton.r), std::move(at.newton.J)};
}

State state_of(const HybridSystem& system, const MixedOrbit& orbit) {
  if (!orbit.converged) throw InvalidInput("a mixed orbit that has not converged has no state");
  const State& near = orbit.near_orbit.start;
  std::vector<bool> is_near(static_cast<std::size_t>(system.size()), false);
  for (const Eigen::Index i : orbit.near) is_near[static_cast<std::size_t>(i)] = true;
  State out{.time = near.time, .q = Eigen::VectorXd(system.size()), .v = Eigen::VectorXd(system.size())};
  out.q(orbit.near) = near.q;
  out.v(orbit.near) = near.v;
  out.internal = near.internal;
  out.modes = near.modes;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(orbit.rest.rows()), v = q;
  for (Eigen::Index k = 0; k < orbit.rest.cols(); ++k) {
    const double w = static_cast<double>(k) * orbit.omega;
    const Eigen::VectorXcd turned = orbit.rest.col(k) * std::polar(1.0, w * near.time);
    q += turned.real();
    v -= w * turned.imag();
  }
  for (Eigen::Index i = 0, next = 0; i < system.size(); ++i) {
    if (is_near[static_cast<std::size_t>(i)]) continue;
    out.q[i] = q[next];
    out.v[i] = v[next++];
  }
  return out;
}

}  // namespace slipmode::orbits
