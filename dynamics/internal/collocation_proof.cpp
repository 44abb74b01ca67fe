#include "dynamics/internal/collocation_flow.hpp"
#include "dynamics/internal/left_out.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// That a step passes over no event: docs/theory/flow.md, section 4.

namespace slipmode::dynamics {
namespace {

/// Shares of a step tried, by halving, over which a guard that starts at zero is shown to rise.
constexpr int kRiseHalvings = 8;
/// Of a root found, relative: twice what first_root leaves.
constexpr double kRootSlack = 2e-6;

/// A force in slip may exceed its largest where a trial step passes zero speed: by e^0.7.
constexpr double kLargestShare = 2.1;
/// Newton's method leaves less of a force, as a share of the static limit.
constexpr double kNewtonRest = 1e-7;
/// e^x ≤ 1/(1 − x) up to here.
constexpr double kMostGrowth = 0.8;

bool has_guard(const ContactForces& law) { return law.sticks() || law.kind == LawKind::kBristle; }

bool positive(const BernsteinPolynomial& p) { return p.coefficient[0] > 0.0 && !first_root(p); }

/// e^x or more, for x ≥ 0.
double exponential_bound(double x) { return x < 0.25 ? 1.0 / (1.0 - x) : std::exp(x); }

}  // namespace

void CollocationFlow::prepare_proof() {
  const auto known = [](const ContactForces& law) {
    return law.is_elaborate() || law.kind == LawKind::kBristle || law.bounds(0.0, 0.0).has_value();
  };
  guarded_ = any_elaborate_ || std::ranges::any_of(laws(), has_guard);
  provable_ = halving_proves_ = options_.certify && (!guarded_ || std::ranges::all_of(laws(), known));
  ninth_.resize(nc_);
  own_motions_.resize(laws().size());
  bounded_.resize(laws().size());
}

double CollocationFlow::drive_ninth(double h) const {
  const friction::Shaker* shaker = drive().shaker();
  if (shaker == nullptr) return 0.0;
  return std::pow(shaker->omega() * h, kNodes + 1) * drive().velocity_scale(begin_);
}

Eigen::VectorXd CollocationFlow::given_most(int derivative) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(given_);
  if (const friction::Force* force = drive().force())
    for (const friction::ForceHarmonic& h : force->harmonics)
      out(h.direction) += std::abs(h.amplitude) * std::pow(h.order * force->omega, derivative);
  return out;
}

CollocationFlow::LeftOut CollocationFlow::given_left_out(double h) const {
  if (given_ == 0) return {};
  const double eighth = std::pow(h, kNodes) * given_most(kNodes).maxCoeff();
  return {nodes_.force_remainder[0] * eighth, nodes_.force_remainder[1] * eighth};
}

RadauTables::Vector8 CollocationFlow::scaled_speeds(int c) const {
  const auto i = static_cast<std::size_t>(c);
  return (sign_of(point_.modes[i]) * laws()[i].alpha) *
         (drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c));
}

double CollocationFlow::between_nodes(int c) const {
  const ContactForces& law = laws()[static_cast<std::size_t>(c)];
  alignas(64) const RadauTables::Vector8 scaled = scaled_speeds(c);
  const ChebyshevSeries s(kernels_, law.alpha * guard_start_(c), scaled);
  return law.drop * std::exp(log_remainder(s.swing() - s.mean));
}

CollocationFlow::Deviation CollocationFlow::deviation(const StepBounds& bounds, double h, bool at_rest) const {
  const double between = nodes_.remainder[0] * ninth_.maxCoeff();
  const LeftOut given = given_left_out(h);
  double defect = given.value, slope = 0.0, cross = 0.0, rate = 0.0, curve = 0.0;
  std::vector<Eigen::Index> stuck;
  const auto& [reach, reach1, reach2] = bounds.response;
  Deviation out;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    if (held(point_.modes, c)) {
      stuck.push_back(c);
      rate = std::max(rate, nodes_.remainder[1] * ninth_(c) / h);
      curve = std::max(curve, nodes_.remainder[2] * ninth_(c) / (h * h));
      continue;
    }
    if (bristled(c)) {
      const BristleDefect own = bristle_defect(c, reach, h, at_rest);
      defect = std::max(defect, own.force);
      slope = std::max(slope, own.growth / reach);
      out.room = std::min(out.room, own.room);
    }
    if (elaborate(c) && own_forces_[i].moves()) {
      const OwnMotion& own = own_motions_[i];
      defect = std::max(defect, 2.0 * nodes_.lebesgue * own.left + own.start + nodes_.remainder[0] * own.force);
      slope = std::max(slope, own_forces_[i].lipschitz(h));
    }
    if (by_bounds(c)) {
      const BoundedDefect& own = bounded_[i];
      defect = std::max(defect, own.force);
      slope = std::max(slope, own.growth);
      out.room = std::min(out.room, own.room);
      continue;
    }
    if (law.kind != LawKind::kSpeedDependent) continue;
    const double sign = sign_of(point_.modes[i]);
    // What Newton left at the nodes, what the nodes leave between them, and what is between p and the computed speed.
    const double left = (forces_.segment<kNodes>(kNodes * c).array() -
                         sign * (law.kinetic + law.drop * (-scaled_speeds(c).array()).exp()))
                            .abs()
                            .maxCoeff();
    const double nearest = law.alpha * law.drop * std::exp(-law.alpha * (guard_least_(c) - between));
    defect = std::max(defect, nodes_.lebesgue * left + between_nodes(c) + nearest * between);
    const double steepest =
        law.alpha * law.drop *
        (at_rest ? exponential_bound(law.alpha * between) : std::exp(-0.5 * law.alpha * (guard_least_(c) - between)));
    slope = std::max(slope, steepest);
  }
  double hold = 0.0;
  if (!stuck.empty()) {
    hold = 1.0 / model_.mobility(stuck.front(), stuck.front());
    if (nc_ > 1) {
      const Eigen::MatrixXd own = model_.mobility(stuck, stuck);
      hold = own.inverse().cwiseAbs().rowwise().sum().maxCoeff();
      for (int d = 0; d < nc_; ++d) {
        if (held(point_.modes, d) || stays(d)) continue;
        cross += model_.mobility(stuck, d).cwiseAbs().maxCoeff();
      }
    }
    if (given_ > 0) {
      const double by_given = model_.force_acceleration(stuck, Eigen::all).cwiseAbs().rowwise().sum().maxCoeff();
      rate += by_given * given.value;
      curve += by_given * given.slope / h;
    }
  }
  const double first = std::max(defect, hold * (rate + cross * defect)),
               growth = std::max(slope * reach, hold * (cross * slope * reach + reach1));
  out.force = first * exponential_bound(growth * h);
  out.speed = reach * h * out.force;
  out.speed_slope = h * (reach + reach1 * h) * out.force;
  out.force_slope =
      cross > 0.0 ? std::numeric_limits<double>::infinity() : h * hold * (curve + (reach1 + reach2 * h) * out.force);
  return out;
}

double CollocationFlow::largest_force_rate(int d, const Deviation& off, double h) const {
  const auto i = static_cast<std::size_t>(d);
  const ContactForces& law = laws()[i];
  if (bristled(d)) return std::numeric_limits<double>::infinity();
  if (elaborate(d) && !held(point_.modes, d)) {
    // By the speed, and by an acceleration of which as much is known as of the speed.
    alignas(64) const RadauTables::Vector8 speed =
        drive_nodes_.segment<kNodes>(kNodes * d) - velocity_.segment<kNodes>(kNodes * d);
    const double start = drive_velocity(begin_, 0.0) - resolver_.contact_velocity(d, x_begin_.data());
    const ChebyshevSeries series(kernels_, start, speed);
    const double left = nodes_.remainder[0] * ninth_(d) + off.speed, fastest = std::abs(start) + 2.0 * series.spread();
    const friction::Shaker* shaker = drive().shaker();
    const double pulled = shaker != nullptr ? shaker->omega() * drive().velocity_scale(begin_)
                                            : std::abs(drive_acceleration(begin_, 0.0));
    const double drive_fast = own_forces_[i].follows ? 0.0 : drive().velocity_scale(begin_) + pulled * h;
    return std::abs(own_forces_[i].stiffness) * (fastest + drive_fast + left) +
           std::abs(own_forces_[i].damping) *
               ((kSteepest * series.spread() + nodes_.remainder[1] * ninth_(d) + off.speed_slope) / h + pulled);
  }
  if (by_bounds(d)) {
    const BoundedDefect& own = bounded_[i];
    return (own.rate + own.growth * (nodes_.remainder[1] * ninth_(d) + off.speed_slope)) / h;
  }
  const auto form = guard_forms_.segment<kNodes>(kNodes * d);
  const double steps = (form.tail<kNodes - 1>() - form.head<kNodes - 1>()).cwiseAbs().maxCoeff();
  if (point_.modes[i] == ContactMode::kStick) return ((kNodes - 1) * steps + off.force_slope) / h;
  const double of_speed = kNodes * std::max(steps, std::abs(form(0) - guard_start_(d)));
  return law.alpha * law.drop * (of_speed + nodes_.remainder[1] * ninth_(d) + off.speed_slope) / h;
}

double CollocationFlow::clear_after_release(const StepBounds& bounds, const Deviation& off, double h, int c) const {
  // s″ − κ s′ = B(t) with κ the law's slope times the mobility: as long as B > 0, s′ and s are.
  if (bristled(c)) return 0.0;  // its force is no function of the speed alone
  const auto i = static_cast<std::size_t>(c);
  const ContactForces& law = laws()[i];
  const double sign = sign_of(point_.modes[i]);
  const friction::Shaker* shaker = drive().shaker();
  const double omega = shaker != nullptr ? shaker->omega() : 0.0;
  const double steepest = law.bounds(0.0, fastest_slip(c) + nodes_.remainder[0] * ninth_(c) + off.speed)->slope;
  const Eigen::Index load = nc_ + given_;
  double now =
      -omega * omega * drive().velocity(begin_) - bounds.second_row.col(c).dot(x_begin_) - bounds.response1(c, load);
  double change = omega * omega * omega * drive().velocity_scale(begin_) +
                  bounds.third_by_state.col(c).dot(x_begin_.cwiseAbs()) + h * bounds.third_by_load(c) +
                  std::abs(bounds.response2(c, load));
  if (given_ > 0) {
    const auto direct = model_.force_acceleration.row(c);
    const auto later = bounds.response1.row(c).segment(nc_, given_);
    now -= later.dot(given_force(0.0)) + direct.dot(given_force(0.0, 1));
    change += (h * bounds.third_by_force.row(c).tail(given_) + bounds.response2.row(c).segment(nc_, given_).cwiseAbs())
                  .dot(given_most(0)) +
              later.cwiseAbs().dot(given_most(1)) + direct.cwiseAbs().dot(given_most(2));
  }
  double by_rate = 0.0, others = 0.0;
  for (int d = 0; d < nc_; ++d) {
    const ContactForces& other = laws()[static_cast<std::size_t>(d)];
    now -= bounds.response1(c, d) * point_.force(d);
    const double most = elaborate(d)
                            ? nodes_.lebesgue * forces_.segment<kNodes>(kNodes * d).cwiseAbs().maxCoeff() + off.force
                            : other.most();
    change += (h * bounds.third_by_force(c, d) + std::abs(bounds.response2(c, d))) * most;
    if (stays(d) && point_.modes[static_cast<std::size_t>(d)] != ContactMode::kStick) continue;
    if (d == c) {
      by_rate = std::abs(bounds.response1(c, c)) * steepest;
    } else if (model_.mobility(c, d) != 0.0 || bounds.response1(c, d) != 0.0) {
      const double rate = largest_force_rate(d, off, h);
      others += std::abs(model_.mobility(c, d)) * rate;
      change += std::abs(bounds.response1(c, d)) * rate;
    }
  }
  now = sign * now - others;
  if (!(now > 0.0)) return 0.0;
  // Up to where B could have vanished, s′ ≤ 2 B(0) h e^{κh}, B(0) less and more what the others may add.
  const double growth = steepest * model_.mobility(c, c) * h;
  change += by_rate * 2.0 * (now + others) * h * std::exp(growth);
  if (!std::isfinite(change)) return 0.0;
  return std::min(1.0, now / (change * h));
}

bool CollocationFlow::stays_clear(const BernsteinPolynomial& guard, double error, double slope_error, double from,
                                  const Guarded* found, double end) const {
  if (from >= end) return true;
  if (guard.coefficient[0] <= error && from == 0.0) {  // starts at zero: it rises before it stays above
    const BernsteinPolynomial slope = derivative(guard);
    double rise = end;
    int halvings = 0;
    while (!(least(part(slope, 0.0, rise)) > slope_error)) {
      if (++halvings > kRiseHalvings) return false;
      rise *= 0.5;
    }
    if (rise == end) return true;
    from = rise;
  }
  if (found == nullptr) return positive(lowered(part(guard, from, end), error));
  // The first root of the guard less its error; from there to the event it falls.
  const BernsteinPolynomial low = lowered(part(guard, from, 1.0), error);
  if (!(low.coefficient[0] > 0.0)) return false;
  const auto root = first_root(low);
  if (!root || root->touching) return false;
  const double enters = from + root->at * (1.0 - kRootSlack) * (1.0 - from);
  const double leaves = std::min(1.0, found->theta + std::max(0.0, found->theta - enters));
  return most(part(derivative(guard), enters, std::max(leaves, enters))) < -slope_error;
}

bool CollocationFlow::far_from_guards(const StepBounds& bounds, double h) const {
  // One contact, by what its force can be at all: most steps are far from any guard, and this is cheap.
  const ContactForces& law = laws()[0];
  const bool stuck = point_.modes[0] == ContactMode::kStick;
  const double size = stuck ? guard_forms_.head<kNodes>().cwiseAbs().maxCoeff() : 0.0;
  const double mean = stuck ? size : kLargestShare * law.static_limit,
               spread = stuck ? 2.0 * size : kLargestShare * law.drop;
  const double ninth = ninth_(0) + bounds.ninth_by_mean * mean + bounds.ninth_by_spread * spread;
  const auto& [reach, reach1, reach2] = bounds.response;
  if (stuck) {
    const double hold = 1.0 / model_.mobility(0, 0), growth = hold * reach1 * h;
    return growth < kMostGrowth && size + hold * nodes_.remainder[1] * ninth / h / (1.0 - growth) < law.static_limit;
  }
  const double between = nodes_.remainder[0] * ninth, room = 0.5 * (guard_least_(0) - between);
  if (!(room > 0.0)) return false;
  const double half = std::exp(-law.alpha * room), least = half * half,
               growth = law.alpha * law.drop * half * reach * h;
  if (!(growth < kMostGrowth)) return false;
  const double largest_defect = room * (1.0 - growth) / (reach * h) - nodes_.lebesgue * kNewtonRest * law.static_limit;
  // By the range of the law over the speeds there are; by what its interpolation can leave.
  const double range = least * std::min(1.0, law.alpha * (fastest_slip(0) - guard_least_(0) + 2.0 * between));
  return 0.5 * (1.0 + nodes_.lebesgue) * law.drop * range < largest_defect ||
         between_nodes(0) + law.alpha * law.drop * least * between < largest_defect;
}

bool CollocationFlow::proves(const Guarded& found, double end) {
  if (!guarded_) return true;
  if (!provable_ || found.touching) return false;
  const StepBounds& bounds = tables_.bounds(step_level_);
  const double h = tables_.step(step_level_);
  const double by_drive = drive_ninth(h);
  for (int c = 0; c < nc_; ++c)
    ninth_(c) = bounds.ninth_by_load(c) + by_drive + bounds.ninth_by_state.col(c).dot(x_begin_.cwiseAbs());
  if (nc_ == 1 && given_ == 0 && !any_bristle_ && !any_elaborate_ && !by_bounds(0) && found.contact < 0 &&
      far_from_guards(bounds, h))
    return true;
  alignas(64) std::array<double, kNodes> series;
  for (int d = 0; d < nc_ + given_; ++d) {
    kernels_.matrix8(nodes_.legendre.data(), forces_.data() + kNodes * d, series.data());
    for (int c = 0; c < nc_; ++c)
      ninth_(c) += bounds.ninth_by_force.col(c)
                       .segment<kNodes>(kNodes * d)
                       .dot(Eigen::Map<const RadauTables::Vector8>(series.data()).cwiseAbs());
  }
  const double between = nodes_.remainder[0] * ninth_.maxCoeff();
  for (int c = 0; c < nc_; ++c) {
    if (elaborate(c)) own_motions_[static_cast<std::size_t>(c)] = own_motion(c, h);
    if (by_bounds(c)) bounded_[static_cast<std::size_t>(c)] = bounded_defect(c);
  }

  const auto faster_than = [&](double speed) {  // of the computed motion
    for (int c = 0; c < nc_; ++c) {
      const auto i = static_cast<std::size_t>(c);
      if (point_.modes[i] == ContactMode::kStick || !has_guard(laws()[i]) || elaborate(c)) continue;
      if (!(guard_least_(c) - between > speed)) return false;
    }
    return true;
  };
  const bool moving = faster_than(0.0);
  Deviation off = deviation(bounds, h, !moving);
  if (moving && !faster_than(2.0 * off.speed)) off = deviation(bounds, h, true);
  if (!(off.speed <= off.room)) return false;

  BernsteinPolynomial p;
  for (int c = 0; c < nc_; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const ContactForces& law = laws()[i];
    const Guarded* reached = found.contact == c ? &found : nullptr;
    if (elaborate(c)) {
      if (!proves_own(c, reached, off, h, end)) return false;
      continue;
    }
    if (!has_guard(law)) continue;
    const auto form = guard_forms_.segment<kNodes>(kNodes * c);
    if (point_.modes[i] == ContactMode::kStick) {
      p.degree = kNodes - 1;
      const double greatest = form.cwiseAbs().maxCoeff();
      if (reached == nullptr && greatest + off.force <= law.static_limit) continue;
      const double at_event = nodes_.lagrange(found.theta).dot(told_forces(c));
      for (const double sign : {1.0, -1.0}) {
        for (int k = 0; k < kNodes; ++k) p.coefficient[static_cast<std::size_t>(k)] = law.static_limit - sign * form(k);
        p.coefficient[0] = or_at_limit(p.coefficient[0], law);
        const bool this_side = reached != nullptr && sign * at_event > 0.0;
        if (!stays_clear(p, off.force, off.force_slope, 0.0, this_side ? reached : nullptr, end)) return false;
      }
      continue;
    }
    const double error = nodes_.remainder[0] * ninth_(c) + off.speed,
                 slope_error = nodes_.remainder[1] * ninth_(c) + off.speed_slope;
    if (reached == nullptr && guard_least_(c) > error) continue;
    p.degree = kNodes;
    p.coefficient[0] = guard_start_(c);
    for (int k = 0; k < kNodes; ++k) p.coefficient[static_cast<std::size_t>(k) + 1] = form(k);
    const bool released = point_.multiplicity[i] == 2 && guard_start_(c) == 0.0;
    const double from = released ? clear_after_release(bounds, off, h, c) : 0.0;
    if (released && from == 0.0) return false;
    if (!stays_clear(p, error, slope_error, from, reached, end)) return false;
  }
  return true;
}

}  // namespace slipmode::dynamics
