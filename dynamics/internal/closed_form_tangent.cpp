#include "dynamics/internal/closed_form_flow.hpp"

#include <Eigen/Dense>

namespace slipmode::dynamics {
namespace {

/// Rows of padded pairs [2np x k] without the padding [2n x k].
Eigen::MatrixXd unpadded_rows(const Eigen::MatrixXd& rows, Eigen::Index n) {
  Eigen::MatrixXd out(2 * n, rows.cols());
  out << rows.topRows(n), rows.middleRows(rows.rows() / 2, n);
  return out;
}

Eigen::MatrixXd unpadded_columns(const Eigen::MatrixXd& columns, Eigen::Index n) {
  return unpadded_rows(columns.transpose(), n).transpose();
}

}  // namespace

void ClosedFormFlow::enter_tangents() {
  Visited& now = *regime_;
  if (!now.maps) {
    const Regime& r = now.tables->regime();
    const Eigen::Index n = slipping_.n, m = r.pairs.n, internal = system_.internal_size(), N = 2 * n + internal;
    now.maps = std::make_unique<TangentMaps>();
    TangentMaps& maps = *now.maps;
    for (int c = 0; c < nc_; ++c)
      if (r.sticks(c)) maps.follows.push_back(c);
    const auto nf = static_cast<Eigen::Index>(maps.follows.size());
    maps.enter = Eigen::MatrixXd::Zero(2 * m, N);
    maps.leave = Eigen::MatrixXd::Zero(N, 2 * m);
    maps.leave_inputs = Eigen::MatrixXd::Zero(N, r.inputs());
    maps.enter_follows = Eigen::MatrixXd::Zero(nf, N);
    maps.row = unpadded_rows(r.row, m);
    maps.B = unpadded_rows(r.B, m);
    maps.enter.leftCols(2 * n) = unpadded_columns(unpadded_rows(r.from_slipping, m), n);
    maps.leave.topRows(2 * n) = unpadded_columns(unpadded_rows(r.to_slipping, n), m);
    maps.leave_inputs.topRows(2 * n) = unpadded_rows(r.inputs_slipping, n);
    const Eigen::MatrixXd displacement = unpadded_rows(slipping_.displacement_row, n);
    for (Eigen::Index k = 0; k < nf; ++k)
      maps.enter_follows.row(k).head(2 * n) = displacement.col(maps.follows[static_cast<std::size_t>(k)]).transpose();
    for (const int c : compliant_) {
      const Eigen::Index own = 2 * n + system_.internal_begin(c);
      const double stiffness = resolver_.laws()[static_cast<std::size_t>(c)].stiffness;
      maps.leave.row(own) = unpadded_rows(r.force_row.col(c), m).transpose() / stiffness;
      maps.leave_inputs.row(own) = r.force_coefficient.col(c).transpose() / stiffness;
      for (Eigen::Index k = 0; k < nf; ++k)
        if (maps.follows[static_cast<std::size_t>(k)] == c) maps.enter_follows(k, own) = 1.0;
    }
    const Eigen::MatrixXd from_own = unpadded_rows(r.from_oscillators, m);
    const Eigen::MatrixXd to_own = unpadded_columns(r.to_oscillators, m);
    for (std::size_t j = 0; j < oscillator_states_.size(); ++j) {
      maps.enter.col(2 * n + oscillator_states_[j]) = from_own.col(static_cast<Eigen::Index>(j));
      maps.leave.row(2 * n + oscillator_states_[j]) = to_own.row(static_cast<Eigen::Index>(j));
    }
  }
  x_tangents_.noalias() = now.maps->enter * tangents_;
  follow_tangents_.noalias() = now.maps->enter_follows * tangents_;
  tangent_time_ = point_.time;
}

void ClosedFormFlow::set_tangents(Eigen::MatrixXd tangents) {
  tangents_ = std::move(tangents);
  carries_ = true;
  enter_tangents();
  tangents_current_ = false;
}

void ClosedFormFlow::push_tangents() {
  tangents_current_ = false;
  const double tau = point_.time - tangent_time_;
  tangent_time_ = point_.time;
  if (tau == 0.0) return;
  const Regime& r = tables_->regime();
  const auto n = r.pairs.n, np = r.pairs.np;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix2d E = r.pairs.exponential(i, tau);
    for (Eigen::Index k = 0; k < x_tangents_.cols(); ++k) {
      const double a = x_tangents_(i, k), b = x_tangents_(n + i, k);
      x_tangents_(i, k) = E(0, 0) * a + E(0, 1) * b;
      x_tangents_(n + i, k) = E(1, 0) * a + E(1, 1) * b;
    }
  }
  for (std::size_t k = 0; k < regime_->maps->follows.size(); ++k) {
    Eigen::VectorXd response = Eigen::VectorXd::Zero(2 * np);
    Eigen::VectorXd held = Eigen::VectorXd::Unit(r.inputs(), regime_->maps->follows[k]);
    advance(*tables_, tau, response, held);
    x_tangents_ += unpadded_rows(response, n) * follow_tangents_.row(static_cast<Eigen::Index>(k));
  }
}

const Eigen::MatrixXd& ClosedFormFlow::tangents() {
  if (!tangents_current_) {
    const TangentMaps& maps = *regime_->maps;
    tangents_.noalias() = maps.leave * x_tangents_;
    for (std::size_t k = 0; k < maps.follows.size(); ++k)
      tangents_ += maps.leave_inputs.col(maps.follows[k]) * follow_tangents_.row(static_cast<Eigen::Index>(k));
    tangents_current_ = true;
  }
  return tangents_;
}

const Eigen::VectorXd& ClosedFormFlow::point_rate() {
  const Regime& r = tables_->regime();
  const TangentMaps& maps = *regime_->maps;
  const auto n = r.pairs.n, np = r.pairs.np, V = r.speed_input();
  x_rate_.noalias() = maps.B * inputs_;
  for (Eigen::Index i = 0; i < n; ++i) {
    x_rate_(i) += r.pairs.g11(i) * x_(i) + r.pairs.g12(i) * x_(np + i);
    x_rate_(n + i) += r.pairs.g21(i) * x_(i) + r.pairs.g22(i) * x_(np + i);
  }
  input_rate_.setZero(r.inputs());
  for (const int c : maps.follows) input_rate_(c) = inputs_(V);
  input_rate_(V) = inputs_(V + 1);
  if (const DriveOverlay* overlay = regime_->overlay) {
    const DrivePhase phase = phase_at(point_.time);
    const double w = overlay->omega();
    for (Eigen::Index i = 0; i < n; ++i) {
      x_rate_(i) += w * overlay->state.rate(i, phase);
      x_rate_(n + i) += w * overlay->state.rate(np + i, phase);
    }
    for (Eigen::Index k = 0; k < input_rate_.size(); ++k) input_rate_(k) += w * overlay->inputs.rate(k, phase);
  }
  rate_.noalias() = maps.leave * x_rate_;
  rate_.noalias() += maps.leave_inputs * input_rate_;
  return rate_;
}

void ClosedFormFlow::leave_tangents(const Guard* guard) {
  push_tangents();
  const TangentMaps& maps = *regime_->maps;
  const Regime& r = tables_->regime();
  delay_.setZero(x_tangents_.cols());
  if (guard != nullptr) {
    delay_.noalias() = maps.row.col(guard->output).transpose() * x_tangents_;
    for (std::size_t k = 0; k < maps.follows.size(); ++k)
      delay_ += r.coefficient(maps.follows[k], guard->output) * follow_tangents_.row(static_cast<Eigen::Index>(k));
    delay_ *= guard->sign / evaluate(*guard, point_.time).rate;
  }
  static_cast<void>(tangents());
  rate_before_ = point_rate();
  modes_before_ = point_.modes;
}

void ClosedFormFlow::salt_tangents() {
  // Each tangent moves on with f⁻ until its own event, then back with f⁺. R resets the stretch of contact springs whose
  // contact point jumped, or that lost contact.
  const Eigen::Index n = slipping_.n, internal = system_.internal_size();
  for (const int c : compliant_) {
    const auto i = static_cast<std::size_t>(c);
    const ContactMode before = modes_before_[i], after = point_.modes[i];
    const bool jumped = before == ContactMode::kStick && after == ContactMode::kStick && resolver_.has_event(c);
    const bool parted = before != after && (before == ContactMode::kSeparated || after == ContactMode::kSeparated);
    if (!jumped && !parted) continue;
    Eigen::RowVectorXd reset = Eigen::RowVectorXd::Zero(2 * n + internal);
    if (jumped) {
      const Eigen::RowVectorXd padded = resolver_.slide_stretch_gradient(point_, c);
      reset << padded.head(n), padded.segment(slipping_.np, n), padded.tail(internal);
    }
    const Eigen::Index row = 2 * n + system_.internal_begin(c);
    const double rate = reset * rate_before_;
    const Eigen::RowVectorXd tangents = reset * tangents_;
    rate_before_(row) = rate;
    tangents_.row(row) = tangents;
  }
  // f⁺ needs the maps of the regime entered.
  enter_tangents();
  rate_before_ = point_rate() - rate_before_;
  tangents_.noalias() += rate_before_ * delay_;
  enter_tangents();
  tangents_current_ = false;
}

}  // namespace slipmode::dynamics
