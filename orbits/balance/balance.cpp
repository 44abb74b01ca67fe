#include <slipmode/orbits/balance/balance.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/receptance.hpp>
#include "orbits/balance/internal/balance_problem.hpp"

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
using dynamics::HybridSystem;

/// Newton's method, steps halved until the residual falls. Spends at most `budget` steps.
BalanceEvaluation descend(const BalanceProblem& problem, const Eigen::VectorXd& from, double tolerance, int most,
                          int& budget) {
  const Parity parity = problem.parity_of(from);
  BalanceEvaluation best = problem.evaluate(from, parity);
  for (int turn = 0; turn < most && budget > 0 && !(best.relative <= tolerance); ++turn, --budget) {
    const Eigen::VectorXd step = problem.step(best);
    double share = 1.0;
    BalanceEvaluation next = problem.evaluate(best.x + step, parity);
    while (!(next.residual.norm() < best.residual.norm()) && share > 1e-2) {
      share *= 0.5;
      next = problem.evaluate(best.x + share * step, parity);
    }
    const bool stalled = !(next.residual.norm() < best.residual.norm());
    if (stalled && best.relative <= 100.0 * tolerance) break;  // rounding
    best = std::move(next);
  }
  return best;
}

void check(const HybridSystem& system, const BalanceOptions& options) {
  const auto refuse = [](const std::string& text) { throw InvalidInput(text); };
  if (options.harmonics < 1) refuse(fmt::format("harmonics: {}; valid: 1 or more", options.harmonics));
  if (options.order < 1) refuse(fmt::format("order: {}; valid: 1 or more", options.order));
  if (options.samples != 0 && options.samples <= 2 * options.harmonics)
    refuse(fmt::format("samples: {}; {} harmonics need more than {}, or exact", options.samples, options.harmonics,
                       2 * options.harmonics));
  if (!system.drive().period())
    refuse(
        "harmonic balance needs a drive with a period (drive.kind = \"force\" or \"shaker\"); find this orbit by "
        "shooting");
  if (system.drive().shaker() != nullptr && options.harmonics < options.order)
    refuse(fmt::format("harmonics: {}; of {} periods the shaker is harmonic {}: valid: that or more", options.harmonics,
                       options.order, options.order));
  static_cast<void>(balanced_laws(system));
  if (!options.guess.empty() && options.guess.size() != system.contacts().size())
    refuse(fmt::format("the guess has {} contacts and the system {}", options.guess.size(), system.contacts().size()));
}

/// The linear response with all contacts pressing and sticking from gap zero on, or without any force of theirs.
Eigen::VectorXd linear_response(const HybridSystem& system, const ContactResponse& response, bool pressed) {
  const Eigen::Index nc = response.places(), H = response.harmonics(), B = response.block();
  const std::vector<BalancedLaw> laws = balanced_laws(system);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(response.unknowns());
  const Eigen::Index nr = response.rigid_rows.cols();
  for (Eigen::Index k = 0; k <= H; ++k) {
    const auto at = static_cast<std::size_t>(k);
    Eigen::MatrixXcd A = Eigen::MatrixXcd::Identity(nc + (k == 0 ? nr : 0), nc + (k == 0 ? nr : 0));
    Eigen::VectorXcd b = Eigen::VectorXcd::Zero(A.rows());
    b.head(nc) = response.own[at];
    if (k == 0 && nr > 0) {
      A.topRightCorner(nc, nr) = -response.rigid_rows.cast<Complex>();
      A.bottomRightCorner(nr, nr).setZero();
      b.tail(nr) = -response.rigid_load.cast<Complex>();
    }
    for (Eigen::Index c = 0; pressed && c < nc; ++c) {
      Complex own = 0.0, following = 0.0;
      for (const std::size_t contact : response.contacts_at[static_cast<std::size_t>(c)]) {
        const Complex here = impedance(laws[contact], static_cast<double>(k) * response.omega());
        own += here;
        if (follows_drive(laws[contact])) following += here;
      }
      A.col(c).head(nc) += response.receptance[at].col(c) * own;
      b.head(nc) += response.receptance[at].col(c) * (following * response.counterpart.phasors[k]);
      if (k == 0 && nr > 0) A.col(c).tail(nr) = -own * response.rigid_rows.row(c).transpose().cast<Complex>();
    }
    if (b.isZero(0.0)) continue;
    const Eigen::VectorXcd y = A.completeOrthogonalDecomposition().solve(b);
    for (Eigen::Index c = 0; c < nc; ++c) {
      x[c * B + k] = y[c].real();
      if (k > 0) x[c * B + H + k] = -y[c].imag();
    }
    if (k == 0) x.tail(nr) = y.tail(nr).real();
  }
  return x;
}

/// From the linear response of linear laws to their own, by steps whose length follows Newton's method.
BalanceEvaluation grow_laws(BalanceProblem& problem, const Eigen::VectorXd& from, double tolerance, int& budget) {
  constexpr double kEnough = 1e-4, kLeastStep = 1e-3;
  Eigen::VectorXd before, now = from;
  double share_before = 0.0, share = 0.0, step = 0.5;
  while (budget > 0) {
    const double next = std::min(1.0, share + step);
    problem.set_share(next);
    Eigen::VectorXd guess = now;
    if (before.size() > 0) guess += (next - share) / (share - share_before) * (now - before);
    BalanceEvaluation found = descend(problem, guess, next < 1.0 ? kEnough : tolerance, next < 1.0 ? 5 : 12, budget);
    const bool arrived = found.relative <= (next < 1.0 ? kEnough : tolerance);
    if (next == 1.0 && (arrived || step < kLeastStep)) return found;
    if (arrived) {
      before = std::exchange(now, found.x);
      share_before = std::exchange(share, next);
      step *= 2.0;
    } else if ((step *= 0.4) < kLeastStep) {
      break;
    }
  }
  problem.set_share(1.0);
  return problem.evaluate(now);
}

/// From linear responses. Friction is mostly met from one of them, stops want a path.
BalanceEvaluation search_cold(const HybridSystem& system, const ContactResponse& response, BalanceProblem& problem,
                              const BalanceOptions& options, int& budget) {
  constexpr int kFromHeld = 10, kFromFree = 25;
  const std::vector<BalancedLaw> laws = balanced_laws(system);
  const bool pressed = options.start == BalanceStart::kContact, friction = std::ranges::any_of(laws, remembers);
  const int from_free = std::ranges::all_of(laws, remembers) ? options.max_iterations : kFromFree;
  const Eigen::VectorXd free = linear_response(system, response, false);
  const Eigen::VectorXd held = pressed ? linear_response(system, response, true) : free;
  std::optional<BalanceEvaluation> best;
  const auto keep = [&](BalanceEvaluation found) {
    if (!best || found.relative < best->relative) best = std::move(found);
    return best->relative <= options.tolerance;
  };
  const auto descend_from = [&](const Eigen::VectorXd& from, int most) {
    return keep(descend(problem, from, options.tolerance, most, budget));
  };
  if (pressed && friction && (descend_from(held, kFromHeld) || descend_from(free, from_free))) return *best;
  if (pressed && keep(grow_laws(problem, held, options.tolerance, budget))) return *best;
  descend_from(free, budget);
  return *best;
}

}  // namespace

Balance balance(const HybridSystem& system, const BalanceOptions& options) {
  check(system, options);
  const ContactResponse response(system, options.order, options.harmonics);
  BalanceProblem problem(system, response, options.samples, response.lead(system));
  int budget = options.max_iterations;
  BalanceEvaluation found;
  if (!options.guess.empty()) {
    found = descend(problem, unknowns_of(options.guess, response), options.tolerance, budget, budget);
  } else {
    found = search_cold(system, response, problem, options, budget);
  }
  Balance out = problem.series_of(found, options.order);
  out.converged = found.relative <= 100.0 * options.tolerance;
  if (out.rigid.size() > 0) {
    const BalanceEvaluation all = problem.evaluate(found.x);
    out.family = problem.leaves_means_open(all) && problem.leaves_something_open(all);
  }
  out.iterations = options.max_iterations - budget;
  if (!out.converged)
    out.message = fmt::format(
        "no balance of {} harmonics found: residual {:.2e} after {} Newton steps (asked {:.0e}). Try other harmonics, "
        "another start, following one from another frequency (continuation), or shooting",
        options.harmonics, found.relative, out.iterations, options.tolerance);
  return out;
}

BalanceEquations balance_equations(const HybridSystem& system, const Balance& at) {
  const ContactResponse response(system, at.order, at.harmonics);
  const BalanceProblem problem(system, response, at.samples, at.harmonics);
  Eigen::VectorXd x = unknowns_of(at.displacement, response);
  x.tail(at.rigid.size()) = at.rigid;
  BalanceEvaluation found = problem.evaluate(x);
  return {std::move(found.residual), std::move(found.jacobian)};
}

bool has_memory(const HybridSystem& system) { return std::ranges::any_of(balanced_laws(system), remembers); }

dynamics::State state_of(const HybridSystem& system, const Balance& balance) {
  const dynamics::ModalModel& model = system.cache().tables(system, false).model;
  const dynamics::ModalCoordinates& modal = model.modal;
  const auto contacts = static_cast<Eigen::Index>(balance.force.size());
  Eigen::VectorXd eta = modal.load;
  for (Eigen::Index c = 0; c < contacts; ++c)
    eta += modal.directions.col(c) * balance.force[static_cast<std::size_t>(c)].cosine[0];
  Eigen::Index floating = 0;
  for (Eigen::Index i = 0; i < eta.size(); ++i)
    eta[i] = modal.omega[i] == 0.0 ? balance.rigid[floating++] : eta[i] / (modal.omega[i] * modal.omega[i]);
  Eigen::VectorXd x = modal.from_eta * eta;
  for (Eigen::Index k = 1; k <= balance.harmonics; ++k) {
    Eigen::VectorXcd input = model.force_input * drive_phasors(system, balance.order, k);
    for (Eigen::Index c = 0; c < contacts; ++c) {
      const Harmonics& own = balance.force[static_cast<std::size_t>(c)];
      input += model.input.col(c) * Complex(own.cosine[k], -own.sine[k]);
    }
    x += pair_receptances(model, static_cast<double>(k) * balance.omega, input).real();
  }
  dynamics::State state = system.rest();
  state.q = model.to_q * x;
  state.v = model.to_v * x;
  const std::vector<BalancedLaw> laws = balanced_laws(system);
  const TrigonometricPolynomial d = counterpart_motion(system.drive(), balance.order, balance.harmonics);
  std::vector<double> internal;
  for (std::size_t c = 0; c < laws.size(); ++c)
    if (const auto own = own_state(laws[c], seen_by(laws[c], polynomial_of(balance.displacement[c]), d)))
      internal.push_back(*own);
  state.internal = Eigen::Map<const Eigen::VectorXd>(internal.data(), std::ssize(internal));
  return state;
}

std::vector<Amplitude> contact_amplitudes(const Balance& balance) {
  std::vector<Amplitude> out;
  for (const Harmonics& y : balance.displacement) {
    const TrigonometricPolynomial series = polynomial_of(y);
    const double start = series.at(0.0).y;
    Amplitude own{.min = start, .max = start, .mean = y.cosine[0]};
    for (const double theta : zeros(derivative(series))) {
      const double here = series.at(theta).y;
      if (here < own.min) own.min = here, own.min_time = theta / balance.omega;
      if (here > own.max) own.max = here, own.max_time = theta / balance.omega;
    }
    own.alternating = 0.5 * (own.max - own.min);
    own.effective = std::sqrt(0.5) * series.phasors.tail(balance.harmonics).norm();
    out.push_back(own);
  }
  return out;
}

double value_of(const Harmonics& y, double theta) { return polynomial_of(y).at(theta).y; }

}  // namespace slipmode::orbits
