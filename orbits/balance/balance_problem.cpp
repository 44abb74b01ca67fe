#include "orbits/balance/internal/balance_problem.hpp"

#include <slipmode/dynamics/cache.hpp>
#include <slipmode/dynamics/receptance.hpp>
#include <slipmode/friction/places.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
using dynamics::HybridSystem;

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

}  // namespace

Eigen::VectorXcd drive_phasors(const HybridSystem& system, Eigen::Index order, Eigen::Index k) {
  Eigen::VectorXcd forces = Eigen::VectorXcd::Zero(system.force_directions().cols());
  const friction::Force* force = system.drive().force();
  if (force == nullptr) return forces;
  for (const friction::ForceHarmonic& h : force->harmonics)
    if (h.order * order == k) forces[h.direction] += h.amplitude * Complex(std::sin(h.phase), -std::cos(h.phase));
  return forces;
}

ContactResponse::ContactResponse(const HybridSystem& system, int order, Eigen::Index harmonics)
    : contacts_at(friction::by_place(system.contacts())),
      counterpart(counterpart_motion(system.drive(), order, harmonics)),
      order_(order),
      harmonics_(harmonics),
      omega_(system.drive().omega() / order) {
  const dynamics::ModalModel& model = system.cache().tables(system, false).model;
  const dynamics::ModalCoordinates& modal = model.modal;
  const Eigen::Index n = modal.omega.size();
  const Eigen::Index np = places();
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(np, np), directions(n, np), model_inputs(model.input.rows(), np),
                  rows(model.displacement_row.rows(), np);
  Eigen::VectorXd e(np);
  for (Eigen::Index p = 0; p < np; ++p) {
    const std::size_t first = contacts_at[static_cast<std::size_t>(p)].front();
    const auto c = static_cast<Eigen::Index>(first);
    e[p] = system.contacts()[first].offset;
    directions.col(p) = modal.directions.col(c);
    model_inputs.col(p) = model.input.col(c);
    rows.col(p) = model.displacement_row.col(c);
  }
  std::vector<Eigen::Index> floating;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (modal.omega[i] == 0.0) {
      floating.push_back(i);
      continue;
    }
    const Eigen::VectorXd row = directions.row(i).transpose() / modal.omega[i];
    R += row * row.transpose();
    e += row * (modal.load[i] / modal.omega[i]);
  }
  rigid_rows.resize(np, static_cast<Eigen::Index>(floating.size()));
  rigid_load.resize(rigid_rows.cols());
  for (Eigen::Index r = 0; r < rigid_rows.cols(); ++r) {
    rigid_rows.col(r) = directions.row(floating[static_cast<std::size_t>(r)]).transpose();
    rigid_load[r] = modal.load[floating[static_cast<std::size_t>(r)]];
  }
  receptance.emplace_back(R.cast<Complex>());
  own.emplace_back(e.cast<Complex>());
  for (Eigen::Index k = 1; k <= harmonics; ++k) {
    Eigen::MatrixXcd inputs(2 * model.np, np + 1);
    inputs << model_inputs.cast<Complex>(), model.force_input * drive_phasors(system, order, k);
    const Eigen::MatrixXcd answers =
        rows.transpose() * pair_receptances(model, static_cast<double>(k) * omega_, inputs);
    receptance.emplace_back(answers.leftCols(np));
    own.emplace_back(answers.col(np));
  }
}

Eigen::Index ContactResponse::order_of(Eigen::Index unknown) const {
  const Eigen::Index within = unknown < places() * block() ? unknown % block() : 0;
  return within <= harmonics_ ? within : within - harmonics_;
}

Eigen::Index ContactResponse::lead(const HybridSystem& system) const {
  constexpr Eigen::Index kFew = 120;
  constexpr double kWeak = 0.005;
  if (harmonics_ <= kFew) return harmonics_;
  const std::vector<BalancedLaw> laws = balanced_laws(system);
  for (Eigen::Index k = harmonics_; k > kFew / 2; --k) {
    double most = 0.0;
    for (Eigen::Index p = 0; p < places(); ++p) {
      double strength = 0.0;
      for (const std::size_t c : contacts_at[static_cast<std::size_t>(p)])
        strength += strongest(laws[c], static_cast<double>(k) * omega_);
      most = std::max(most, receptance[static_cast<std::size_t>(k)].col(p).cwiseAbs().sum() * strength);
    }
    if (most > kWeak) return k;
  }
  return kFew / 2;
}

BalanceProblem::BalanceProblem(const HybridSystem& system, const ContactResponse& response, int samples,
                               Eigen::Index lead)
    : response_(response),
      samples_(samples),
      lead_(lead),
      symmetric_(is_symmetric(system) && response.order() % 2 == 1),
      own_laws_(balanced_laws(system)),
      laws_(own_laws_) {
  for (Eigen::Index i = 0; i < response.unknowns(); ++i) {
    const Eigen::Index order = response.order_of(i);
    if (order % 2 == 0) even_.push_back(i);
    if (order > lead) continue;
    all_.push_back(i);
    if (order % 2 == 1) odd_.push_back(i);
  }
}

void BalanceProblem::set_share(double share) {
  for (std::size_t c = 0; c < laws_.size(); ++c) laws_[c] = at_share(own_laws_[c], share);
}

BalanceEvaluation BalanceProblem::evaluate(const Eigen::VectorXd& x, Parity parity) const {
  const bool odd = parity == Parity::kOdd;
  const Orders leading = odd ? Orders::odd(lead_) : Orders(lead_);
  const Eigen::Index nc = response_.places(), H = response_.harmonics(), B = response_.block();
  const Eigen::Index nr = response_.rigid_rows.cols(), own = leading.numbers(), N = nc * own + (odd ? 0 : nr);
  BalanceEvaluation out{x, Eigen::VectorXd(x.size()), parity, Eigen::MatrixXd::Identity(N, N), {}, {}, 0.0};
  out.forces.resize(laws_.size(), BalancedForce(0, 0));
  for (Eigen::Index p = 0; p < nc; ++p) {
    const TrigonometricPolynomial y{phasors_of(x.segment(p * B, B), H)};
    const std::vector<std::size_t>& here = response_.contacts_at[static_cast<std::size_t>(p)];
    for (const std::size_t c : here) {
      BalancedForce whole =
          balanced_force(laws_[c], seen_by(laws_[c], y, response_.counterpart), response_.omega(), samples_, leading);
      BalancedForce& force = out.forces[c];
      force.phasors = whole.phasors;
      force.switches = whole.switches;
      force.stuck = whole.stuck;
      if (c == here.front()) {
        out.sums.push_back(std::move(whole));
      } else {
        out.sums.back().phasors += whole.phasors;
        out.sums.back().jacobian += whole.jacobian;
      }
    }
  }
  for (Eigen::Index c = 0; c < nc; ++c) {
    Eigen::VectorXcd missing = phasors_of(x.segment(c * B, B), H);
    for (Eigen::Index k = 0; k <= H; ++k) {
      const auto at = static_cast<std::size_t>(k);
      missing[k] -= response_.own[at][c];
      for (Eigen::Index d = 0; d < nc; ++d)
        missing[k] -= response_.receptance[at](c, d) * out.sums[static_cast<std::size_t>(d)].phasors[k];
    }
    if (nr > 0) missing[0] -= response_.rigid_rows.row(c).dot(x.tail(nr));
    out.residual.segment(c * B, B) = numbers_of(missing);
    for (Eigen::Index d = 0; d < nc; ++d) take_off(c, d, out);
    if (!odd) out.jacobian.row(c * own).tail(nr) = -response_.rigid_rows.row(c);
  }
  add_equilibrium(out);
  out.relative = out.residual.head(nc * B).cwiseAbs().maxCoeff() / size_of(x);
  if (nr > 0) {  // forces in units of those that the displacements' size makes
    double force = response_.rigid_load.cwiseAbs().maxCoeff();
    for (const BalancedForce& f : out.sums) force = std::max(force, f.phasors.cwiseAbs().maxCoeff());
    if (force > 0.0) out.relative = std::max(out.relative, out.residual.tail(nr).cwiseAbs().maxCoeff() / force);
  }
  return out;
}

bool BalanceProblem::leaves_means_open(const BalanceEvaluation& at) const {
  constexpr double kNothing = 1e-12;
  return std::ranges::all_of(at.sums, [](const BalancedForce& force) {
    return force.jacobian.col(0).norm() <= kNothing * force.jacobian.norm();
  });
}

Eigen::VectorXd BalanceProblem::step(const BalanceEvaluation& at) const {
  const std::vector<Eigen::Index>& solved = at.parity == Parity::kOdd ? odd_ : all_;
  Eigen::VectorXd rest(std::ssize(solved));
  for (Eigen::Index i = 0; i < rest.size(); ++i) rest[i] = -at.residual[solved[static_cast<std::size_t>(i)]];
  bool open = false;
  const Eigen::VectorXd newton = least_norm_solution(at.jacobian, rest, open);
  Eigen::VectorXd step = -at.residual;
  for (Eigen::Index i = 0; i < rest.size(); ++i) step[solved[static_cast<std::size_t>(i)]] = newton[i];
  return step;
}

Parity BalanceProblem::parity_of(const Eigen::VectorXd& x) const {
  const bool odd = symmetric_ && std::ranges::all_of(even_, [&](Eigen::Index i) { return x[i] == 0.0; });
  return odd ? Parity::kOdd : Parity::kAll;
}

bool BalanceProblem::leaves_something_open(const BalanceEvaluation& at) const {
  bool open = false;
  static_cast<void>(least_norm_solution(at.jacobian, Eigen::VectorXd::Zero(at.jacobian.rows()), open));
  return open;
}

double BalanceProblem::size_of(const Eigen::VectorXd& x) const {
  double size = std::max(x.head(response_.places() * response_.block()).cwiseAbs().maxCoeff(),
                         response_.counterpart.phasors.cwiseAbs().maxCoeff());
  for (const Eigen::VectorXcd& e : response_.own) size = std::max(size, e.cwiseAbs().maxCoeff());
  return size > 0.0 ? size : 1.0;
}

void BalanceProblem::take_off(Eigen::Index c, Eigen::Index d, BalanceEvaluation& out) const {
  const BalancedForce& force = out.sums[static_cast<std::size_t>(d)];
  const Orders& leading = force.leading;
  const Eigen::Index B = leading.numbers(), L = leading.count, sines = B - L;
  Eigen::ArrayXd re(L), im(L);
  for (Eigen::Index i = 0; i < L; ++i) {
    const Complex R = response_.receptance[static_cast<std::size_t>(leading.at(i))](c, d);
    re[i] = R.real();
    im[i] = R.imag();
  }
  for (Eigen::Index i = 0; i < B; ++i) {
    const auto cosine = force.jacobian.col(i).array().head(L), sine = force.jacobian.col(i).array().tail(sines);
    auto column = out.jacobian.col(d * B + i).segment(c * B, B).array();
    column.head(L) -= re * cosine;
    column.segment(L - sines, sines) -= im.tail(sines) * sine;
    column.tail(sines) -= re.tail(sines) * sine - im.tail(sines) * cosine.tail(sines);
  }
}

void BalanceProblem::add_equilibrium(BalanceEvaluation& out) const {
  const Eigen::Index nr = response_.rigid_rows.cols();
  if (nr == 0) return;
  out.residual.tail(nr) = response_.rigid_load;
  const bool unknown = out.parity == Parity::kAll;
  if (unknown) out.jacobian.bottomRightCorner(nr, nr).setZero();
  for (Eigen::Index d = 0; d < response_.places(); ++d) {
    const BalancedForce& force = out.sums[static_cast<std::size_t>(d)];
    const Eigen::VectorXd z = response_.rigid_rows.row(d).transpose();
    const Eigen::Index B = force.leading.numbers();
    out.residual.tail(nr) += z * force.phasors[0].real();
    if (unknown) out.jacobian.block(response_.places() * B, d * B, nr, B) = z * force.jacobian.row(0);
  }
}

Balance BalanceProblem::series_of(const BalanceEvaluation& at, int order) const {
  Balance out;
  out.order = order;
  out.omega = response_.omega();
  out.harmonics = static_cast<int>(response_.harmonics());
  out.samples = samples_;
  const Eigen::Index B = response_.block();
  out.displacement.resize(at.forces.size());
  for (Eigen::Index p = 0; p < response_.places(); ++p) {
    const Harmonics y = harmonics_of(phasors_of(at.x.segment(p * B, B), response_.harmonics()));
    for (const std::size_t c : response_.contacts_at[static_cast<std::size_t>(p)]) out.displacement[c] = y;
  }
  for (const BalancedForce& force : at.forces) {
    out.force.push_back(harmonics_of(force.phasors));
    out.switches += force.switches;
    out.stuck += force.stuck ? 1 : 0;
  }
  out.rigid = at.x.tail(response_.rigid_rows.cols());
  out.residual = at.relative;
  return out;
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, bool& out_singular) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(A);
  const Eigen::VectorXd pivots = lu.matrixLU().diagonal().cwiseAbs();
  out_singular = !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff());
  if (!out_singular) return lu.solve(b);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> orthogonal;
  orthogonal.setThreshold(1e-12);
  return orthogonal.compute(A).solve(b);
}

Eigen::VectorXd unknowns_of(const std::vector<Harmonics>& guess, const ContactResponse& response) {
  const Eigen::Index H = response.harmonics(), B = response.block();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(response.unknowns());
  Eigen::VectorXd mean(response.places());
  for (Eigen::Index c = 0; c < response.places(); ++c) {
    const Harmonics& y = guess[response.contacts_at[static_cast<std::size_t>(c)].front()];
    const Eigen::Index common = std::min<Eigen::Index>(H, y.order());
    x.segment(c * B, common + 1) = y.cosine.head(common + 1);
    x.segment(c * B + H + 1, common) = y.sine.segment(1, common);
    mean[c] = y.cosine[0] - response.own[0][c].real();
  }
  if (const Eigen::Index nr = response.rigid_rows.cols(); nr > 0)
    x.tail(nr) = response.rigid_rows.completeOrthogonalDecomposition().solve(mean);
  return x;
}

}  // namespace slipmode::orbits
