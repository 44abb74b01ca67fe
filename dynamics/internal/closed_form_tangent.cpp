#include "dynamics/internal/closed_form_flow.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numbers>
#include <utility>

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
    if (force_tangents_.rows() > 0) prepare_forced(maps);
  }
  x_tangents_.noalias() = now.maps->enter * tangents_;
  if (force_tangents_.rows() > 0) add_forced(now.maps->forced_state, force_change(point_.time), -1.0, x_tangents_);
  follow_tangents_.noalias() = now.maps->enter_follows * tangents_;
  tangent_time_ = point_.time;
}

void ClosedFormFlow::set_tangents(Eigen::MatrixXd tangents, Eigen::MatrixXd forces) {
  tangents_ = std::move(tangents);
  if (forces.rows() != force_tangents_.rows())
    for (Visited& visited : visited_) visited.maps.reset();  // made for other orders
  force_tangents_ = std::move(forces);
  carries_ = true;
  if (regime_->steady) enter_regime();
  enter_tangents();
  tangents_current_ = false;
}

void ClosedFormFlow::prepare_forced(TangentMaps& out_maps) const {
  const Regime& r = regime_->tables->regime();
  const Eigen::Index orders = (force_tangents_.rows() / r.forces - 1) / 2;
  for (int direction = 0; orders > 0 && direction < r.forces; ++direction) {
    friction::Force unit{.omega = regime_->overlay->omega()};
    for (int order = 1; order <= orders; ++order)
      unit.harmonics.push_back(
          {.amplitude = 1.0, .phase = 0.5 * std::numbers::pi, .order = order, .direction = direction});
    const DriveOverlay answer(r, slipping_, unit);
    out_maps.forced_state.emplace_back(unpadded_rows(answer.state.c, r.pairs.n),
                                       unpadded_rows(answer.state.s, r.pairs.n));
    out_maps.forced_outputs.push_back(answer.outputs[0]);
    out_maps.forced_resonances.push_back(answer.resonances);
  }
}

ClosedFormFlow::ForceChange ClosedFormFlow::force_change(double t) const {
  // a cos jθ + b sin jθ is answered by c (a cos jθ + b sin jθ) + s (a sin jθ − b cos jθ) if cos jθ is by c cos jθ + s
  // sin jθ.
  const Eigen::Index directions = regime_->tables->regime().forces, block = force_tangents_.rows() / directions,
                     orders = (block - 1) / 2;
  ForceChange out;
  out.cosine.resize(directions * orders, force_tangents_.cols());
  out.sine.resizeLike(out.cosine);
  out.value.resize(directions, force_tangents_.cols());
  const DrivePhase first = phase_at(t);
  for (Eigen::Index d = 0; d < directions; ++d) {
    out.value.row(d) = force_tangents_.row(d * block);
    DrivePhase p;
    for (Eigen::Index j = 0; j < orders; ++j) {
      p = p.times(first);
      const auto a = force_tangents_.row(d * block + 1 + j), b = force_tangents_.row(d * block + 1 + orders + j);
      out.cosine.row(d * orders + j) = p.cosine * a + p.sine * b;
      out.sine.row(d * orders + j) = p.sine * a - p.cosine * b;
      out.value.row(d) += out.cosine.row(d * orders + j);
    }
  }
  return out;
}

void ClosedFormFlow::add_forced(const std::vector<DriveOverlay::Amplitudes>& answers, const ForceChange& change,
                                double factor, Eigen::MatrixXd& out_rows) {
  Eigen::Index next = 0;
  for (const DriveOverlay::Amplitudes& answer : answers) {
    const Eigen::Index orders = answer.c.cols();
    out_rows += factor * (answer.c * change.cosine.middleRows(next, orders));
    out_rows += factor * (answer.s * change.sine.middleRows(next, orders));
    next += orders;
  }
}

void ClosedFormFlow::push_tangents() {
  tangents_current_ = false;
  const double begin = std::exchange(tangent_time_, point_.time), tau = point_.time - begin;
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
  push_resonances(begin, tau);
  const auto hold = [&](Eigen::Index input, const auto& tangents) {
    Eigen::VectorXd response = Eigen::VectorXd::Zero(2 * np);
    Eigen::VectorXd held = Eigen::VectorXd::Unit(r.inputs(), input);
    advance(*tables_, tau, response, held);
    x_tangents_ += unpadded_rows(response, n) * tangents;
  };
  for (std::size_t k = 0; k < regime_->maps->follows.size(); ++k)
    hold(regime_->maps->follows[k], follow_tangents_.row(static_cast<Eigen::Index>(k)));
  for (Eigen::Index d = 0; force_tangents_.rows() > 0 && d < r.forces; ++d)
    hold(r.force_input(d), force_tangents_.row(d * (force_tangents_.rows() / r.forces)));
}

void ClosedFormFlow::push_resonances(double begin, double tau) {
  // a cos jθ + b sin jθ is Re (a − ib) e^{ijθ}, and (a − ib) e^{ijθ} is cosine + i sine of `force_change`.
  const std::vector<std::vector<DriveOverlay::Resonance>>& directions = regime_->maps->forced_resonances;
  if (std::ranges::all_of(directions, [](const auto& own) { return own.empty(); })) return;
  const Regime& r = tables_->regime();
  const ForceChange change = force_change(begin);
  const Eigen::Index orders = change.cosine.rows() / r.forces;
  for (std::size_t d = 0; d < directions.size(); ++d)
    for (const DriveOverlay::Resonance& own : directions[d]) {
      const Eigen::Vector2cd moved = own.moved(r, regime_->overlay->omega(), tau);
      const Eigen::Index k = static_cast<Eigen::Index>(d) * orders + own.order - 1;
      for (const Eigen::Index row : {Eigen::Index{0}, Eigen::Index{1}})
        x_tangents_.row(row * r.pairs.n + own.pair) +=
            moved(row).real() * change.cosine.row(k) - moved(row).imag() * change.sine.row(k);
    }
}

const Eigen::MatrixXd& ClosedFormFlow::tangents() {
  if (!tangents_current_) {
    const TangentMaps& maps = *regime_->maps;
    tangents_.noalias() = maps.leave * x_tangents_;
    for (std::size_t k = 0; k < maps.follows.size(); ++k)
      tangents_ += maps.leave_inputs.col(maps.follows[k]) * follow_tangents_.row(static_cast<Eigen::Index>(k));
    if (force_tangents_.rows() > 0) {
      const Regime& r = tables_->regime();
      const ForceChange change = force_change(point_.time);
      Eigen::MatrixXd steady = Eigen::MatrixXd::Zero(x_tangents_.rows(), x_tangents_.cols());
      add_forced(maps.forced_state, change, 1.0, steady);
      tangents_.noalias() += maps.leave * steady;
      tangents_.noalias() += maps.leave_inputs.middleCols(r.force_input(0), r.forces) * change.value;
    }
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
    for (Eigen::Index i = 0; i < n; ++i) {
      x_rate_(i) += overlay->state_rate.at(i, phase);
      x_rate_(n + i) += overlay->state_rate.at(np + i, phase);
    }
    overlay->input_rate.add(phase, 1.0, input_rate_);
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
    if (force_tangents_.rows() > 0) {
      const Eigen::Index block = force_tangents_.rows() / r.forces;
      Eigen::MatrixXd outputs = Eigen::MatrixXd::Zero(r.row.cols(), force_tangents_.cols());
      add_forced(maps.forced_outputs, force_change(point_.time), 1.0, outputs);
      delay_ += outputs.row(guard->output);
      for (Eigen::Index d = 0; d < r.forces; ++d)
        delay_ += r.coefficient(r.force_input(d), guard->output) * force_tangents_.row(d * block);
    }
    // Reached at rest, as where a motion starts on a stop: when is nobody's, and forces do not jump there.
    const double rate = evaluate(*guard, point_.time).rate;
    delay_ *= guard->at_once || rate == 0.0 ? 0.0 : guard->sign / rate;
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
