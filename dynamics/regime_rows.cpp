#include "dynamics/internal/quadratic_forms.hpp"
#include "dynamics/internal/regime_build.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace slipmode::dynamics {
namespace {

/// Two forms of one row agree to this share of its largest entry; the errors of either are far below.
constexpr double kNear = 1e-8;
/// The same of what springs do to the pairs, and of steady forces once that is known.
constexpr double kNearer = 1e-11, kNearest = 1e-13;
/// Rounding, of what a sum is made of.
constexpr double kRoundsBy = 64.0 * std::numeric_limits<double>::epsilon();

/// D speeds; of a diagonal D in O(n).
Eigen::MatrixXd damped(const auto& D, bool diagonal, const auto& speeds) {
  if (diagonal) return D.diagonal().asDiagonal() * speeds;
  return D * speeds;
}

/// Of motion along either coordinate of a pair.
Eigen::RowVector2d rates_of(const Eigen::Matrix2d& G) {
  Eigen::RowVector2d rates = G.diagonal().cwiseAbs().transpose();
  if (G(1, 0) != 0.0) rates.setConstant(std::sqrt(std::abs(G.determinant())));
  // A place that floats moves at the rate at which its speed decays.
  if (rates.minCoeff() == 0.0) rates.setConstant(rates.maxCoeff());
  return rates.cwiseMax(1e-8 * G.norm());
}

/// x of along · x = known, each equation with its error, beside x = own with its, 0 where that is exact: least squares,
/// column by column, of the change from `own` in units of its error.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& along, const Eigen::MatrixXd& known, const Eigen::MatrixXd& error,
                              const Eigen::MatrixXd& own, const Eigen::MatrixXd& own_error) {
  const auto rows = along.rows(), count = along.cols();
  Eigen::MatrixXd out = own, left(rows + count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + count);
  for (Eigen::Index j = 0; j < known.cols(); ++j) {
    const auto unit = own_error.col(j).asDiagonal();
    left << error.col(j).cwiseInverse().asDiagonal() * along * unit, Eigen::MatrixXd::Identity(count, count);
    right.head(rows) = (known.col(j) - along * own.col(j)).cwiseQuotient(error.col(j));
    out.col(j) += unit * left.colPivHouseholderQr().solve(right);
  }
  return out;
}

}  // namespace

Eigen::MatrixXd RegimeBuilder::of_forces(const Eigen::MatrixXd& along) const {
  Eigen::MatrixXd out(2 * n_, along.cols());
  out << Eigen::MatrixXd::Zero(n_, along.cols()), along;
  return out;
}

Eigen::MatrixXd RegimeBuilder::mode_rates(const Eigen::MatrixXd& states) const {
  const auto place = states.topRows(n_), speed = states.bottomRows(n_);
  Eigen::MatrixXd out(2 * n_, states.cols());
  out << speed,
      -(modal_.omega.cwiseAbs2().asDiagonal() * place) - damped(modal_.damping, slipping_.proportional, speed);
  return out;
}

Eigen::MatrixXd RegimeBuilder::of_mode_rates(const Eigen::MatrixXd& columns) const {
  const auto place = columns.topRows(n_), speed = columns.bottomRows(n_);
  Eigen::MatrixXd out(2 * n_, columns.cols());
  out << -(modal_.omega.cwiseAbs2().asDiagonal() * speed),
      place - damped(modal_.damping.transpose(), slipping_.proportional, speed);
  return out;
}

Eigen::MatrixXd RegimeBuilder::mode_errors(const Eigen::Matrix2d& G, const Eigen::MatrixXd& at_rate,
                                           const Eigen::MatrixXd& beside) const {
  const Eigen::RowVector2d rates = rates_of(G);
  Eigen::MatrixXd out(2 * n_, 2);
  for (Eigen::Index j = 0; j < 2; ++j) {
    const double rate = rates(j),
                 moves = std::max(rate * at_rate.col(j).cwiseAbs().maxCoeff(), beside.col(j).cwiseAbs().maxCoeff());
    const Eigen::VectorXd own = modal_.omega.cwiseAbs2() / std::max(rate, 1e-300) + most_damped_;
    out.col(j) = ((rate + own.array()).max(1e-300) * moves).replicate(2, 1);
  }
  return out;
}

void RegimeBuilder::make_inputs(Regime& out) const {
  // M η̈ = force: what the inputs put into the equations of y and of ζ.
  Eigen::MatrixXd force = -KP_;
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
  const Eigen::MatrixXd dissipation = (modal_.damping + modal_.damping.transpose()) / 2.0;
  out.viscous_cross = ((P_all_.transpose() * dissipation) * to_modes_.bottomRows(n_)).transpose();
  out.viscous_drive = P_all_.dot(dissipation * P_all_);
}

void RegimeBuilder::make_contact_rows(Regime& out) const {
  const auto np2 = 2 * out.pairs.np;
  const auto eta = to_modes_.topRows(n_), eta_rate = to_modes_.bottomRows(n_);
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
      row = eta.transpose() * KP_.col(c) + eta_rate.transpose() * (C_.transpose() * P_.col(c));
      coefficient = P_.transpose() * KP_.col(c);
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

RegimeBuilder::Places RegimeBuilder::places(const std::function<bool(Eigen::Index)>& counts) const {
  Places out;
  for (const std::vector<std::size_t>& same : along_) {
    std::vector<Eigen::Index> here;
    double stiffness = 0.0;
    for (const std::size_t c : same)
      if (counts(static_cast<Eigen::Index>(c))) {
        here.push_back(static_cast<Eigen::Index>(c));
        stiffness += laws_[c].stiffness;
      }
    if (here.empty()) continue;
    out.first.push_back(here.front());
    out.together.push_back(std::move(here));
    out.stiffness.push_back(stiffness);
  }
  return out;
}

RegimeBuilder::Places RegimeBuilder::holding_places(const Regime& out) const {
  return places([&](Eigen::Index c) { return out.follows[static_cast<std::size_t>(c)]; });
}

RegimeBuilder::Places RegimeBuilder::refinable_springs(const Regime& out) const {
  if (out.pairs.n == 0) return {};
  return places([&](Eigen::Index c) { return out.spring(c) > 0.0; });
}

void RegimeBuilder::improve(const Places& at, const std::vector<Eigen::Index>& entries, const Eigen::MatrixXd& better,
                            const Eigen::VectorXd& size, double near, Eigen::MatrixXd& of_contacts) const {
  for (std::size_t k = 0; k < at.first.size(); ++k) {
    const std::vector<Eigen::Index>& same = at.together[k];
    const Eigen::VectorXd off =
        better.row(static_cast<Eigen::Index>(k)).transpose() - of_contacts(entries, same).rowwise().sum();
    // Both are exact but for rounding. Where they are not near, it is the equations that tell the contacts apart badly.
    if (!(off.norm() <= near * size(static_cast<Eigen::Index>(k)))) continue;
    for (const Eigen::Index c : same)
      of_contacts(entries, c) += (same.size() == 1 ? 1.0 : law(c).stiffness / at.stiffness[k]) * off;
  }
}

void RegimeBuilder::refine_stick_rows(Regime& out) const {
  // A contact's stretch, or the stiffness of a fine mesh times its deformation, gives the force of a slow motion as a
  // small difference. The equations of the slipping modes give it too, b λ = T G − G_s T less what the other contacts
  // exert, each with an error that its own rate and that of the motion make: least squares, weighted by these errors,
  // beside what the row says itself, which is the better one of a soft spring, or where pairs are nearly alike. Springs
  // that share a place are told apart by their stretches alone: what is refined is what they exert together.
  const Places holding = holding_places(out);
  const ModalModel& own = out.pairs;
  if (holding.first.empty() || own.n == 0) return;
  const Eigen::MatrixXd input = of_forces(modal_.directions), b = input(Eigen::all, holding.first);
  const Eigen::MatrixXd y_size = to_modes_.topRows(n_).cwiseAbs().transpose(),
                        rate_size = to_modes_.bottomRows(n_).cwiseAbs().transpose();
  Eigen::MatrixXd row_size(y_size.rows(), b.cols());  // of what a row is a sum of
  for (std::size_t k = 0; k < holding.first.size(); ++k) {
    const Eigen::Index c = holding.first[k];
    row_size.col(static_cast<Eigen::Index>(k)) =
        out.held(static_cast<int>(c))
            ? Eigen::VectorXd(y_size * KP_size_.col(c) + rate_size * (C_.cwiseAbs().transpose() * P_.col(c).cwiseAbs()))
            : Eigen::VectorXd(holding.stiffness[k] * (y_size * modal_.directions.col(c).cwiseAbs()));
  }
  for (Eigen::Index i = 0; i < own.n; ++i) {
    const std::vector<Eigen::Index> pair{i, own.np + i};
    const Eigen::Matrix2d G = block(own, i);
    if (G.isZero(0.0)) continue;  // a part that floats free moves without a rate to weigh errors by, nor do they grow
    const Eigen::MatrixXd t = to_modes_(Eigen::all, pair);
    Eigen::MatrixXd missing = t * G - mode_rates(t);
    for (Eigen::Index c = 0; c < nc_; ++c)
      if (!out.follows[static_cast<std::size_t>(c)]) missing -= input.col(c) * out.force_row(pair, c).transpose();
    Eigen::VectorXd size(b.cols());
    Eigen::MatrixXd by_row(b.cols(), 2);
    for (Eigen::Index k = 0; k < size.size(); ++k) {
      const std::vector<Eigen::Index>& same = holding.together[static_cast<std::size_t>(k)];
      // What a row rounds by of the place of a part that floats, all of its way in it, is no small share of the
      // largest.
      size(k) = std::max(out.force_row(Eigen::all, same).rowwise().sum().cwiseAbs().maxCoeff(),
                         kRoundsBy / kNear * row_size(pair, k).maxCoeff());
      by_row.row(k) = out.force_row(pair, same).rowwise().sum().transpose();
    }
    improve(holding, pair,
            least_squares(b, missing, mode_errors(G, t.topRows(n_), t.bottomRows(n_)), by_row,
                          row_size(pair, Eigen::all).transpose()),
            size, kNear, out.force_row);
  }
}

void RegimeBuilder::refine_spring_inputs(Regime& out) const {
  // What a spring does to the slow pairs has the same weakness. With x = F s + F_ζ (ζ, ζ̇), s of the slipping modes,
  // their equations give it from the left: B eᵀ = F G_s − G F with what the other contacts exert and, through F_ζ, what
  // s does to normal oscillators.
  const Places sprung = refinable_springs(out);
  if (sprung.first.empty()) return;
  const ModalModel& own = out.pairs;
  Eigen::MatrixXd F(2 * own.np, 2 * n_), places = Eigen::MatrixXd::Zero(2 * n_, nc_);
  F << at_.from_y * Z_.transpose(), at_.from_rate * Z_.transpose();
  places.topRows(n_) = modal_.directions;
  const Eigen::MatrixXd input = of_forces(modal_.directions), acting = F * input,
                        terms = F.cwiseAbs() * input.cwiseAbs();
  const Eigen::MatrixXd kept = (to_modes_ * F).transpose(), e = kept * places(Eigen::all, sprung.first);
  Eigen::MatrixXd by_modes = kept * of_mode_rates(F.transpose()), lifts(2 * n_, at_.from_zeta_rate.cols());
  for (Eigen::Index j = 0; j < lifts.cols(); ++j) {
    const Eigen::Index c = oscillators_[static_cast<std::size_t>(j)];
    const Eigen::VectorXd w = Z_ * moved_.col(c);
    lifts.col(j) << load(c).lift * w, load(c).lift_rate * w;
  }
  by_modes += lifts * at_.from_zeta_rate.transpose();
  const Eigen::MatrixXd lift_sizes = lifts.cwiseAbs() * at_.from_zeta_rate.cwiseAbs().transpose();
  for (Eigen::Index i = 0; i < own.n; ++i) {
    const std::vector<Eigen::Index> pair{i, own.np + i};
    const Eigen::Matrix2d G = block(own, i);
    if (G.isZero(0.0)) continue;
    const Eigen::MatrixXd f = F(pair, Eigen::all).transpose();
    Eigen::MatrixXd missing = by_modes(Eigen::all, pair) - f * G.transpose();
    for (Eigen::Index c = 0; c < nc_; ++c)
      if (!out.follows[static_cast<std::size_t>(c)])
        missing += F.transpose() * out.force_row.col(c) * acting(pair, c).transpose();
    Eigen::MatrixXd by_itself(e.cols(), 2), size(e.cols(), 2);  // of what B is a sum of
    for (Eigen::Index k = 0; k < e.cols(); ++k) {
      const auto place = static_cast<std::size_t>(k);
      by_itself.row(k) = out.B(pair, sprung.together[place]).rowwise().sum().transpose();
      size.row(k) = sprung.stiffness[place] * terms(pair, sprung.first[place]).transpose();
    }
    improve(sprung, pair,
            least_squares(e, missing, mode_errors(G, f.bottomRows(n_), f.topRows(n_)) + lift_sizes(Eigen::all, pair),
                          by_itself, size),
            size.rowwise().maxCoeff(), kNearer, out.B);
  }
}

void RegimeBuilder::make_steady_forces(Regime& out) const {
  // Behind a stiff spring, what a contact exerts on the motion that follows the inputs is a small difference as well.
  constexpr double kLeast = 1e-8;
  const Eigen::MatrixXd by_rows = out.particular.transpose() * out.force_row + out.force_coefficient;
  out.steady_force = by_rows;
  const auto of_followers = [&](const Eigen::MatrixXd& of_contacts) -> Eigen::VectorXd {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(of_contacts.rows());
    for (Eigen::Index c = 0; c < nc_; ++c)
      if (out.follows[static_cast<std::size_t>(c)]) sum += of_contacts.col(c);
    return sum;
  };
  out.steady_together = of_followers(by_rows.transpose());
  out.beside_rows = Eigen::MatrixXd::Zero(ni_, nc_);
  Eigen::MatrixXd sizes =
      out.particular.cwiseAbs().transpose() * out.force_row.cwiseAbs() + out.force_coefficient.cwiseAbs();
  if (refinable_springs(out).first.empty()) return;  // works are those of the forces there are
  // A spring's force rounds by its stiffness times all that moves its end, a held contact's by what springs do at it.
  const Eigen::MatrixXd to_places = to_modes_.topRows(n_),
                        terms = to_places.cwiseAbs() * out.particular.cwiseAbs() + P_.cwiseAbs();
  Eigen::MatrixXd place = to_places * out.particular + P_;
  for (Eigen::Index c = 0; c < nc_; ++c) {
    const Eigen::VectorXd w = modal_.directions.col(c).cwiseAbs();
    sizes.col(c) += out.spring(c) * (terms.transpose() * w);
    for (const Eigen::Index h : held_) sizes(c, h) += out.spring(c) * P_.col(h).cwiseAbs().dot(w);
  }
  // What floats is carried along by a spring's way without a force.
  out.steady_force = (out.steady_force.array().abs() > kRoundsBy * sizes.array()).select(out.steady_force, 0.0).eval();
  // What only integrates the inputs has no part in x_p, but moves on by them.
  const ModalModel& own = out.pairs;
  Eigen::MatrixXd on = out.B;
  for (Eigen::Index i = 0; i < own.n; ++i) {
    const std::vector<Eigen::Index> pair{i, own.np + i};
    on(pair, Eigen::all) += block(own, i) * out.particular(pair, Eigen::all);
    if (out.scale1(i) != 0.0) on.row(i).setZero();
    if (out.scale2(i) != 0.0) on.row(own.np + i).setZero();
  }
  // What x_p holds moves as what it holds of the ways: its speeds and their rates round by no spring.
  const Eigen::MatrixXd moves_on = to_modes_ * on;
  Eigen::MatrixXd speed = moves_on.topRows(n_), rate = moves_on.bottomRows(n_);
  const auto add_rates = [&](const Eigen::MatrixXd& moved, Eigen::MatrixXd& rates) {
    rates.col(V_) += of_followers(moved);
    rates.col(V_ + 1) += moved.col(V_);
  };
  add_rates(place, speed);
  add_rates(speed, rate);
  const Places holding = holding_places(out);
  const auto count = static_cast<Eigen::Index>(holding.first.size());
  const Eigen::MatrixXd b = modal_.directions(Eigen::all, holding.first);
  // Where a mode should not follow a contact's way, it does so by rounding of what others do. (Inputs of contacts that
  // do not follow are forces.)
  Eigen::RowVectorXd largest = Eigen::RowVectorXd::Zero(nc_);
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (out.follows[static_cast<std::size_t>(c)]) largest = largest.cwiseMax(sizes.row(c));
  for (Eigen::Index c = 0; c < nc_; ++c)
    if (out.follows[static_cast<std::size_t>(c)]) sizes.row(c) = largest;
  // All ways at once are one more motion.
  const Eigen::Index together = ni_;
  for (Eigen::MatrixXd* of : {&place, &speed, &rate}) {
    const Eigen::VectorXd sum = of_followers(*of);
    of->conservativeResize(Eigen::NoChange, ni_ + 1);
    of->col(together) = sum;
  }
  out.steady_force.conservativeResize(ni_ + 1, Eigen::NoChange);
  out.steady_force.row(together) = out.steady_together;
  sizes.conservativeResize(ni_ + 1, Eigen::NoChange);
  sizes.row(together) = largest;
  const Eigen::VectorXd squared = modal_.omega.cwiseAbs2(), reach = b.colwise().norm().transpose();
  for (Eigen::Index k = 0; k <= together; ++k) {
    if (k > one_ && k < together) continue;
    Eigen::VectorXd missing =
        squared.cwiseProduct(place.col(k)) + damped(modal_.damping, slipping_.proportional, speed.col(k));
    Eigen::VectorXd size =
        place.col(k).cwiseAbs().maxCoeff() * squared + speed.col(k).cwiseAbs().maxCoeff() * most_damped_;
    const auto add = [&](const Eigen::VectorXd& term) {
      missing += term;
      size += term.cwiseAbs();
    };
    add(rate.col(k));
    for (Eigen::Index c = 0; c < nc_; ++c)
      if (!out.follows[static_cast<std::size_t>(c)]) add(-out.steady_force(k, c) * modal_.directions.col(c));
    if (k == one_) add(-modal_.load);
    // With them what the rows say, each with its error: that of a soft spring on a stiff structure is the smaller one.
    missing = (missing.array().abs() > kRoundsBy * size.array()).select(missing, 0.0).eval();
    Eigen::VectorXd by_row(count), by_row_size(count);
    for (Eigen::Index at = 0; at < count; ++at) {
      const std::vector<Eigen::Index>& same = holding.together[static_cast<std::size_t>(at)];
      by_row(at) = out.steady_force(k, same).sum();
      by_row_size(at) = sizes(k, same).sum();
    }
    // Each in its own unit: forces of modes beside those of contacts.
    const double least = kLeast * std::max(size.maxCoeff(), by_row_size.cwiseProduct(reach).maxCoeff()),
                 least_row = kLeast * std::max(by_row_size.maxCoeff(), size.maxCoeff() / reach.maxCoeff());
    if (!(least > 0.0)) continue;
    improve(holding, {k}, least_squares(b, missing, size.array() + least, by_row, by_row_size.array() + least_row),
            by_row_size, kNearest, out.steady_force);
  }
  out.steady_together = out.steady_force.row(together);
  out.steady_force.conservativeResize(ni_, Eigen::NoChange);
  out.beside_rows = out.steady_force - by_rows;
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
  const auto eta = to_modes_.topRows(n_), eta_rate = to_modes_.bottomRows(n_);
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
  out.to_slipping = modal_.from_eta * to_modes_.topRows(n_) + modal_.from_eta_rate * to_modes_.bottomRows(n_);
  out.inputs_slipping = modal_.from_eta * P_;
  out.inputs_slipping.col(V_) += modal_.from_eta_rate * P_all_;
  out.place_row = out.to_slipping.cwiseAbs().transpose() * slipping_.place_row;
  out.place_coefficient = out.inputs_slipping.cwiseAbs().transpose() * slipping_.place_row;
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
