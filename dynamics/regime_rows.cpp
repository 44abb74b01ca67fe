#include "dynamics/internal/regime_build.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Two forms of one row agree to this share of its largest entry; the errors of either are far below.
constexpr double kNear = 1e-8;

}  // namespace

void RegimeBuilder::make_inputs(Regime& out) const {
  // M η̈ = force: what the inputs put into the equations of y and of ζ.
  Eigen::MatrixXd force = -K_ * P_;
  force.col(V_) -= C_ * P_all_;
  force.col(one_) += modal_.load;
  force.rightCols(nk_) += modal_.forces;
  Eigen::MatrixXd lift = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(oscillators_.size()), ni_);
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    if (role(c) == ContactRole::kHeld) continue;
    force.col(c) += (role(c) == ContactRole::kSprung ? law(c).stiffness : 1.0) * w;
  }
  for (Eigen::Index j = 0; j < lift.rows(); ++j) {
    const Eigen::Index c = oscillators_[static_cast<std::size_t>(j)];
    const auto w = modal_.directions.col(c);
    lift.row(j) = load(c).lift * (w.transpose() * P_);
    lift(j, V_) += load(c).lift_rate * w.dot(P_all_);
    lift(j, one_) += load(c).lift * load(c).offset;
  }
  out.B = at_.from_rate * left_of(force) + at_.from_zeta_rate * lift;
  out.B_follows = Eigen::VectorXd::Zero(out.B.rows());
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (out.follows[static_cast<std::size_t>(c)]) out.B_follows += out.B.col(c);
  out.forcing.resize(out.B.rows(), out.B.cols() + 1);
  out.forcing << out.B, out.B_follows;
  const Eigen::MatrixXd dissipation = (modal_.damping + modal_.damping.transpose()) / 2.0;
  out.viscous_cross = ((P_all_.transpose() * dissipation) * Z_ * at_.to_rate).transpose();
  out.viscous_drive = P_all_.dot(dissipation * P_all_);
}

void RegimeBuilder::make_contact_rows(Regime& out) const {
  const auto np2 = 2 * out.pairs.np;
  const Eigen::MatrixXd eta = Z_ * at_.to_y, eta_rate = Z_ * at_.to_rate;
  out.force_row = out.velocity_row = Eigen::MatrixXd::Zero(np2, nc_);
  out.force_coefficient = out.velocity_coefficient = Eigen::MatrixXd::Zero(ni_, nc_);
  out.displacement_row = eta.transpose() * modal_.directions;
  out.displacement_coefficient = P_.transpose() * modal_.directions;
  out.drive_row = eta_rate.transpose() * modal_.forces;
  out.drive_coefficient = Eigen::MatrixXd::Zero(ni_, nk_);
  out.drive_coefficient.row(V_) = P_all_.transpose() * modal_.forces;
  out.spring = out.slope = Eigen::VectorXd::Zero(nc_);
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const auto w = modal_.directions.col(c);
    auto row = out.force_row.col(c), coefficient = out.force_coefficient.col(c);
    if (role(c) != ContactRole::kHeld) {
      out.velocity_row.col(c) = eta_rate.transpose() * w;
      out.velocity_coefficient(V_, c) = w.dot(P_all_);
      coefficient(c) = 1.0;
      if (role(c) == ContactRole::kSprung) {
        out.spring(c) = law(c).stiffness;
        row = -law(c).stiffness * (eta.transpose() * w);
        coefficient = -law(c).stiffness * (P_.transpose() * w);
        coefficient(c) += law(c).stiffness;
      }
    } else {
      out.velocity_coefficient(V_, c) = 1.0;
      row = (eta.transpose() * K_ + eta_rate.transpose() * C_.transpose()) * P_.col(c);
      coefficient = P_.transpose() * (K_ * P_.col(c));
      coefficient(V_) += P_.col(c).dot(C_ * P_all_);
      coefficient(V_ + 1) += P_.col(c).dot(P_all_);
      coefficient(one_) -= P_.col(c).dot(modal_.load);
      coefficient.tail(nk_) -= modal_.forces.transpose() * P_.col(c);
      for (Eigen::Index d = 0; d < nc_; ++d) {
        if (role(d) == ContactRole::kHeld) continue;
        const double share = P_.col(c).dot(modal_.directions.col(d));
        coefficient(d) -= share * (role(d) == ContactRole::kSprung ? law(d).stiffness : 1.0);
      }
    }
    for (std::size_t j = 0; j < oscillators_.size(); ++j) {
      // Friction under the load of an oscillator: on the contact itself, or felt by a held one.
      const Eigen::Index d = oscillators_[j];
      const double share = role(c) == ContactRole::kHeld ? -P_.col(c).dot(modal_.directions.col(d))
                           : c == d                      ? 1.0
                                                         : 0.0;
      row += share * friction_(d) *
             (load(d).z * at_.to_zeta.row(static_cast<Eigen::Index>(j)) +
              load(d).z_rate * at_.to_zeta_rate.row(static_cast<Eigen::Index>(j)))
                 .transpose();
    }
    if (role(c) == ContactRole::kLeftStop || role(c) == ContactRole::kRightStop) {
      row -= spring_(c) * (eta.transpose() * w) + damper_(c) * (eta_rate.transpose() * w);
      coefficient -= spring_(c) * (P_.transpose() * w);
      coefficient(V_) -= damper_(c) * w.dot(P_all_);
    }
    if (friction_(c) != 0.0) {
      if (!load(c).oscillates()) out.slope(c) = friction_(c) * load(c).y;
      row += friction_(c) * (load(c).y * (eta.transpose() * w) + load(c).v * (eta_rate.transpose() * w));
      coefficient += friction_(c) * load(c).y * (P_.transpose() * w);
      coefficient(V_) += friction_(c) * load(c).v * w.dot(P_all_);
    }
  }
}

void RegimeBuilder::refine_stick_rows(Regime& out) const {
  // A contact's stretch, or the stiffness of a fine mesh times its deformation, gives the force of a slow motion as a
  // small difference. The equations of the slipping pairs give it too, b λ = T G − G_s T less what the other contacts
  // exert, each with an error that its own rate and that of the motion make: least squares, weighted by these errors.
  // Springs that share a place are told apart by their stretches alone: what is refined is what they exert together.
  std::vector<Eigen::Index> open;  // the first of each place
  std::vector<std::vector<Eigen::Index>> together;
  for (const std::vector<std::size_t>& same : along_) {
    std::vector<Eigen::Index> follow;
    for (const std::size_t c : same)
      if (out.follows[c]) follow.push_back(static_cast<Eigen::Index>(c));
    if (follow.empty()) continue;
    open.push_back(follow.front());
    together.push_back(std::move(follow));
  }
  const ModalModel &own = out.pairs, &s = slipping_;
  if (open.empty() || own.n == 0) return;
  const Eigen::MatrixXd T = modal_.from_eta * (Z_ * at_.to_y) + modal_.from_eta_rate * (Z_ * at_.to_rate);
  const Eigen::MatrixXd b = s.input(Eigen::all, open);
  for (Eigen::Index i = 0; i < own.n; ++i) {
    const std::array<Eigen::Index, 2> pair{i, own.np + i};
    const Eigen::MatrixXd t = T(Eigen::all, pair);
    const Eigen::Matrix2d G = (Eigen::Matrix2d() << own.g11(i), own.g12(i), own.g21(i), own.g22(i)).finished();
    if (G.isZero(0.0)) continue;  // a part that floats free moves without a rate to weigh errors by, nor do they grow
    Eigen::MatrixXd missing = t * G;
    missing.topRows(s.np) -= s.g11.asDiagonal() * t.topRows(s.np) + s.g12.asDiagonal() * t.bottomRows(s.np);
    missing.bottomRows(s.np) -= s.g21.asDiagonal() * t.topRows(s.np) + s.g22.asDiagonal() * t.bottomRows(s.np);
    for (Eigen::Index c = 0; c < nc_; ++c)
      if (!out.follows[static_cast<std::size_t>(c)]) missing -= s.input.col(c) * out.force_row(pair, c).transpose();
    const double rate = std::sqrt(std::max(std::abs(G.determinant()), G.squaredNorm() * 1e-16));
    Eigen::VectorXd weight(2 * s.np);
    for (Eigen::Index k = 0; k < s.np; ++k) {
      const double slip_rate = s.proportional ? std::abs(s.g21(k)) / std::max(rate, 1e-300) + std::abs(s.g22(k))
                                              : std::hypot(s.g11(k), s.g12(k)) + std::hypot(s.g21(k), s.g22(k));
      weight(k) = weight(s.np + k) = 1.0 / std::max(rate + slip_rate, 1e-300);
    }
    const Eigen::MatrixXd refined =
        (weight.asDiagonal() * b).colPivHouseholderQr().solve(Eigen::MatrixXd(weight.asDiagonal() * missing));
    for (std::size_t k = 0; k < open.size(); ++k) {
      // Both are exact but for rounding. Where they are not near, it is these equations that tell the contacts apart
      // badly.
      const Eigen::VectorXd all = out.force_row(Eigen::all, together[k]).rowwise().sum();
      const Eigen::Vector2d better = refined.row(static_cast<Eigen::Index>(k)).transpose(), off = better - all(pair);
      if (!(off.norm() <= kNear * all.cwiseAbs().maxCoeff())) continue;
      if (together[k].size() == 1) {
        out.force_row.col(open[k])(pair) = better;
        continue;
      }
      double stiffness = 0.0;
      for (const Eigen::Index c : together[k]) stiffness += law(c).stiffness;
      for (const Eigen::Index c : together[k]) out.force_row.col(c)(pair) += law(c).stiffness / stiffness * off;
    }
  }
}

void RegimeBuilder::add_clearance_outputs(Eigen::Index c, const Regime& out, const AddOutput& add) const {
  const Eigen::VectorXd y = out.displacement_row.col(c), rate = out.velocity_row.col(c);
  Eigen::VectorXd y_coefficient = out.displacement_coefficient.col(c);
  y_coefficient(one_) += load(c).offset;
  const bool flying = role(c) == ContactRole::kLeftFlight || role(c) == ContactRole::kRightFlight;
  if (role(c) == ContactRole::kGap || flying || law(c).clearance.loss == friction::ContactLoss::kGap)
    add(c, RegimeOutput::Kind::kDisplacement, y, y_coefficient);
  if (role(c) == ContactRole::kGap || law(c).clearance.loss == friction::ContactLoss::kGap) return;
  const friction::Stop& own = *stop(c);
  const double side = role(c) == ContactRole::kLeftStop || role(c) == ContactRole::kLeftFlight ? -1.0 : 1.0;
  Eigen::VectorXd coefficient =
      side * (own.stiffness * y_coefficient + own.damping * Eigen::VectorXd(out.velocity_coefficient.col(c)));
  coefficient(one_) -= own.stiffness * own.gap;
  add(c, RegimeOutput::Kind::kPress, side * (own.stiffness * y + own.damping * rate), std::move(coefficient));
}

void RegimeBuilder::make_outputs(Regime& out) const {
  const auto np2 = 2 * out.pairs.np;
  const Eigen::MatrixXd eta = Z_ * at_.to_y, eta_rate = Z_ * at_.to_rate;
  std::vector<Eigen::VectorXd> rows, coefficients;
  const auto add = [&](Eigen::Index c, RegimeOutput::Kind kind, Eigen::VectorXd row, Eigen::VectorXd coefficient) {
    out.outputs.push_back({static_cast<int>(c), kind});
    rows.push_back(std::move(row));
    coefficients.push_back(std::move(coefficient));
  };
  for (Eigen::Index c = 0; c < nc_; ++c) {
    if (law(c).kind == LawKind::kClearance) add_clearance_outputs(c, out, add);
    if (!law(c).sticks()) continue;
    const auto w = modal_.directions.col(c);
    const bool varies = load(c).varies();
    Eigen::VectorXd load_row = Eigen::VectorXd::Zero(np2), load_coefficient = Eigen::VectorXd::Zero(ni_);
    if (varies) {
      load_row = load(c).y * (eta.transpose() * w) + load(c).v * (eta_rate.transpose() * w);
      load_coefficient = load(c).y * (P_.transpose() * w);
      load_coefficient(V_) += load(c).v * w.dot(P_all_);
      load_coefficient(one_) += load(c).constant;
      const auto own = std::find(oscillators_.begin(), oscillators_.end(), c);
      if (own != oscillators_.end()) {
        const auto j = static_cast<Eigen::Index>(own - oscillators_.begin());
        load_row += (load(c).z * at_.to_zeta.row(j) + load(c).z_rate * at_.to_zeta_rate.row(j)).transpose();
      }
    }
    const Eigen::VectorXd force_row = out.force_row.col(c), force_coefficient = out.force_coefficient.col(c);
    if (role(c) != ContactRole::kSeparated) {
      if (!out.follows[static_cast<std::size_t>(c)]) {
        Eigen::VectorXd row = -out.velocity_row.col(c), coefficient = -out.velocity_coefficient.col(c);
        coefficient(V_) += 1.0;
        if (friction_(c) != 0.0 && law(c).stiffness > 0.0) {
          Eigen::VectorXd stretch_rate = force_row, drift = force_coefficient;
          out.differentiate(stretch_rate, drift);
          row -= stretch_rate / law(c).stiffness;
          coefficient -= drift / law(c).stiffness;
        }
        add(c, RegimeOutput::Kind::kSpeed, row, coefficient);
      } else if (!varies) {
        add(c, RegimeOutput::Kind::kForce, force_row, force_coefficient);
      } else {
        const double up = law(c).static_coefficient(1.0), down = law(c).static_coefficient(-1.0);
        add(c, RegimeOutput::Kind::kExcess, up * load_row - force_row, up * load_coefficient - force_coefficient);
        add(c, RegimeOutput::Kind::kReserve, down * load_row + force_row, down * load_coefficient + force_coefficient);
      }
    }
    if (varies) add(c, RegimeOutput::Kind::kLoad, load_row, load_coefficient);
  }
  const auto no = static_cast<Eigen::Index>(rows.size());
  out.row.resize(np2, no);
  out.coefficient.resize(ni_, no);
  for (Eigen::Index k = 0; k < no; ++k) {
    out.row.col(k) = rows[static_cast<std::size_t>(k)];
    out.coefficient.col(k) = coefficients[static_cast<std::size_t>(k)];
  }
}

void RegimeBuilder::make_changes(Regime& out) const {
  out.from_slipping =
      at_.from_y * (Z_.transpose() * modal_.to_eta) + at_.from_rate * (Z_.transpose() * modal_.to_eta_rate);
  out.to_slipping = modal_.from_eta * (Z_ * at_.to_y) + modal_.from_eta_rate * (Z_ * at_.to_rate);
  out.inputs_slipping = modal_.from_eta * P_;
  out.inputs_slipping.col(V_) += modal_.from_eta_rate * P_all_;
  const auto k = static_cast<Eigen::Index>(oscillators_.size());
  out.from_oscillators.resize(2 * out.pairs.np, 2 * k);
  out.to_oscillators.resize(2 * k, 2 * out.pairs.np);
  for (Eigen::Index j = 0; j < k; ++j) {
    out.from_oscillators.col(2 * j) = at_.from_zeta.col(j);
    out.from_oscillators.col(2 * j + 1) = at_.from_zeta_rate.col(j);
    out.to_oscillators.row(2 * j) = at_.to_zeta.row(j);
    out.to_oscillators.row(2 * j + 1) = at_.to_zeta_rate.row(j);
  }
}

}  // namespace slipmode::dynamics
