// That a step passes over no event of a spring, a stop or a load that varies: docs/theory/flow.md, section 4.
#include "dynamics/internal/collocation_flow.hpp"
#include "dynamics/internal/left_out.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Shares of a step tried, by halving, over which a speed that starts at zero is shown to rise.
constexpr int kSpeedHalvings = 8;

}  // namespace

CollocationFlow::OwnMotion CollocationFlow::own_motion(int c, double h) const {
  // The eighth derivative of what interpolates the speed is constant, and the speed's own is somewhere equal to it.
  constexpr double kEighth = 40320.0 * 32768.0;  // 8! times the leading coefficient of Chebyshev's T₈ on [0, 1]
  const auto i = static_cast<std::size_t>(c);
  const OwnForce& own = own_forces_[i];
  alignas(64) const RadauTables::Vector8 speed = velocity_.segment<kNodes>(kNodes * c),
                                         drive = drive_nodes_.segment<kNodes>(kNodes * c);
  const double v = resolver_.contact_velocity(c, x_begin_.data()), V = drive_velocity(begin_, 0.0);
  const auto eighth = [&](double start, const RadauTables::Vector8& at_nodes) {
    return kEighth * std::abs(ChebyshevSeries(kernels_, start, at_nodes).other(kNodes - 1)) + ninth_(c);
  };
  OwnMotion out{.way = h * eighth(v, speed)};
  const double followed = own.follows ? h * eighth(V - v, drive - speed) : out.way;
  out.force = std::abs(own.stiffness) * followed + std::abs(own.damping) * ninth_(c);
  for (int j = kNodes * c; j < kNodes * (c + 1); ++j)
    out.left = std::max(out.left, std::abs(own.at(way_nodes_(j % kNodes), moved_(j), velocity_(j)) - forces_(j)));
  const double at_start = nodes_.lagrange(0.0).dot(forces_.segment<kNodes>(kNodes * c));
  out.start = std::abs(point_.force(c) - at_start);
  return out;
}

bool CollocationFlow::proves_own(int c, const Guarded* found, const Deviation& off, double h, double end) const {
  const auto i = static_cast<std::size_t>(c);
  const OwnForce& own = own_forces_[i];
  const bool by_law = !held(point_.modes, c);
  const OwnMotion& motion = own_motions_[i];
  for (const OwnGuard& guard : own_guards(c, point_.modes[i])) {
    const double by_y = std::abs(guard.y), by_v = std::abs(guard.v), by_force = std::abs(guard.force);
    const double beyond = by_y * motion.way + by_v * ninth_(c) + std::abs(guard.drive) * drive_ninth(h) +
                          (by_law ? by_force * motion.force : 0.0);
    double error = nodes_.remainder[0] * beyond + (by_y * h + by_v) * off.speed,
           slope_error = nodes_.remainder[1] * beyond + by_y * h * off.speed + by_v * off.speed_slope;
    if (by_law) {
      error += by_force * (own.lipschitz(h) * off.speed + nodes_.lebesgue * motion.left);
      slope_error += by_force * (std::abs(own.stiffness) * h * off.speed + std::abs(own.damping) * off.speed_slope +
                                 kSteepest * nodes_.lebesgue * motion.left);
    } else {
      error += by_force * (off.force + motion.start);
      slope_error += by_force * (off.force_slope + kSteepest * motion.start);
    }
    BernsteinPolynomial p = form_of(guard, c);
    const int order = start_order(guard, c, evaluate(guard, c, 0.0, x_begin_));
    if (order > 0) p.coefficient[0] = 0.0;
    double from = 0.0;
    if (order == 2) {
      // The limit of a spring whose contact has ceased to slide: it is left as long as the sliding speed, zero at the
      // start, falls.
      if (!(own.follows && guard.force != 0.0 && guard.y == 0.0)) return false;
      BernsteinPolynomial speed =
          interpolant(0.0, drive_nodes_.segment<kNodes>(kNodes * c) - velocity_.segment<kNodes>(kNodes * c));
      for (double& b : speed.coefficient) b *= guard.force;
      const BernsteinPolynomial slope = derivative(speed);
      const double most = by_force * (nodes_.remainder[1] * ninth_(c) + off.speed_slope);
      int halvings = 0;
      for (from = end; !(least(part(slope, 0.0, from)) > most); from *= 0.5)
        if (++halvings > kSpeedHalvings) return false;
    }
    const bool reached = found != nullptr && found->own && found->own->kind == guard.kind &&
                         found->own->next == guard.next && found->own->force == guard.force;
    if (!stays_clear(p, error, slope_error, from, reached ? found : nullptr, end)) return false;
  }
  return true;
}

}  // namespace slipmode::dynamics
