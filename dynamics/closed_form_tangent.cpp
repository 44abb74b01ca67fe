#include "dynamics/closed_form_flow.hpp"

#include <Eigen/Dense>

namespace slipmode::dynamics {

void ClosedFormFlow::set_tangents(const Eigen::MatrixXd& tangents) { enter_tangents(tangents); }

void ClosedFormFlow::enter_tangents(const Eigen::MatrixXd& tangents) {
  const Regime& r = tables_->regime();
  const Eigen::Index size = r.from_slipping.cols(), internal = tangents.rows() - size;
  const auto of_x = tangents.topRows(size);
  const auto own = tangents.bottomRows(internal);
  regime_tangents_.noalias() = r.from_slipping * of_x;
  if (!oscillator_states_.empty())
    regime_tangents_ += r.from_oscillators * Eigen::MatrixXd(own(oscillator_states_, Eigen::all));
  input_tangents_ = Eigen::MatrixXd::Zero(r.inputs(), tangents.cols());
  for (int c = 0; c < nc_; ++c)
    if (r.sticks(c)) input_tangents_.row(c) = slipping_.displacement_row.col(c).transpose() * of_x;
  for (const int c : compliant_)
    if (r.sticks(c)) input_tangents_.row(c) += own.row(system_.internal_begin(c));
  tangent_time_ = point_.time;
}

void ClosedFormFlow::push_tangents() {
  const Regime& r = tables_->regime();
  const auto np = r.pairs.np;
  const double tau = point_.time - tangent_time_;
  tangent_time_ = point_.time;
  if (tau == 0.0) return;
  for (Eigen::Index i = 0; i < r.pairs.n; ++i) {
    const Eigen::Matrix2d E = r.pairs.exponential(i, tau);
    for (Eigen::Index k = 0; k < regime_tangents_.cols(); ++k) {
      const double a = regime_tangents_(i, k), b = regime_tangents_(np + i, k);
      regime_tangents_(i, k) = E(0, 0) * a + E(0, 1) * b;
      regime_tangents_(np + i, k) = E(1, 0) * a + E(1, 1) * b;
    }
  }
  for (int c = 0; c < nc_; ++c) {
    if (!r.sticks(c)) continue;
    Eigen::VectorXd response = Eigen::VectorXd::Zero(2 * np), held = Eigen::VectorXd::Unit(r.inputs(), c);
    advance(*tables_, tau, response, held);
    regime_tangents_ += response * input_tangents_.row(c);
  }
}

Eigen::MatrixXd ClosedFormFlow::lifted_tangents(const Eigen::MatrixXd& of_x, const Eigen::MatrixXd& of_inputs) const {
  const Regime& r = tables_->regime();
  const Eigen::Index size = r.to_slipping.rows();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size + system_.internal_size(), of_x.cols());
  out.topRows(size).noalias() = r.to_slipping * of_x;
  out.topRows(size).noalias() += r.inputs_slipping * of_inputs;
  for (const int c : compliant_)
    out.row(size + system_.internal_begin(c)) =
        (r.force_row.col(c).transpose() * of_x + r.force_coefficient.col(c).transpose() * of_inputs) /
        resolver_.laws()[static_cast<std::size_t>(c)].stiffness;
  if (!oscillator_states_.empty()) {
    const Eigen::MatrixXd own = r.to_oscillators * of_x;
    for (std::size_t j = 0; j < oscillator_states_.size(); ++j)
      out.row(size + oscillator_states_[j]) = own.row(static_cast<Eigen::Index>(j));
  }
  return out;
}

Eigen::VectorXd ClosedFormFlow::point_rate() const {
  const Regime& r = tables_->regime();
  const auto np = r.pairs.np, V = r.speed_input();
  Eigen::VectorXd rate = r.B * inputs_, input_rate = Eigen::VectorXd::Zero(r.inputs());
  rate.head(np) += r.pairs.g11.cwiseProduct(x_.head(np)) + r.pairs.g12.cwiseProduct(x_.tail(np));
  rate.tail(np) += r.pairs.g21.cwiseProduct(x_.head(np)) + r.pairs.g22.cwiseProduct(x_.tail(np));
  for (int c = 0; c < nc_; ++c)
    if (r.sticks(c)) input_rate(c) = inputs_(V);
  input_rate(V) = inputs_(V + 1);
  if (const DriveOverlay* overlay = regime_->overlay.get()) {
    const DrivePhase phase = overlay->phase(point_.time);
    rate += overlay->omega() * overlay->state.rates(phase);
    input_rate += overlay->omega() * overlay->inputs.rates(phase);
  }
  return lifted_tangents(rate, input_rate);
}

ClosedFormFlow::Saltation ClosedFormFlow::before_event(const Guard& guard) {
  push_tangents();
  const Regime& r = tables_->regime();
  const Eigen::RowVectorXd reached = guard.sign * (r.row.col(guard.output).transpose() * regime_tangents_ +
                                                   r.coefficient.col(guard.output).transpose() * input_tangents_);
  return {tangents(), reached / evaluate(guard, point_.time).rate, point_rate(), point_.modes};
}

void ClosedFormFlow::after_event(Saltation salted) {
  // δ⁺ = R δ⁻ + (f⁺ − R f⁻) δg/ġ: each tangent moves on with f⁻ until its own event, then back with f⁺. R resets the
  // stretch of contact springs whose contact point jumped, or that lost contact.
  const Eigen::Index size = slipping_.to_q.cols();
  for (const int c : compliant_) {
    const auto i = static_cast<std::size_t>(c);
    const ContactMode before = salted.modes[i], after = point_.modes[i];
    const bool jumped = before == ContactMode::kStick && after == ContactMode::kStick && resolver_.has_event(c);
    const bool parted = before != after && (before == ContactMode::kSeparated || after == ContactMode::kSeparated);
    if (!jumped && !parted) continue;
    Eigen::RowVectorXd reset = Eigen::RowVectorXd::Zero(size + system_.internal_size());
    if (jumped) reset = resolver_.slide_stretch_gradient(point_, c);
    const Eigen::Index row = size + system_.internal_begin(c);
    const Eigen::RowVectorXd tangents = reset * salted.tangents;
    salted.rate(row) = reset * salted.rate;
    salted.tangents.row(row) = tangents;
  }
  // f⁺ needs the regime entered; its own tangents are not set yet.
  salted.tangents += (point_rate() - salted.rate) * salted.delay;
  enter_tangents(salted.tangents);
}

}  // namespace slipmode::dynamics
