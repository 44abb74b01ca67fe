#include "bench/orbit_peer.hpp"

#include "bench/cvode_solver.hpp"

#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace slipmode::bench {
namespace {

/// A step of differences that balances truncation with CVODE's own error.
constexpr double kDifference = 1e-5;
constexpr int kMostSteps = 20;

/// The mass with what it does: 0 in the gap, ±1 at a stop, ±2 beyond a gap whose stop has let go.
struct Motion {
  BacklashMass mass;
  int where = 0;

  [[nodiscard]] double press(const double* y, double side) const {
    return mass.stop_stiffness * (side * y[0] - mass.gap) + mass.stop_damping * side * y[1];
  }
  void place(const double* y) {
    where = 0;
    for (const int side : {-1, 1})
      if (side * y[0] > mass.gap) where = press(y, side) > 0.0 ? side : 2 * side;
  }
};

int rhs(realtype t, N_Vector state, N_Vector out, void* user) {
  const auto& m = *static_cast<const Motion*>(user);
  const double* y = N_VGetArrayPointer(state);
  double* dy = N_VGetArrayPointer(out);
  dy[0] = y[1];
  dy[1] = m.mass.amplitude * std::sin(m.mass.omega * t) - m.mass.damping * y[1];
  if (std::abs(m.where) == 1) dy[1] -= m.where * m.press(y, m.where);
  return 0;
}

/// Guards that fall through zero.
int guards(realtype, N_Vector state, realtype* out_g, void* user) {
  const auto& m = *static_cast<const Motion*>(user);
  const double* y = N_VGetArrayPointer(state);
  const double side = m.where < 0 ? -1.0 : 1.0;
  if (m.where == 0) {
    out_g[0] = m.mass.gap - y[0];
    out_g[1] = m.mass.gap + y[0];
  } else if (std::abs(m.where) == 1) {
    out_g[0] = m.press(y, side);
    out_g[1] = 1.0;
  } else {
    out_g[0] = side * y[0] - m.mass.gap;
    out_g[1] = -m.press(y, side);
  }
  return 0;
}

class Period {
 public:
  Period(const BacklashMass& mass, double tolerance) : motion_{mass}, solver_(CV_ADAMS, 2) {
    check_cvode(CVodeInit(solver_.memory, rhs, 0.0, solver_.y), "CVodeInit");
    check_cvode(CVodeSStolerances(solver_.memory, tolerance, 1e-2 * tolerance), "CVodeSStolerances");
    check_cvode(CVodeSetUserData(solver_.memory, &motion_), "CVodeSetUserData");
    check_cvode(CVodeSetMaxNumSteps(solver_.memory, kCvodeMaxSteps), "CVodeSetMaxNumSteps");
    solver_.fixed_point = SUNNonlinSol_FixedPoint(solver_.y, 0, solver_.context);
    check_cvode(CVodeSetNonlinearSolver(solver_.memory, solver_.fixed_point), "CVodeSetNonlinearSolver");
    check_cvode(CVodeRootInit(solver_.memory, 2, guards), "CVodeRootInit");
    int falling[2] = {-1, -1};
    check_cvode(CVodeSetRootDirection(solver_.memory, falling), "CVodeSetRootDirection");
    check_cvode(CVodeSetNoInactiveRootWarn(solver_.memory), "CVodeSetNoInactiveRootWarn");
  }

  [[nodiscard]] Eigen::Vector2d map(const Eigen::Vector2d& start) {
    ++runs;
    double* y = solver_.data();
    y[0] = start(0);
    y[1] = start(1);
    motion_.place(y);
    check_cvode(CVodeReInit(solver_.memory, 0.0, solver_.y), "CVodeReInit");
    const double end = 2.0 * std::numbers::pi / motion_.mass.omega;
    for (double t = 0.0; t < end;) {
      const int flag = CVode(solver_.memory, end, solver_.y, &t, CV_NORMAL);
      check_cvode(flag, "CVode");
      if (flag != CV_ROOT_RETURN) break;
      int found[2] = {0, 0};
      check_cvode(CVodeGetRootInfo(solver_.memory, found), "CVodeGetRootInfo");
      const int side = motion_.where < 0 ? -1 : 1;
      motion_.where = motion_.where == 0             ? (found[0] != 0 ? 1 : -1)
                      : std::abs(motion_.where) == 1 ? 2 * side
                                                     : (found[0] != 0 ? 0 : side);
      check_cvode(CVodeReInit(solver_.memory, t, solver_.y), "CVodeReInit");
    }
    return {y[0], y[1]};
  }

  int runs = 0;

 private:
  Motion motion_;
  CvodeSolver solver_;
};

}  // namespace

PeerOrbit shoot_with_cvode(const BacklashMass& mass, const Eigen::Vector2d& guess, double tolerance) {
  Period period(mass, tolerance);
  PeerOrbit orbit;
  orbit.start = guess;
  for (double previous = 1e300; orbit.iterations <= kMostSteps; ++orbit.iterations) {
    const Eigen::Vector2d end = period.map(orbit.start), miss = end - orbit.start;
    Eigen::Matrix2d M;
    for (int i = 0; i < 2; ++i)
      M.col(i) = (period.map(orbit.start + kDifference * Eigen::Vector2d::Unit(i)) - end) / kDifference;
    orbit.residual = miss.norm();
    if (orbit.residual < 100.0 * tolerance || (orbit.residual < 1e-6 && orbit.residual > 0.5 * previous)) {
      orbit.multipliers = M.eigenvalues();
      orbit.runs = period.runs;
      return orbit;
    }
    previous = orbit.residual;
    orbit.start -= (M - Eigen::Matrix2d::Identity()).lu().solve(miss);
  }
  throw std::runtime_error("CVODE: no orbit after 20 Newton steps");
}

}  // namespace slipmode::bench
