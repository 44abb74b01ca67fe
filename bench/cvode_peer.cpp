#include "bench/cvode_peer.hpp"

#include "bench/cvode_solver.hpp"
#include "bench/event_chain.hpp"

#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

namespace slipmode::bench {
namespace {

int chain_rhs(realtype, N_Vector y, N_Vector dy, void* user) {
  static_cast<const EventChain*>(user)->derivative(N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
  return 0;
}

int chain_guards(realtype, N_Vector y, realtype* out_g, void* user) {
  const auto& chain = *static_cast<const EventChain*>(user);
  const double* values = N_VGetArrayPointer(y);
  if (chain.mode() != 0) {
    out_g[0] = chain.slip_guard(values);
    out_g[1] = 1.0;
    return 0;
  }
  const double force = chain.holding_force(values);
  out_g[0] = chain.static_limit() - force;
  out_g[1] = chain.static_limit() + force;
  return 0;
}

/// Interleaved unknowns x1, v1, x2, v2, ... so that the Jacobian is a band.
struct TanhChain {
  ChainProblem p;
  double epsilon;

  [[nodiscard]] double diagonal(int i) const { return (i + 1 < p.n ? 2.0 : 1.0) + p.ground; }

  [[nodiscard]] double force(double s) const {
    const double t = std::tanh(s / epsilon);
    return p.load * (p.mu_k + (p.mu_s - p.mu_k) * std::exp(-p.alpha * s * t)) * t;
  }
  [[nodiscard]] double force_slope(double s) const {
    const double t = std::tanh(s / epsilon), dt = (1.0 - t * t) / epsilon;
    const double e = (p.mu_s - p.mu_k) * std::exp(-p.alpha * s * t);
    return p.load * ((p.mu_k + e) * dt - p.alpha * e * (t + s * dt) * t);
  }
};

int tanh_rhs(realtype, N_Vector y, N_Vector dy, void* user) {
  const auto& chain = *static_cast<const TanhChain*>(user);
  const double* u = N_VGetArrayPointer(y);
  double* du = N_VGetArrayPointer(dy);
  const int n = chain.p.n;
  const double c = chain.p.damping;
  for (int i = 0; i < n; ++i) {
    const double own = u[2 * i] + c * u[2 * i + 1];
    const double left = i > 0 ? u[2 * i - 2] + c * u[2 * i - 1] : 0.0;
    const double right = i + 1 < n ? u[2 * i + 2] + c * u[2 * i + 3] : 0.0;
    du[2 * i] = u[2 * i + 1];
    du[2 * i + 1] = left + right - chain.diagonal(i) * own;
  }
  du[2 * n - 1] += chain.force(chain.p.belt - u[2 * n - 1]);
  return 0;
}

int tanh_jacobian(realtype, N_Vector y, N_Vector, SUNMatrix J, void* user, N_Vector, N_Vector, N_Vector) {
  const auto& chain = *static_cast<const TanhChain*>(user);
  const int n = chain.p.n;
  const double c = chain.p.damping;
  SUNMatZero(J);
  for (int i = 0; i < n; ++i) {
    SM_ELEMENT_B(J, 2 * i, 2 * i + 1) = 1.0;
    for (int j = std::max(0, i - 1); j <= std::min(n - 1, i + 1); ++j) {
      const double k = i == j ? -chain.diagonal(i) : 1.0;
      SM_ELEMENT_B(J, 2 * i + 1, 2 * j) = k;
      SM_ELEMENT_B(J, 2 * i + 1, 2 * j + 1) = c * k;
    }
  }
  SM_ELEMENT_B(J, 2 * n - 1, 2 * n - 1) -= chain.force_slope(chain.p.belt - N_VGetArrayPointer(y)[2 * n - 1]);
  return 0;
}

}  // namespace

PeerRun run_cvode_adams(const ChainProblem& problem, const std::vector<double>& q, const std::vector<double>& v,
                        double duration, double rtol, double atol) {
  EventChain chain(problem);
  CvodeSolver solver(CV_ADAMS, chain.size());
  chain.start(q, v, solver.data());
  check_cvode(CVodeInit(solver.memory, chain_rhs, 0.0, solver.y), "CVodeInit");
  check_cvode(CVodeSStolerances(solver.memory, rtol, atol), "CVodeSStolerances");
  check_cvode(CVodeSetUserData(solver.memory, &chain), "CVodeSetUserData");
  check_cvode(CVodeSetMaxNumSteps(solver.memory, kCvodeMaxSteps), "CVodeSetMaxNumSteps");
  solver.fixed_point = SUNNonlinSol_FixedPoint(solver.y, 0, solver.context);
  check_cvode(CVodeSetNonlinearSolver(solver.memory, solver.fixed_point), "CVodeSetNonlinearSolver");
  check_cvode(CVodeRootInit(solver.memory, 2, chain_guards), "CVodeRootInit");
  int falling[2] = {-1, -1};
  check_cvode(CVodeSetRootDirection(solver.memory, falling), "CVodeSetRootDirection");
  check_cvode(CVodeSetNoInactiveRootWarn(solver.memory), "CVodeSetNoInactiveRootWarn");

  PeerRun run;
  double t = 0.0;
  while (t < duration) {
    const int flag = CVode(solver.memory, duration, solver.y, &t, CV_NORMAL);
    check_cvode(flag, "CVode");
    if (flag != CV_ROOT_RETURN) break;
    chain.resolve(solver.data());
    run.event_times.push_back(t);
    run.steps += solver.steps();
    check_cvode(CVodeReInit(solver.memory, t, solver.y), "CVodeReInit");
  }
  run.steps += solver.steps();
  chain.finish(solver.data(), run);
  return run;
}

PeerRun run_cvode_bdf_tanh(const ChainProblem& problem, double epsilon, const std::vector<double>& q,
                           const std::vector<double>& v, double duration, double rtol, double atol) {
  TanhChain chain{problem, epsilon};
  if (problem.coulomb) chain.p.alpha = 0.0, chain.p.mu_s = problem.mu_k;
  const int n = problem.n;
  CvodeSolver solver(CV_BDF, 2 * n);
  for (int i = 0; i < n; ++i) {
    solver.data()[2 * i] = q[i];
    solver.data()[2 * i + 1] = v[i];
  }
  check_cvode(CVodeInit(solver.memory, tanh_rhs, 0.0, solver.y), "CVodeInit");
  check_cvode(CVodeSStolerances(solver.memory, rtol, atol), "CVodeSStolerances");
  check_cvode(CVodeSetUserData(solver.memory, &chain), "CVodeSetUserData");
  check_cvode(CVodeSetMaxNumSteps(solver.memory, kCvodeMaxSteps), "CVodeSetMaxNumSteps");
  solver.matrix = SUNBandMatrix(2 * n, 2, 3, solver.context);
  solver.linear = SUNLinSol_Band(solver.y, solver.matrix, solver.context);
  check_cvode(CVodeSetLinearSolver(solver.memory, solver.linear, solver.matrix), "CVodeSetLinearSolver");
  check_cvode(CVodeSetJacFn(solver.memory, tanh_jacobian), "CVodeSetJacFn");

  PeerRun run;
  double t = 0.0;
  check_cvode(CVode(solver.memory, duration, solver.y, &t, CV_NORMAL), "CVode");
  run.steps = solver.steps();
  for (int i = 0; i < n; ++i) {
    run.q.push_back(solver.data()[2 * i]);
    run.v.push_back(solver.data()[2 * i + 1]);
  }
  return run;
}

}  // namespace slipmode::bench
