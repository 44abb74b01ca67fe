#include <slipmode/orbits/balance/balance.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/receptance.hpp>
#include "orbits/balance/internal/balanced_force.hpp"

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

/// The pairs' inputs of the force drive at order k of the orbit's period, as phasors.
Eigen::VectorXcd drive_phasors(const HybridSystem& system, Eigen::Index order, Eigen::Index k) {
  Eigen::VectorXcd forces = Eigen::VectorXcd::Zero(system.force_directions().cols());
  for (const friction::ForceHarmonic& h : system.drive().force()->harmonics)
    if (h.order * order == k) forces[h.direction] += h.amplitude * Complex(std::sin(h.phase), -std::cos(h.phase));
  return forces;
}

/// How the structure answers at its contacts, order by order.
class ContactResponse {
 public:
  ContactResponse(const HybridSystem& system, int order, double omega, Eigen::Index harmonics)
      : contacts_(static_cast<Eigen::Index>(system.contacts().size())), harmonics_(harmonics) {
    const dynamics::ModalModel& model = system.cache().tables(system, false).model;
    const dynamics::ModalCoordinates& modal = model.modal;
    const Eigen::Index n = modal.omega.size();
    Eigen::MatrixXd R = Eigen::MatrixXd::Zero(contacts_, contacts_);
    Eigen::VectorXd e(contacts_);
    for (Eigen::Index c = 0; c < contacts_; ++c) e[c] = system.contacts()[static_cast<std::size_t>(c)].offset;
    std::vector<Eigen::Index> floating;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (modal.omega[i] == 0.0) {
        floating.push_back(i);
        continue;
      }
      const Eigen::VectorXd row = modal.directions.row(i).transpose() / modal.omega[i];
      R += row * row.transpose();
      e += row * (modal.load[i] / modal.omega[i]);
    }
    rigid_rows.resize(contacts_, static_cast<Eigen::Index>(floating.size()));
    rigid_load.resize(rigid_rows.cols());
    for (Eigen::Index r = 0; r < rigid_rows.cols(); ++r) {
      rigid_rows.col(r) = modal.directions.row(floating[static_cast<std::size_t>(r)]).transpose();
      rigid_load[r] = modal.load[floating[static_cast<std::size_t>(r)]];
    }
    receptance.emplace_back(R.cast<Complex>());
    own.emplace_back(e.cast<Complex>());
    for (Eigen::Index k = 1; k <= harmonics; ++k) {
      Eigen::MatrixXcd inputs(2 * model.np, contacts_ + 1);
      inputs << model.input.cast<Complex>(), model.force_input * drive_phasors(system, order, k);
      const Eigen::MatrixXcd answers =
          model.displacement_row.transpose() * pair_receptances(model, static_cast<double>(k) * omega, inputs);
      receptance.emplace_back(answers.leftCols(contacts_));
      own.emplace_back(answers.col(contacts_));
    }
  }

  [[nodiscard]] Eigen::Index contacts() const { return contacts_; }
  [[nodiscard]] Eigen::Index harmonics() const { return harmonics_; }
  [[nodiscard]] Eigen::Index block() const { return 2 * harmonics_ + 1; }
  [[nodiscard]] Eigen::Index unknowns() const { return contacts_ * block() + rigid_rows.cols(); }

  /// The orders that Newton's method solves together: those beyond answer their forces by less than a share of their
  /// motion, and follow by substitution.
  [[nodiscard]] Eigen::Index lead(const HybridSystem& system, double omega) const {
    constexpr Eigen::Index kFew = 120;
    constexpr double kWeak = 0.005;
    if (harmonics_ <= kFew) return harmonics_;
    for (Eigen::Index k = harmonics_; k > kFew / 2; --k) {
      double most = 0.0;
      for (Eigen::Index c = 0; c < contacts_; ++c)
        for (const friction::Stop& stop :
             friction::clearance(system.contacts()[static_cast<std::size_t>(c)].law)->stops())
          most = std::max(most, receptance[static_cast<std::size_t>(k)].col(c).cwiseAbs().sum() *
                                    std::hypot(stop.stiffness, static_cast<double>(k) * omega * stop.damping));
      if (most > kWeak) return k;
    }
    return kFew / 2;
  }

  std::vector<Eigen::MatrixXcd> receptance;  ///< R_k [nc x nc]
  std::vector<Eigen::VectorXcd> own;         ///< e_k
  Eigen::MatrixXd rigid_rows;                ///< Z [nc x nr]
  Eigen::VectorXd rigid_load;                ///< of the modes that float [nr]

 private:
  Eigen::Index contacts_, harmonics_;
};

/// Contacts' laws on the way: gaps in this share of their own.
std::vector<friction::Clearance> laws_of(const HybridSystem& system, double share) {
  std::vector<friction::Clearance> laws;
  for (const friction::Contact& contact : system.contacts()) {
    friction::Clearance law = *friction::clearance(contact.law);
    if (law.left) law.left->gap *= share;
    if (law.right) law.right->gap *= share;
    laws.push_back(law);
  }
  return laws;
}

Eigen::VectorXcd phasors_of(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Index H) {
  Eigen::VectorXcd p(H + 1);
  p[0] = x[0];
  for (Eigen::Index k = 1; k <= H; ++k) p[k] = Complex(x[k], -x[H + k]);
  return p;
}

Eigen::VectorXd numbers_of(const Eigen::VectorXcd& phasors) {
  const Eigen::Index H = phasors.size() - 1;
  Eigen::VectorXd x(2 * H + 1);
  x << phasors.real(), -phasors.imag().tail(H);
  return x;
}

Harmonics harmonics_of(const Eigen::VectorXcd& phasors) {
  Harmonics y{phasors.real(), -phasors.imag()};
  y.sine[0] = 0.0;
  return y;
}

/// Newton's equations at a point.
struct Evaluation {
  Eigen::VectorXd x, residual;
  Eigen::MatrixXd jacobian;  ///< of the leading orders
  std::vector<BalancedForce> forces;
  double relative = 0.0;
};

class BalanceProblem {
 public:
  /// @param lead  orders that Newton's method solves together
  BalanceProblem(const HybridSystem& system, const ContactResponse& response, double omega, int samples,
                 Eigen::Index lead)
      : response_(response), omega_(omega), samples_(samples), lead_(lead) {
    set_gaps(system, 1.0);
  }

  void set_gaps(const HybridSystem& system, double share) { laws_ = laws_of(system, share); }

  [[nodiscard]] Evaluation evaluate(const Eigen::VectorXd& x) const {
    const Eigen::Index nc = response_.contacts(), H = response_.harmonics(), B = response_.block();
    const Eigen::Index nr = response_.rigid_rows.cols();
    const Eigen::Index own = 2 * lead_ + 1, N = nc * own + nr;
    Evaluation out{x, Eigen::VectorXd(x.size()), Eigen::MatrixXd::Identity(N, N), {}, 0.0};
    for (Eigen::Index c = 0; c < nc; ++c)
      out.forces.push_back(balanced_force(laws_[static_cast<std::size_t>(c)], {phasors_of(x.segment(c * B, B), H)},
                                          omega_, samples_, lead_));
    for (Eigen::Index c = 0; c < nc; ++c) {
      Eigen::VectorXcd missing = phasors_of(x.segment(c * B, B), H);
      for (Eigen::Index k = 0; k <= H; ++k) {
        const auto at = static_cast<std::size_t>(k);
        missing[k] -= response_.own[at][c];
        for (Eigen::Index d = 0; d < nc; ++d)
          missing[k] -= response_.receptance[at](c, d) * out.forces[static_cast<std::size_t>(d)].phasors[k];
      }
      if (nr > 0) missing[0] -= response_.rigid_rows.row(c).dot(x.tail(nr));
      out.residual.segment(c * B, B) = numbers_of(missing);
      for (Eigen::Index d = 0; d < nc; ++d) take_off(c, d, out);
      out.jacobian.row(c * own).tail(nr) = -response_.rigid_rows.row(c);
    }
    add_equilibrium(out);
    out.relative = out.residual.head(nc * B).cwiseAbs().maxCoeff() / size_of(x);
    if (nr > 0) {  // forces in units of those that the displacements' size makes
      double force = response_.rigid_load.cwiseAbs().maxCoeff();
      for (const BalancedForce& f : out.forces) force = std::max(force, f.phasors.cwiseAbs().maxCoeff());
      if (force > 0.0) out.relative = std::max(out.relative, out.residual.tail(nr).cwiseAbs().maxCoeff() / force);
    }
    return out;
  }

  /// The step: Newton's for the leading orders, of least norm where the equations leave something open, and
  /// substitution for those beyond.
  [[nodiscard]] Eigen::VectorXd step(const Evaluation& at, bool& out_open) const {
    const Eigen::Index H = response_.harmonics(), B = response_.block(), own = 2 * lead_ + 1;
    const Eigen::Index nc = response_.contacts(), nr = response_.rigid_rows.cols();
    std::vector<Eigen::Index> leading;
    for (Eigen::Index c = 0; c < nc; ++c)
      for (Eigen::Index i = 0; i < own; ++i) leading.push_back(c * B + (i <= lead_ ? i : H + i - lead_));
    for (Eigen::Index r = 0; r < nr; ++r) leading.push_back(nc * B + r);
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(at.jacobian);
    const Eigen::VectorXd pivots = lu.matrixLU().diagonal().cwiseAbs();
    Eigen::VectorXd rest(at.jacobian.rows());
    for (std::size_t i = 0; i < leading.size(); ++i) rest[static_cast<Eigen::Index>(i)] = -at.residual[leading[i]];
    out_open = !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff());
    Eigen::VectorXd newton;
    if (out_open) {
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> orthogonal;
      orthogonal.setThreshold(1e-12);
      newton = orthogonal.compute(at.jacobian).solve(rest);
    } else {
      newton = lu.solve(rest);
    }
    Eigen::VectorXd step = -at.residual;
    for (std::size_t i = 0; i < leading.size(); ++i) step[leading[i]] = newton[static_cast<Eigen::Index>(i)];
    return step;
  }

 private:
  [[nodiscard]] double size_of(const Eigen::VectorXd& x) const {
    double size = x.head(response_.contacts() * response_.block()).cwiseAbs().maxCoeff();
    for (const Eigen::VectorXcd& e : response_.own) size = std::max(size, e.cwiseAbs().maxCoeff());
    return size > 0.0 ? size : 1.0;
  }

  /// Jacobian's block of contact c by contact d: less R_k times the force's derivative.
  void take_off(Eigen::Index c, Eigen::Index d, Evaluation& out) const {
    const Eigen::Index H = lead_, B = 2 * lead_ + 1;
    const Eigen::MatrixXd& J = out.forces[static_cast<std::size_t>(d)].jacobian;
    auto block = out.jacobian.block(c * B, d * B, B, B);
    for (Eigen::Index k = 0; k <= H; ++k) {
      const Complex R = response_.receptance[static_cast<std::size_t>(k)](c, d);
      block.row(k) -= R.real() * J.row(k);
      if (k == 0) continue;
      block.row(k) -= R.imag() * J.row(H + k);
      block.row(H + k) -= R.real() * J.row(H + k) - R.imag() * J.row(k);
    }
  }

  /// Zᵀλ_0 + p = 0 for what floats.
  void add_equilibrium(Evaluation& out) const {
    const Eigen::Index nc = response_.contacts(), B = 2 * lead_ + 1, nr = response_.rigid_rows.cols();
    if (nr == 0) return;
    out.residual.tail(nr) = response_.rigid_load;
    out.jacobian.bottomRightCorner(nr, nr).setZero();
    for (Eigen::Index d = 0; d < nc; ++d) {
      const BalancedForce& force = out.forces[static_cast<std::size_t>(d)];
      const Eigen::VectorXd z = response_.rigid_rows.row(d).transpose();
      out.residual.tail(nr) += z * force.phasors[0].real();
      out.jacobian.block(nc * B, d * B, nr, B) = z * force.jacobian.row(0);
    }
  }

  const ContactResponse& response_;
  double omega_;
  int samples_;
  Eigen::Index lead_;
  std::vector<friction::Clearance> laws_;
};

/// Newton's method, steps halved until the residual falls. Spends at most `budget` steps.
Evaluation descend(const BalanceProblem& problem, const Eigen::VectorXd& from, double tolerance, int most, int& budget,
                   bool& out_open) {
  Evaluation best = problem.evaluate(from);
  for (int turn = 0; turn < most && budget > 0 && !(best.relative <= tolerance); ++turn, --budget) {
    const Eigen::VectorXd step = problem.step(best, out_open);
    double share = 1.0;
    Evaluation next = problem.evaluate(best.x + step);
    while (!(next.residual.norm() < best.residual.norm()) && share > 1e-2) {
      share *= 0.5;
      next = problem.evaluate(best.x + share * step);
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
  if (system.drive().force() == nullptr)
    refuse("harmonic balance needs a force drive (drive.kind = \"force\"); find this orbit by shooting");
  for (const friction::Contact& contact : system.contacts())
    if (friction::clearance(contact.law) == nullptr)
      refuse(
          fmt::format("harmonic balance holds clearances (contact.law = \"clearance\") and no friction: contact '{}' "
                      "has another law; find this orbit by shooting, which holds every law",
                      contact.name));
  if (!options.guess.empty() && options.guess.size() != system.contacts().size())
    refuse(fmt::format("the guess has {} contacts and the system {}", options.guess.size(), system.contacts().size()));
}

/// The linear response with every stop pressing at once from gap zero, or without any.
Eigen::VectorXd linear_response(const HybridSystem& system, const ContactResponse& response, double omega,
                                bool pressed) {
  const Eigen::Index nc = response.contacts(), H = response.harmonics(), B = response.block();
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
      const friction::Clearance& law = *friction::clearance(system.contacts()[static_cast<std::size_t>(c)].law);
      Complex impedance = 0.0;  // of both stops, each half the time
      for (const friction::Stop& stop : law.stops())
        impedance += 0.5 * Complex(stop.stiffness, static_cast<double>(k) * omega * stop.damping);
      A.col(c).head(nc) += response.receptance[at].col(c) * impedance;
      if (k == 0 && nr > 0) A.col(c).tail(nr) = -impedance * response.rigid_rows.row(c).transpose().cast<Complex>();
    }
    const Eigen::VectorXcd y = A.completeOrthogonalDecomposition().solve(b);
    for (Eigen::Index c = 0; c < nc; ++c) {
      x[c * B + k] = y[c].real();
      if (k > 0) x[c * B + H + k] = -y[c].imag();
    }
    if (k == 0) x.tail(nr) = y.tail(nr).real();
  }
  return x;
}

/// A guess's coefficients as unknowns of this order; what floats is given the mean that fits best.
Eigen::VectorXd unknowns_of(const std::vector<Harmonics>& guess, const ContactResponse& response) {
  const Eigen::Index H = response.harmonics(), B = response.block();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(response.unknowns());
  Eigen::VectorXd mean(response.contacts());
  for (Eigen::Index c = 0; c < response.contacts(); ++c) {
    const Harmonics& y = guess[static_cast<std::size_t>(c)];
    const Eigen::Index common = std::min<Eigen::Index>(H, y.order());
    x.segment(c * B, common + 1) = y.cosine.head(common + 1);
    x.segment(c * B + H + 1, common) = y.sine.segment(1, common);
    mean[c] = y.cosine[0] - response.own[0][c].real();
  }
  if (const Eigen::Index nr = response.rigid_rows.cols(); nr > 0)
    x.tail(nr) = response.rigid_rows.completeOrthogonalDecomposition().solve(mean);
  return x;
}

/// From the linear response at no gap to the own gaps, by steps whose length follows Newton's method.
Evaluation grow_gaps(const HybridSystem& system, BalanceProblem& problem, const Eigen::VectorXd& from, double tolerance,
                     int& budget, bool& out_open) {
  constexpr double kEnough = 1e-4, kShortest = 1e-3;
  Eigen::VectorXd before, now = from;
  double share_before = 0.0, share = 0.0, step = 0.5;
  while (budget > 0) {
    const double next = std::min(1.0, share + step);
    problem.set_gaps(system, next);
    Eigen::VectorXd guess = now;
    if (before.size() > 0) guess += (next - share) / (share - share_before) * (now - before);
    Evaluation found = descend(problem, guess, next < 1.0 ? kEnough : tolerance, next < 1.0 ? 5 : 12, budget, out_open);
    const bool arrived = found.relative <= (next < 1.0 ? kEnough : tolerance);
    if (next == 1.0 && (arrived || step < kShortest)) return found;
    if (arrived) {
      before = std::exchange(now, found.x);
      share_before = std::exchange(share, next);
      step *= 2.0;
    } else if ((step *= 0.4) < kShortest) {
      break;
    }
  }
  problem.set_gaps(system, 1.0);
  return problem.evaluate(now);
}

}  // namespace

Balance balance(const HybridSystem& system, const BalanceOptions& options) {
  check(system, options);
  const double omega = system.drive().force()->omega / options.order;
  const ContactResponse response(system, options.order, omega, options.harmonics);
  BalanceProblem problem(system, response, omega, options.samples, response.lead(system, omega));
  int budget = options.max_iterations;
  bool open = false;
  const auto arrived = [&](const Evaluation& at) { return at.relative <= options.tolerance; };
  Evaluation found;
  if (!options.guess.empty()) {
    found = descend(problem, unknowns_of(options.guess, response), options.tolerance, budget, budget, open);
  } else {
    const bool pressed = options.start == BalanceStart::kContact;
    if (pressed)
      found =
          grow_gaps(system, problem, linear_response(system, response, omega, true), options.tolerance, budget, open);
    if (!pressed || !arrived(found)) {
      const Eigen::VectorXd free = linear_response(system, response, omega, false);
      Evaluation other = descend(problem, free, options.tolerance, budget, budget, open);
      if (!pressed || other.relative < found.relative) found = std::move(other);
    }
  }
  Balance out;
  out.converged = found.relative <= 100.0 * options.tolerance;
  out.order = options.order;
  out.omega = omega;
  out.harmonics = options.harmonics;
  out.samples = options.samples;
  const Eigen::Index B = response.block();
  for (Eigen::Index c = 0; c < response.contacts(); ++c) {
    const auto& force = found.forces[static_cast<std::size_t>(c)];
    out.displacement.push_back(harmonics_of(phasors_of(found.x.segment(c * B, B), options.harmonics)));
    out.force.push_back(harmonics_of(force.phasors));
    out.switches += force.switches;
  }
  out.rigid = found.x.tail(response.rigid_rows.cols());
  if (out.rigid.size() > 0) static_cast<void>(problem.step(found, open));  // a start may have been one already
  out.family = open && out.switches == 0 && out.rigid.size() > 0;
  out.residual = found.relative;
  out.iterations = options.max_iterations - budget;
  if (!out.converged)
    out.message = fmt::format(
        "no balance of {} harmonics found: residual {:.2e} after {} Newton steps (asked {:.0e}). Try other harmonics, "
        "another start, or shooting",
        options.harmonics, found.relative, out.iterations, options.tolerance);
  return out;
}

BalanceEquations balance_equations(const HybridSystem& system, const Balance& at) {
  const ContactResponse response(system, at.order, at.omega, at.harmonics);
  const BalanceProblem problem(system, response, at.omega, at.samples, at.harmonics);
  Eigen::VectorXd x = unknowns_of(at.displacement, response);
  x.tail(at.rigid.size()) = at.rigid;
  Evaluation found = problem.evaluate(x);
  return {std::move(found.residual), std::move(found.jacobian)};
}

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
  return state;
}

double value_of(const Harmonics& y, double theta) { return polynomial_of(y).at(theta).y; }

}  // namespace slipmode::orbits
