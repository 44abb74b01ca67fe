#include "selftest/load_history.hpp"

namespace slipmode::selftest {

LoadHistory::LoadHistory(const friction::NormalLoad& load, double y0) : load_(load) {
  if (!load.oscillator) return;
  const auto& o = *load.oscillator;
  z_ = o.spring_stiffness * o.slope * y0 / (o.spring_stiffness + o.support_stiffness);
}

void LoadHistory::advance(double h, double y0, double v0, double y1, double v1, int halvings) {
  if (!load_.oscillator || h <= 0.0) return;
  const double ym = 0.5 * (y0 + y1) + h / 8.0 * (v0 - v1), vm = 1.5 * (y1 - y0) / h - 0.25 * (v0 + v1);
  if (halvings > 0) {
    advance(h / 2.0, y0, v0, ym, vm, halvings - 1);
    advance(h / 2.0, ym, vm, y1, v1, halvings - 1);
    return;
  }
  const Eigen::Vector2d x(z_, z_rate_), a = rate(x, y0, v0), b = rate(x + 0.5 * h * a, ym, vm),
                                        c = rate(x + 0.5 * h * b, ym, vm), d = rate(x + h * c, y1, v1);
  const Eigen::Vector2d end = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  z_ = end(0);
  z_rate_ = end(1);
}

void LoadHistory::read(double y, double v, double a, ContactInstant& out_now) const {
  out_now.load = load_.constant + load_.slope * y;
  out_now.load_rate = load_.slope * v;
  if (!load_.oscillator) return;
  const auto& o = *load_.oscillator;
  const Eigen::Vector2d r = rate({z_, z_rate_}, y, v);
  out_now.load += o.spring_stiffness * (o.slope * y - z_) + o.spring_damping * (o.slope * v - z_rate_);
  out_now.load_rate += o.spring_stiffness * (o.slope * v - r(0)) + o.spring_damping * (o.slope * a - r(1));
}

Eigen::Vector2d LoadHistory::rate(const Eigen::Vector2d& x, double y, double v) const {
  const auto& o = *load_.oscillator;
  const double force = o.spring_stiffness * o.slope * y + o.spring_damping * o.slope * v -
                       (o.spring_stiffness + o.support_stiffness) * x(0) -
                       (o.spring_damping + o.support_damping) * x(1);
  return {x(1), force / o.mass};
}

}  // namespace slipmode::selftest
