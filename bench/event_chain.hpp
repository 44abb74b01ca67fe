#pragma once

#include "bench/chain_problem.hpp"

#include <algorithm>
#include <cmath>

namespace slipmode::bench {

/// The stick-slip chain as the peers integrate it: y = [x, v] with the last velocity stored relative to the belt
/// (w = v_n − V), so that sticking is w = 0 exactly and a guard near zero keeps its digits. Tridiagonal, O(n), no
/// allocation.
class EventChain {
 public:
  explicit EventChain(const ChainProblem& problem)
      : p_(problem), static_limit_(problem.mu_s * problem.load), kinetic_(problem.mu_k * problem.load) {}

  [[nodiscard]] int size() const { return 2 * p_.n; }
  [[nodiscard]] int mode() const { return mode_; }  ///< −1, +1: sign of v_rel in slip; 0: stick
  [[nodiscard]] double static_limit() const { return static_limit_; }

  /// Fills y from a state at rest relative to nothing: x and v as given.
  void start(const std::vector<double>& x, const std::vector<double>& v, double* out_y) {
    std::copy(x.begin(), x.end(), out_y);
    std::copy(v.begin(), v.end(), out_y + p_.n);
    out_y[2 * p_.n - 1] -= p_.belt;
    const double w = out_y[2 * p_.n - 1];
    if (w == 0.0) {
      resolve(out_y);
    } else {
      mode_ = w < 0.0 ? 1 : -1;
    }
  }

  void derivative(const double* __restrict y, double* __restrict out_dy) const {
    const int n = p_.n;
    const double w = y[2 * n - 1];
    std::copy(y + n, y + 2 * n, out_dy);
    out_dy[n - 1] += p_.belt;
    chain_acceleration(p_, y, y + n, out_dy + n);
    const double shift = p_.damping * p_.belt;  // what the absolute belt speed adds to the dampers of the last mass
    if (n > 1) out_dy[2 * n - 2] += shift;
    out_dy[2 * n - 1] = mode_ == 0 ? 0.0 : out_dy[2 * n - 1] - (1.0 + p_.ground) * shift + friction(w);
  }

  /// Positive while slipping on, in slip.
  [[nodiscard]] double slip_guard(const double* y) const { return -mode_ * y[2 * p_.n - 1]; }

  /// Force that would hold the last mass on the belt.
  [[nodiscard]] double holding_force(const double* y) const {
    const int n = p_.n;
    const double c = p_.damping;
    const double own = (1.0 + p_.ground) * (y[n - 1] + c * (y[2 * n - 1] + p_.belt));
    return n > 1 ? own - (y[n - 2] + c * y[2 * n - 2]) : own;
  }

  /// After a guard was met: sets w = 0 and the mode that follows.
  void resolve(double* y) {
    y[2 * p_.n - 1] = 0.0;
    const bool released = mode_ == 0 && !first_;
    first_ = false;
    const double force = holding_force(y);
    if (!released && std::abs(force) <= static_limit_) {
      mode_ = 0;
    } else {
      mode_ = force > 0.0 ? 1 : -1;
    }
  }

  void finish(const double* y, PeerRun& out_run) const {
    out_run.q.assign(y, y + p_.n);
    out_run.v.assign(y + p_.n, y + 2 * p_.n);
    out_run.v.back() += p_.belt;
  }

 private:
  [[nodiscard]] double friction(double w) const {
    if (p_.coulomb) return mode_ * kinetic_;
    // In trial steps past v_rel = 0 the law is continued, but not without bound.
    const double speed = std::max(-mode_ * w, -1.0 / (p_.alpha + 1.0));
    return mode_ * (kinetic_ + (static_limit_ - kinetic_) * std::exp(-p_.alpha * speed));
  }

  ChainProblem p_;
  double static_limit_, kinetic_;
  int mode_ = 0;
  bool first_ = true;
};

}  // namespace slipmode::bench
