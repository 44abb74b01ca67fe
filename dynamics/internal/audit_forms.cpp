#include "dynamics/internal/audit_forms.hpp"

#include <slipmode/core/kernels/kernels.hpp>
#include "dynamics/internal/quadratic_forms.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// q̇ᵀCq̇ of the steady motion as a form of its cosines and sines, the last two of nu. Constant inputs move nothing.
Eigen::MatrixXd viscous_powers(const ModalModel& slipping, const DriveOverlay& overlay, Eigen::Index nu) {
  const Eigen::VectorXd c = overlay.slipping.c.col(0), s = overlay.slipping.s.col(0);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(nu, nu);
  P.bottomRightCorner<2, 2>() << slipping.viscous_power(c, c), slipping.viscous_power(c, s),
      slipping.viscous_power(s, c), slipping.viscous_power(s, s);
  return P;
}

}  // namespace

AuditForms::AuditForms(const Regime& r, const RegimeForms& forms, const ModalModel& slipping,
                       const DriveOverlay& overlay)
    : regime_(r), forms_(forms), slipping_(slipping), overlay_(overlay) {
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) acting_.push_back(c);
  acting_.push_back(r.speed_input() + 2);
  harmonic_ = Eigen::MatrixXd::Zero(kLanes, 2 * r.pairs.np);
  constant_.assign((acting_.size() + 1) / 2, harmonic_);
  held_ = r.to_slipping * r.particular + r.inputs_slipping;
}

std::unique_ptr<AuditForms> AuditForms::make(const RegimeTables& tables, const ModalModel& slipping,
                                             const DriveOverlay& overlay) {
  const Regime& r = tables.regime();
  const ModalModel& pairs = r.pairs;
  const auto np = pairs.np, ni = r.inputs(), nu = ni + 2, nc = r.speed_input();
  if (overlay.orders() > 1 || !overlay.resonances.empty()) return nullptr;
  if (!decays(pairs, overlay.omega())) return nullptr;
  const RegimeForms& squares = quadratic_forms(tables, slipping);
  if (!squares.found) return nullptr;
  std::unique_ptr<AuditForms> forms(new AuditForms(r, squares, slipping, overlay));

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
  const Power none{Eigen::MatrixXd::Zero(2 * np, nu), Eigen::MatrixXd::Zero(nu, nu)};
  Power contact = none, drive = none, viscous = none, force = none;
  for (Eigen::Index c = 0; c < nc; ++c) {
    const Eigen::VectorXd f = r.force_row.col(c), v = r.velocity_row.col(c);
    // Not by the row: behind a stiff contact spring that is a small difference.
    Eigen::VectorXd f_steady(nu);
    f_steady << r.steady_force.col(c), overlay.force.c(c, 0), overlay.force.s(c, 0);
    const Eigen::VectorXd v_steady = steady(v, r.velocity_coefficient.col(c));
    if (r.spring(c) > 0.0) {  // ∫ λ wᵀq̇ dt = ∫ λ v_drive dt − [½ λ²/K_c]
      contact.R += f * speed.transpose();
      contact.P += f_steady * speed.transpose();
    } else if (r.slope(c) == 0.0) {
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
  const Eigen::MatrixXd& L = pairs.dissipation_root;
  if (pairs.n > 0 && L.size() == 0)
    viscous.R.bottomRows(np) = 2.0 * pairs.damping.asDiagonal() * S.bottomRows(np);
  else if (pairs.n > 0)
    viscous.R = 2.0 * (L.transpose() * (L * S));
  viscous.R += 2.0 * r.viscous_cross * speed.transpose();
  viscous.P = viscous_powers(slipping, overlay, nu);
  if (!forms->integrate(kContact, contact) || !forms->integrate(kDrive, drive) ||
      !forms->integrate(kViscous, viscous) || !forms->integrate(kForce, force))
    return nullptr;
  return forms;
}

bool AuditForms::integrate(Kind kind, const Power& power) {
  const ModalModel& pairs = regime_.pairs;
  const auto np = pairs.np, ni = regime_.inputs();
  using Complex = std::complex<double>;
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const Eigen::Matrix2d Gt = block(pairs, i).transpose();
    const Eigen::Matrix2d inverse = Gt.inverse();
    for (std::size_t k = 0; k < acting_.size(); ++k) {
      const auto input = acting_[k];
      const Eigen::Vector2d y = inverse * Eigen::Vector2d(power.R(i, input), power.R(np + i, input));
      const Eigen::Index lane = kind + (k % 2 == 0 ? 0 : kKinds);
      constant_[k / 2](lane, i) = y(0);
      constant_[k / 2](lane, np + i) = y(1);
    }
    Eigen::Matrix2cd A = Gt.cast<Complex>();
    A.diagonal().array() += Complex(0.0, overlay_.omega());
    const Eigen::Vector2cd r(Complex(power.R(i, ni), -power.R(i, ni + 1)),
                             Complex(power.R(np + i, ni), -power.R(np + i, ni + 1)));
    const Eigen::Vector2cd y = A.inverse() * r;
    for (const Eigen::Index row : {Eigen::Index{0}, Eigen::Index{1}}) {
      harmonic_(kind, row * np + i) = y(row).real();
      harmonic_(kKinds + kind, row * np + i) = -y(row).imag();
    }
  }
  const Eigen::MatrixXd& P = power.P;
  steady_[kind] = {.along_cosine = P.col(ni).head(ni) + P.row(ni).head(ni).transpose(),
                   .along_sine = P.col(ni + 1).head(ni) + P.row(ni + 1).head(ni).transpose(),
                   .cosine = P(ni, ni),
                   .sine = P(ni + 1, ni + 1),
                   .both = P(ni, ni + 1) + P(ni + 1, ni)};
  bool finite = harmonic_.allFinite();
  for (const Eigen::MatrixXd& of_inputs : constant_) finite &= of_inputs.allFinite();
  return finite;
}

double AuditForms::Stay::steady(std::size_t kind, double stay, DrivePhase p) const {
  // With the integrals of cos θ, sin θ, cos² θ, cos θ sin θ and sin² θ over the stay.
  const Steady& s = forms_->steady_[kind];
  const double w = forms_->overlay_.omega(), both = p.sine * p.cosine / (2.0 * w);
  return (along_cosine_[kind] * p.sine - along_sine_[kind] * p.cosine) / w + s.cosine * (stay / 2.0 + both) +
         s.sine * (stay / 2.0 - both) + s.both * p.sine * p.sine / (2.0 * w);
}

double AuditForms::Stay::free_loss(const StayPlace& at, DrivePhase p) {
  if (!forms_->forms_.viscous_is_energy) return quadratic(forms_->forms_.viscous, at.free);
  lifted_ = at.slipping - resting_;
  forms_->overlay_.slipping.add(p, -1.0, lifted_);
  return -free_energy(forms_->regime_, forms_->slipping_, lifted_, at.free);
}

double AuditForms::Stay::contact_potential(DrivePhase p, const Eigen::VectorXd& x) const {
  const Regime& r = forms_->regime_;
  double sum = 0.0;
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) {
    if (r.spring(c) > 0.0) {
      const double force =
          r.force_row.col(c).dot(x) + r.force_coefficient.col(c).dot(inputs_) + forms_->overlay_.force.at(c, p);
      sum -= force * force / (2.0 * r.spring(c));
    } else if (r.slope(c) != 0.0) {
      const double at = r.displacement_row.col(c).dot(x) + r.displacement_coefficient.col(c).dot(inputs_) +
                        forms_->overlay_.displacement.at(c, p);
      sum += inputs_(c) * at + r.slope(c) * at * at / 2.0;
    }
  }
  return sum;
}

AuditForms::Stay::Values AuditForms::Stay::values(const StayPlace& at) {
  const DrivePhase p = forms_->overlay_.phase(at.time);
  const auto& vector = kernels::kernels();
  alignas(64) std::array<double, std::size_t{2} * kKinds> sums{};
  Values out{};
  const auto add = [&](const Eigen::MatrixXd& rows, double first, double second) {
    vector.node_sums(rows.data(), at.free.data(), at.free.size(), nullptr, sums.data());
    for (std::size_t kind = 0; kind < kKinds; ++kind) out.add(kind, first * sums[kind] + second * sums[kKinds + kind]);
  };
  add(forms_->harmonic_, p.cosine, p.sine);
  for (std::size_t k = 0; k < forms_->constant_.size(); ++k)
    add(forms_->constant_[k], inputs_(forms_->acting_[2 * k]),
        2 * k + 1 < forms_->acting_.size() ? inputs_(forms_->acting_[2 * k + 1]) : 0.0);
  for (const Kind kind : {kContact, kDrive, kViscous, kForce}) out.add(kind, steady(kind, at.time - begin_, p));
  out.add(kContact, quadratic(forms_->forms_.contact, at.free));
  out.add(kContact, contact_potential(p, at.x));
  out.add(kViscous, free_loss(at, p));
  return out;
}

void AuditForms::Stay::begin(const AuditForms& forms, const StayPlace& at, const Eigen::VectorXd& inputs) {
  forms_ = &forms;
  begin_ = at.time;
  inputs_ = inputs;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    along_cosine_[kind] = forms.steady_[kind].along_cosine.dot(inputs);
    along_sine_[kind] = forms.steady_[kind].along_sine.dot(inputs);
  }
  if (forms.forms_.viscous_is_energy) {
    resting_.setZero(forms.held_.rows());
    kernels::kernels().product(forms.held_.data(), forms.held_.rows(), forms.held_.cols(), inputs.data(),
                               resting_.data());
  }
  at_begin_ = values(at);
}

StayWork AuditForms::Stay::until(const StayPlace& at) {
  const Values now = values(at);
  const auto change = [&](Kind kind) { return now.of[kind] - at_begin_.of[kind]; };
  const StayWork work{change(kContact), change(kDrive), change(kViscous), change(kForce),
                      std::numeric_limits<double>::epsilon() * (now.size + at_begin_.size)};
  at_begin_ = now;
  return work;
}

}  // namespace slipmode::dynamics
