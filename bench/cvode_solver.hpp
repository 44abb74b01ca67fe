#pragma once

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdexcept>
#include <string>

namespace slipmode::bench {

/// Owns what CVODE allocates.
struct CvodeSolver {
  SUNContext context = nullptr;
  N_Vector y = nullptr;
  void* memory = nullptr;
  SUNNonlinearSolver fixed_point = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNMatrix matrix = nullptr;

  CvodeSolver(int method, int size) {
    SUNContext_Create(nullptr, &context);
    y = N_VNew_Serial(size, context);
    memory = CVodeCreate(method, context);
  }
  CvodeSolver(const CvodeSolver&) = delete;
  CvodeSolver& operator=(const CvodeSolver&) = delete;
  ~CvodeSolver() {
    CVodeFree(&memory);
    if (fixed_point != nullptr) SUNNonlinSolFree(fixed_point);
    if (linear != nullptr) SUNLinSolFree(linear);
    if (matrix != nullptr) SUNMatDestroy(matrix);
    N_VDestroy(y);
    SUNContext_Free(&context);
  }
  [[nodiscard]] double* data() const { return N_VGetArrayPointer(y); }
  [[nodiscard]] long steps() const {
    long count = 0;
    CVodeGetNumSteps(memory, &count);
    return count;
  }
};

/// @throws std::runtime_error  for a flag that means failure
inline void check_cvode(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string("CVODE: ") + what + " failed with flag " + std::to_string(flag));
}

inline constexpr long kCvodeMaxSteps = 2'000'000'000L;

}  // namespace slipmode::bench
