#include "bench/shaken_cvode.hpp"

#include "bench/cvode_solver.hpp"
#include "bench/event_beam.hpp"

#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

namespace slipmode::bench {
namespace {

using Beam = EventBeam<double>;

int beam_rhs(realtype t, N_Vector y, N_Vector dy, void* user) {
  static_cast<const Beam*>(user)->derivative(N_VGetArrayPointer(y), N_VGetArrayPointer(dy), t);
  return 0;
}

int beam_guards(realtype t, N_Vector y, realtype* out_g, void* user) {
  static_cast<const Beam*>(user)->guards(N_VGetArrayPointer(y), t, out_g);
  return 0;
}

int jacobian(realtype, N_Vector, N_Vector, SUNMatrix J, void* user, N_Vector, N_Vector, N_Vector) {
  const auto& beam = *static_cast<const Beam*>(user);
  const ShakenProblem& p = beam.problem();
  const double slope = beam.force_slope();
  SUNMatZero(J);
  for (int i = 0; i < p.n; ++i) {
    SM_ELEMENT_D(J, i, p.n + i) = p.omega[i];
    for (int j = 0; j < p.n; ++j) {
      SM_ELEMENT_D(J, p.n + i, j) = slope * p.direction[i] * beam.row()[j];
      if (!p.diagonal()) SM_ELEMENT_D(J, p.n + i, p.n + j) = -p.damping[i * p.n + j];
    }
    SM_ELEMENT_D(J, p.n + i, i) -= p.omega[i];
    if (p.diagonal()) SM_ELEMENT_D(J, p.n + i, p.n + i) = -p.damping[i];
  }
  return 0;
}

void set_iteration(ShakenMethod method, CvodeSolver& solver, int size) {
  if (method == ShakenMethod::kAdams) {
    solver.fixed_point = SUNNonlinSol_FixedPoint(solver.y, 0, solver.context);
    check_cvode(CVodeSetNonlinearSolver(solver.memory, solver.fixed_point), "CVodeSetNonlinearSolver");
    return;
  }
  solver.matrix = SUNDenseMatrix(size, size, solver.context);
  solver.linear = SUNLinSol_Dense(solver.y, solver.matrix, solver.context);
  check_cvode(CVodeSetLinearSolver(solver.memory, solver.linear, solver.matrix), "CVodeSetLinearSolver");
  check_cvode(CVodeSetJacFn(solver.memory, jacobian), "CVodeSetJacFn");
}

}  // namespace

ShakenRun run_shaken_cvode(ShakenMethod method, const ShakenProblem& problem, const ShakenPoint& start, double duration,
                           double tolerance) {
  Beam beam(problem, start);
  CvodeSolver solver(method == ShakenMethod::kAdams ? CV_ADAMS : CV_BDF, beam.size());
  std::copy(start.y.begin(), start.y.end(), solver.data());
  double t = start.time;
  check_cvode(CVodeInit(solver.memory, beam_rhs, t, solver.y), "CVodeInit");
  check_cvode(CVodeSStolerances(solver.memory, tolerance, tolerance * energy_norm(start.y)), "CVodeSStolerances");
  check_cvode(CVodeSetUserData(solver.memory, &beam), "CVodeSetUserData");
  check_cvode(CVodeSetMaxNumSteps(solver.memory, kCvodeMaxSteps), "CVodeSetMaxNumSteps");
  set_iteration(method, solver, beam.size());
  check_cvode(CVodeRootInit(solver.memory, 2, beam_guards), "CVodeRootInit");
  int falling[2] = {-1, -1};
  check_cvode(CVodeSetRootDirection(solver.memory, falling), "CVodeSetRootDirection");
  check_cvode(CVodeSetNoInactiveRootWarn(solver.memory), "CVodeSetNoInactiveRootWarn");

  ShakenRun run;
  const double end = start.time + duration;
  while (t < end) {
    const int flag = CVode(solver.memory, end, solver.y, &t, CV_NORMAL);
    check_cvode(flag, "CVode");
    if (flag != CV_ROOT_RETURN) break;
    beam.change(solver.data(), t);
    run.event_times.push_back(t);
    run.steps += solver.steps();
    check_cvode(CVodeReInit(solver.memory, t, solver.y), "CVodeReInit");
  }
  run.steps += solver.steps();
  run.y.assign(solver.data(), solver.data() + beam.size());
  return run;
}

}  // namespace slipmode::bench
