#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace slipmode::orbits {

/// S0 (2.4)-(2.9) by classical Runge-Kutta with fixed steps and events by bisection: no code of the library.
struct BacklashReference {
  double amplitude = 1.0, omega = 1.0;
  double c = 0.05, k = 4.0, damping = 0.5, gap = 1.0;

  enum Mode { kLeft = -1, kFree = 0, kRight = 1 };
  struct Point {
    double t = 0.0;
    Eigen::Vector2d x;
    Mode mode = kFree;
    bool flying = false;  ///< beyond the gap without contact
  };
  struct Switch {
    double time;
    Mode before, after;
    Eigen::Vector2d x;
  };

  [[nodiscard]] double stop_force(const Eigen::Vector2d& x, int side) const {
    return side * (k * (x[0] - side * gap) + damping * x[1]);  // positive: it presses
  }
  [[nodiscard]] Eigen::Vector2d rate(double t, const Eigen::Vector2d& x, Mode mode) const {
    const double stop = mode == kFree ? 0.0 : k * (x[0] - static_cast<int>(mode) * gap) + damping * x[1];
    return {x[1], amplitude * std::sin(omega * t) - c * x[1] - stop};
  }
  [[nodiscard]] Eigen::Vector2d step(const Point& p, double h) const {
    const Eigen::Vector2d a = rate(p.t, p.x, p.mode), b = rate(p.t + h / 2, p.x + h / 2 * a, p.mode),
                          d = rate(p.t + h / 2, p.x + h / 2 * b, p.mode), e = rate(p.t + h, p.x + h * d, p.mode);
    return p.x + h / 6 * (a + 2 * b + 2 * d + e);
  }
  /// The guard that must stay positive.
  [[nodiscard]] double guard(const Point& p, const Eigen::Vector2d& x) const {
    if (p.mode != kFree) return stop_force(x, static_cast<int>(p.mode));
    const int side = p.x[0] > 0 ? 1 : -1;
    if (p.flying) return -stop_force(x, side);
    return gap - std::abs(x[0]);
  }

  [[nodiscard]] Point run(Point p, double duration, int steps, std::vector<Switch>* out_switches = nullptr) const {
    const double end = p.t + duration, h = duration / steps;
    while (p.t < end - 1e-13 * duration) {
      const double whole = std::min(h, end - p.t);
      const Eigen::Vector2d next = step(p, whole);
      const int side = p.x[0] > 0 ? 1 : -1;
      if (p.flying && side * next[0] < gap) p.flying = false;  // back in the gap, where nothing happens
      if (guard(p, next) >= 0) {
        p.x = next;
        p.t += whole;
        continue;
      }
      double low = 0.0, high = whole;
      while (high - low > 1e-15 * (1.0 + std::abs(p.t))) {
        const double middle = 0.5 * (low + high);
        (guard(p, step(p, middle)) >= 0 ? low : high) = middle;
      }
      const Mode before = p.mode;
      p.x = step(p, high);
      p.t += high;
      p.mode = before == kFree ? (p.x[0] > 0 ? kRight : kLeft) : kFree;
      p.flying = p.mode == kFree && std::abs(p.x[0]) > gap;
      if (out_switches != nullptr) out_switches->push_back({p.t, before, p.mode, p.x});
    }
    return p;
  }

  /// e^{A t} of a mode.
  [[nodiscard]] Eigen::Matrix2d free_map(double t, Mode mode) const {
    const double stiffness = mode == kFree ? 0.0 : k, dashpot = c + (mode == kFree ? 0.0 : damping);
    const double half = dashpot / 2, square = half * half - stiffness;
    const double root = std::sqrt(std::abs(square));
    const double even = square > 0 ? std::cosh(root * t) : std::cos(root * t);
    const double odd = square > 0 ? std::sinh(root * t) / root : std::sin(root * t) / root;
    Eigen::Matrix2d A;
    A << 0, 1, -stiffness, -dashpot;
    return std::exp(-half * t) * (even * Eigen::Matrix2d::Identity() + odd * (A + half * Eigen::Matrix2d::Identity()));
  }
  /// I + (f⁺ − f⁻) nᵀ / (nᵀ f⁻) on reaching a stop (n = e₁); on leaving one forces are continuous: I.
  [[nodiscard]] Eigen::Matrix2d saltation(const Switch& s) const {
    Eigen::Matrix2d S = Eigen::Matrix2d::Identity();
    if (s.before != kFree || std::abs(std::abs(s.x[0]) - gap) > 1e-9) return S;
    const Eigen::Vector2d jump = rate(s.time, s.x, s.after) - rate(s.time, s.x, s.before);
    S.col(0) += jump / s.x[1];
    return S;
  }
};

}  // namespace slipmode::orbits
