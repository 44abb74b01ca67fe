#pragma once

#include "bench/shaken_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slipmode::bench {

/// The shaken beam as the peers integrate it: what its compliant contact does, and when that changes.
///
/// Stick: λ = K_c (y_c − y), the contact point y_c carried by the slider, ended by |λ| = μ_s N. Slip ±: λ = ±μ_k N(y),
/// ended when the contact point's sliding speed ±(d' − ẏ ∓ μ_k N1 ẏ/K_c) falls to zero. Source:
/// docs/theory/compliant-contacts.md section 1, written again here.
/// @tparam Real  double for the peers, long double for the reference
template <class Real>
class EventBeam {
 public:
  EventBeam(const ShakenProblem& p, const ShakenPoint& start)
      : p_(p), mode_(start.mode), anchor_(start.stretch - shaker(start.time)), row_(p.n) {
    for (int i = 0; i < p.n; ++i) row_[i] = static_cast<Real>(p.direction[i]) / static_cast<Real>(p.omega[i]);
    anchor_ += displacement(std::vector<Real>(start.y.begin(), start.y.end()).data());
  }

  [[nodiscard]] int size() const { return 2 * p_.n; }
  [[nodiscard]] int mode() const { return mode_; }
  [[nodiscard]] const ShakenProblem& problem() const { return p_; }
  [[nodiscard]] const std::vector<Real>& row() const { return row_; }  ///< y = row · a + offset

  void derivative(const Real* __restrict y, Real* __restrict out_dy, Real t) const {
    const int n = p_.n;
    const Real force = lambda(y, t);
    const Real *a = y, *b = y + n;
    for (int i = 0; i < n; ++i) out_dy[i] = static_cast<Real>(p_.omega[i]) * b[i];
    for (int i = 0; i < n; ++i) {
      out_dy[n + i] = static_cast<Real>(p_.direction[i]) * force - static_cast<Real>(p_.omega[i]) * a[i] +
                      static_cast<Real>(p_.load[i]);
    }
    if (p_.diagonal()) {
      for (int i = 0; i < n; ++i) out_dy[n + i] -= static_cast<Real>(p_.damping[i]) * b[i];
      return;
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) out_dy[n + i] -= static_cast<Real>(p_.damping[i * n + j]) * b[j];
    }
  }

  /// dλ/dy, for Jacobians [N/m].
  [[nodiscard]] Real force_slope() const {
    return mode_ == 0 ? -static_cast<Real>(p_.stiffness) : mode_ * kinetic() * static_cast<Real>(p_.load_slope);
  }

  /// Guards of the present mode, positive before the event; the second is of no account in slip.
  void guards(const Real* y, Real t, Real* out_g) const {
    if (mode_ != 0) {
      out_g[0] = mode_ * sliding_speed(y, t);
      out_g[1] = normal_load(displacement(y));
      return;
    }
    const Real at = displacement(y), N = normal_load(at), force = spring_force(at, t);
    out_g[0] = static_cast<Real>(p_.static_plus) * N - force;
    out_g[1] = static_cast<Real>(p_.static_minus) * N + force;
  }
  [[nodiscard]] Real guard(const Real* y, Real t) const {
    Real g[2];
    guards(y, t, g);
    return std::min(g[0], g[1]);
  }

  /// After a guard was met: the mode that follows.
  void change(const Real* y, Real t) {
    const Real at = displacement(y), N = normal_load(at);
    if (!(N > 0)) throw std::runtime_error("the contact was lost, which the peers do not follow");
    if (mode_ != 0) {
      hold(at, mode_ * kinetic() * N, t);
      return;
    }
    mode_ = spring_force(at, t) > 0 ? 1 : -1;
    if (mode_ * sliding_speed(y, t) <= 0) hold(at, mode_ * kinetic() * N, t);  // the contact point jumped and stays
  }

 private:
  [[nodiscard]] Real shaker(Real t) const {
    return static_cast<Real>(p_.amplitude) *
           std::sin(static_cast<Real>(p_.drive_omega) * t + static_cast<Real>(p_.phase));
  }
  [[nodiscard]] Real shaker_velocity(Real t) const {
    const Real omega = static_cast<Real>(p_.drive_omega);
    return static_cast<Real>(p_.amplitude) * omega * std::cos(omega * t + static_cast<Real>(p_.phase));
  }
  [[nodiscard]] Real displacement(const Real* y) const {
    Real sum = static_cast<Real>(p_.offset);
    for (int i = 0; i < p_.n; ++i) sum += row_[i] * y[i];
    return sum;
  }
  [[nodiscard]] Real velocity(const Real* y) const {
    Real sum = 0;
    for (int i = 0; i < p_.n; ++i) sum += static_cast<Real>(p_.direction[i]) * y[p_.n + i];
    return sum;
  }
  [[nodiscard]] Real normal_load(Real at) const {
    return static_cast<Real>(p_.load_constant) + static_cast<Real>(p_.load_slope) * at;
  }
  [[nodiscard]] Real kinetic() const { return static_cast<Real>(mode_ > 0 ? p_.kinetic_plus : p_.kinetic_minus); }
  /// y_c = anchor + d(t).
  [[nodiscard]] Real spring_force(Real at, Real t) const {
    return static_cast<Real>(p_.stiffness) * (anchor_ + shaker(t) - at);
  }
  [[nodiscard]] Real lambda(const Real* y, Real t) const {
    const Real at = displacement(y);
    return mode_ == 0 ? spring_force(at, t) : mode_ * kinetic() * normal_load(at);
  }
  [[nodiscard]] Real sliding_speed(const Real* y, Real t) const {
    const Real ratio = static_cast<Real>(p_.load_slope) / static_cast<Real>(p_.stiffness);
    return shaker_velocity(t) - velocity(y) * (1 + mode_ * kinetic() * ratio);
  }
  void hold(Real at, Real force, Real t) {
    mode_ = 0;
    anchor_ = at + force / static_cast<Real>(p_.stiffness) - shaker(t);
  }

  ShakenProblem p_;
  int mode_;
  Real anchor_;
  std::vector<Real> row_;
};

}  // namespace slipmode::bench
