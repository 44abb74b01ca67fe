#pragma once

#include <slipmode/friction/contact.hpp>
#include "selftest/contact_guards.hpp"

#include <Eigen/Core>

namespace slipmode::selftest {

/// N and dN/dt of a contact along samples. The normal oscillator is integrated by the classical Runge-Kutta method with
/// y between samples from Hermite's cubic.
class LoadHistory {
 public:
  LoadHistory(const friction::NormalLoad& load, double y0);

  /// Under the cubic through places and speeds.
  void advance(double h, double y0, double v0, double y1, double v1, int halvings = kHalvings);
  /// @param a  contact's acceleration
  void read(double y, double v, double a, ContactInstant& out_now) const;

 private:
  /// Of a step of Runge and Kutta's between samples: what hundreds of them leave is 256 times smaller so.
  static constexpr int kHalvings = 2;

  [[nodiscard]] Eigen::Vector2d rate(const Eigen::Vector2d& x, double y, double v) const;

  friction::NormalLoad load_;
  double z_ = 0.0, z_rate_ = 0.0;
};

}  // namespace slipmode::selftest
