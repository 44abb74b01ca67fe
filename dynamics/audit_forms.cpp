#include "dynamics/audit_forms.hpp"

#include "dynamics/kernels/kernels.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>

namespace slipmode::dynamics {
namespace {

/// Sums of two decay rates below this share of the drive's frequency leave too few digits in a form.
constexpr double kSlowest = 1e-5;

Eigen::Matrix2d block(const ModalModel& pairs, Eigen::Index i) {
  return (Eigen::Matrix2d() << pairs.g11(i), pairs.g12(i), pairs.g21(i), pairs.g22(i)).finished();
}

/// Factors of a pair's components that make its block's entries of one size.
Eigen::Vector2d scales(const ModalModel& pairs, Eigen::Index i) {
  const double up = std::abs(pairs.g12(i)), down = std::abs(pairs.g21(i));
  return {up > 0.0 && down > 0.0 ? std::sqrt(down / up) : 1.0, 1.0};
}

/// Slowest decay of a pair: the smallest −Re of its eigenvalues.
double decay(const Eigen::Matrix2d& G) {
  const double half = G.trace() / 2.0, gap = half * half - G.determinant();
  return gap <= 0.0 ? -half : -half > 0.0 ? G.determinant() / (-half + std::sqrt(gap)) : -half - std::sqrt(gap);
}

/// q̇ᵀCq̇ of the steady motion as a form of its cosines and sines, the last two of nu. Constant inputs move nothing.
Eigen::MatrixXd viscous_powers(const ModalModel& slipping, const DriveOverlay& overlay, Eigen::Index nu) {
  const Eigen::VectorXd c = overlay.slipping.c.col(0), s = overlay.slipping.s.col(0);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(nu, nu);
  P.bottomRightCorner<2, 2>() << slipping.viscous_power(c, c), slipping.viscous_power(c, s),
      slipping.viscous_power(s, c), slipping.viscous_power(s, s);
  return P;
}

}  // namespace

std::unique_ptr<AuditForms> AuditForms::make(const Regime& r, const ModalModel& slipping, const DriveOverlay& overlay) {
  const ModalModel& pairs = r.pairs;
  const auto np = pairs.np, ni = r.inputs(), nu = ni + 2, nc = r.speed_input();
  if (overlay.orders() > 1) return nullptr;
  for (Eigen::Index i = 0; i < pairs.n; ++i)
    if (!(2.0 * decay(block(pairs, i)) > kSlowest * overlay.omega())) return nullptr;
  std::unique_ptr<AuditForms> forms(new AuditForms(r, overlay));

  // x = x_f + S u, ι = E u.
  Eigen::MatrixXd S(2 * np, nu), E = Eigen::MatrixXd::Zero(ni, nu);
  S << r.particular, overlay.state.c, overlay.state.s;
  E.leftCols(ni).setIdentity();
  E.col(ni) = overlay.inputs.c;
  E.col(ni + 1) = overlay.inputs.s;
  const auto steady = [&](const auto& row, const auto& coefficient) -> Eigen::VectorXd {
    return S.transpose() * row + E.transpose() * coefficient;
  };
  const Eigen::VectorXd speed = E.row(r.speed_input()).transpose();
  const auto none = [&] {
    return Power{Eigen::MatrixXd::Zero(2 * np, 2 * np), Eigen::MatrixXd::Zero(2 * np, nu),
                 Eigen::MatrixXd::Zero(nu, nu)};
  };
  Power contact = none(), drive = none(), viscous = none(), force = none();
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Eigen::VectorXd f = r.force_row.col(c), v = r.velocity_row.col(c);
    Eigen::VectorXd f_steady = steady(f, r.force_coefficient.col(c));
    // Not by the row: behind a stiff contact spring that is a small difference too.
    f_steady.tail<2>() << overlay.force.c(c, 0), overlay.force.s(c, 0);
    const Eigen::VectorXd v_steady = steady(v, r.velocity_coefficient.col(c));
    if (r.spring(c) > 0.0) {  // ∫ λ wᵀq̇ dt = ∫ λ v_drive dt − [½ λ²/K_c]
      contact.R += f * speed.transpose();
      contact.P += f_steady * speed.transpose();
    } else if (r.slope(c) == 0.0) {
      contact.Q += (f * v.transpose() + v * f.transpose()) / 2.0;
      contact.R += f * v_steady.transpose() + v * f_steady.transpose();
      contact.P += f_steady * v_steady.transpose();
    }
    drive.R += f * speed.transpose();
    drive.P += f_steady * speed.transpose();
  }
  for (Eigen::Index k = 0; k < r.forces; ++k) {
    const Eigen::VectorXd v = r.drive_row.col(k), u = E.row(r.force_input(k)).transpose();
    force.R += v * u.transpose();
    force.P += steady(v, r.drive_coefficient.col(k)) * u.transpose();
  }
  // The velocities of a steady motion are small differences of what its pairs hold: LᵀL would be a difference of their
  // squares.
  const Eigen::MatrixXd& L = pairs.dissipation_root;
  if (pairs.n > 0 && L.size() == 0) {
    viscous.Q.bottomRightCorner(np, np).diagonal() = pairs.damping;
    viscous.R = 2.0 * viscous.Q * S;
  } else if (pairs.n > 0) {
    viscous.Q = L.transpose() * L;
    viscous.R = 2.0 * (L.transpose() * (L * S));
  }
  viscous.R += 2.0 * r.viscous_cross * speed.transpose();
  viscous.P = viscous_powers(slipping, overlay, nu);
  if (!forms->integrate(contact, forms->contact_) || !forms->integrate(drive, forms->drive_) ||
      !forms->integrate(viscous, forms->viscous_) || !forms->integrate(force, forms->force_))
    return nullptr;
  return forms;
}

bool AuditForms::solve_quadratic(const Eigen::MatrixXd& Q, Eigen::MatrixXd& out_Y) const {
  if (Q.isZero(0.0)) return true;
  const ModalModel& pairs = regime_.pairs;
  const auto np = pairs.np;
  out_Y = Eigen::MatrixXd::Zero(2 * np, 2 * np);
  for (Eigen::Index i = 0; i < pairs.n; ++i)
    for (Eigen::Index j = i; j < pairs.n; ++j) {
      // In scaled displacements, ω η, the blocks' entries are of one size, so that a slow decay is not lost beside ω².
      const Eigen::Vector2d si = scales(pairs, i), sj = scales(pairs, j);
      Eigen::Matrix2d q;
      q << Q(i, j), Q(i, np + j), Q(np + i, j), Q(np + i, np + j);
      if (q.isZero(0.0)) continue;
      q = (si.cwiseInverse().asDiagonal() * q * sj.cwiseInverse().asDiagonal()).eval();
      // (I ⊗ G_iᵀ + G_jᵀ ⊗ I) vec Y = vec Q, columns stacked.
      const Eigen::Matrix2d Gi = si.asDiagonal() * block(pairs, i) * si.cwiseInverse().asDiagonal();
      const Eigen::Matrix2d Gj = sj.asDiagonal() * block(pairs, j) * sj.cwiseInverse().asDiagonal();
      Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
      A.topLeftCorner<2, 2>() = A.bottomRightCorner<2, 2>() = Gi.transpose();
      A.topLeftCorner<2, 2>().diagonal().array() += Gj(0, 0);
      A.bottomRightCorner<2, 2>().diagonal().array() += Gj(1, 1);
      A.topRightCorner<2, 2>().diagonal().array() += Gj(1, 0);
      A.bottomLeftCorner<2, 2>().diagonal().array() += Gj(0, 1);
      const Eigen::Vector4d y = A.partialPivLu().solve(Eigen::Map<const Eigen::Vector4d>(q.data()));
      if (!y.allFinite()) return false;
      const Eigen::Matrix2d Y = si.asDiagonal() * Eigen::Map<const Eigen::Matrix2d>(y.data()) * sj.asDiagonal();
      const double both = i == j ? 1.0 : 2.0;
      out_Y(j, i) = both * Y(0, 0);
      out_Y(np + j, np + i) = both * Y(1, 1);
      out_Y(np + i, j) += both * Y(1, 0);
      out_Y(np + j, i) += both * Y(0, 1);
    }
  return true;
}

bool AuditForms::integrate(const Power& power, Form& out) const {
  out.none = power.Q.isZero(0.0) && power.R.isZero(0.0) && power.P.isZero(0.0);
  if (out.none) return true;
  const ModalModel& pairs = regime_.pairs;
  const auto np = pairs.np, ni = regime_.inputs();
  if (!solve_quadratic(power.Q, out.Y)) return false;
  out.constant = Eigen::MatrixXd::Zero(2 * np, ni);
  out.cosine = out.sine = Eigen::VectorXd::Zero(2 * np);
  using Complex = std::complex<double>;
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const Eigen::Matrix2d Gt = block(pairs, i).transpose();
    const Eigen::Matrix2d inverse = Gt.inverse();
    for (Eigen::Index k = 0; k < ni; ++k) {
      const Eigen::Vector2d y = inverse * Eigen::Vector2d(power.R(i, k), power.R(np + i, k));
      out.constant(i, k) = y(0);
      out.constant(np + i, k) = y(1);
    }
    Eigen::Matrix2cd A = Gt.cast<Complex>();
    A.diagonal().array() += Complex(0.0, overlay_.omega());
    const Eigen::Vector2cd r(Complex(power.R(i, ni), -power.R(i, ni + 1)),
                             Complex(power.R(np + i, ni), -power.R(np + i, ni + 1)));
    const Eigen::Vector2cd y = A.inverse() * r;
    out.cosine(i) = y(0).real();
    out.sine(i) = -y(0).imag();
    out.cosine(np + i) = y(1).real();
    out.sine(np + i) = -y(1).imag();
  }
  out.steady = power.P;
  return out.constant.allFinite() && out.cosine.allFinite() && out.sine.allFinite();
}

void AuditForms::Form::set_inputs(const Eigen::VectorXd& inputs) {
  const auto ni = inputs.size();
  resting.noalias() = constant * inputs;
  along_cosine = inputs.dot(steady.col(ni).head(ni)) + inputs.dot(steady.row(ni).head(ni));
  along_sine = inputs.dot(steady.col(ni + 1).head(ni)) + inputs.dot(steady.row(ni + 1).head(ni));
}

double AuditForms::value(const Form& form, double stay, DrivePhase p) const {
  if (form.none) return 0.0;
  const auto ni = regime_.inputs();
  double sum = free_.dot(form.cosine) * p.cosine + free_.dot(form.sine) * p.sine + free_.dot(form.resting);
  for (Eigen::Index j = 0; j < form.Y.cols(); j += kLanes) {
    const Eigen::Index below = free_.size() - j;
    const Eigen::Matrix<double, kLanes, 1> columns =
        form.Y.block<Eigen::Dynamic, kLanes>(j, j, below, kLanes).transpose() * free_.tail(below);
    sum += columns.dot(free_.segment<kLanes>(j));
  }
  // ∫ uᵀPu over the stay, with the integrals of cos θ, sin θ, cos² θ, cos θ sin θ and sin² θ.
  const double w = overlay_.omega();
  const Eigen::MatrixXd& P = form.steady;
  sum += (form.along_cosine * p.sine - form.along_sine * p.cosine) / w;
  const double both = p.sine * p.cosine / (2.0 * w);
  sum += P(ni, ni) * (stay / 2.0 + both) + P(ni + 1, ni + 1) * (stay / 2.0 - both);
  sum += (P(ni, ni + 1) + P(ni + 1, ni)) * p.sine * p.sine / (2.0 * w);
  return sum;
}

double AuditForms::contact_potential(DrivePhase p, const Eigen::VectorXd& x) const {
  const Regime& r = regime_;
  double sum = 0.0;
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) {
    if (r.spring(c) > 0.0) {
      const double force =
          r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs_) + overlay_.force.at(c, p);
      sum -= force * force / (2.0 * r.spring(c));
    } else if (r.slope(c) != 0.0) {
      const double at = r.displacement_row.col(c).dot(x) + r.displacement_coefficient.col(c).dot(inputs_) +
                        overlay_.displacement.at(c, p);
      sum += inputs_(c) * at + r.slope(c) * at * at / 2.0;
    }
  }
  return sum;
}

StayWork AuditForms::values(double t, const Eigen::VectorXd& x) {
  const DrivePhase p = overlay_.phase(t);
  const double stay = t - begin_;
  free_.noalias() = x - resting_;
  return {value(contact_, stay, p) + contact_potential(p, x), value(drive_, stay, p), value(viscous_, stay, p),
          value(force_, stay, p)};
}

void AuditForms::begin(double t, const Eigen::VectorXd& x, const Eigen::VectorXd& inputs) {
  begin_ = t;
  inputs_ = inputs;
  for (Form* form : {&contact_, &drive_, &viscous_, &force_})
    if (!form->none) form->set_inputs(inputs);
  resting_.noalias() = regime_.particular * inputs;
  at_begin_ = values(t, x);
}

StayWork AuditForms::until(double t, const Eigen::VectorXd& x) {
  const StayWork now = values(t, x);
  const StayWork work{now.contact - at_begin_.contact, now.drive - at_begin_.drive, now.viscous - at_begin_.viscous,
                      now.force - at_begin_.force};
  at_begin_ = now;
  return work;
}

}  // namespace slipmode::dynamics
