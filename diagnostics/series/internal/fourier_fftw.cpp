#include "diagnostics/series/internal/fourier.hpp"

#include <slipmode/core/errors.hpp>

#include <fftw3.h>
#include <fmt/format.h>

#include <complex>
#include <mutex>

namespace slipmode::diagnostics {

namespace {

/// Without vector instructions: FFTW would choose by the processor's, and the last bits with them.
constexpr unsigned kPlan = FFTW_ESTIMATE | FFTW_NO_SIMD;

/// FFTW's planner keeps state of its own and serves one thread at a time.
std::mutex& planner() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct RealTransform::Plans {
  explicit Plans(Eigen::Index length)
      : n(length),
        real(fftw_alloc_real(static_cast<std::size_t>(n))),
        complex(fftw_alloc_complex(static_cast<std::size_t>(n / 2 + 1))) {
    const std::lock_guard lock(planner());
    forward = fftw_plan_dft_r2c_1d(static_cast<int>(n), real, complex, kPlan);
    inverse = fftw_plan_dft_c2r_1d(static_cast<int>(n), complex, real, kPlan);
  }
  ~Plans() {
    const std::lock_guard lock(planner());
    fftw_destroy_plan(forward);
    fftw_destroy_plan(inverse);
    fftw_free(real);
    fftw_free(complex);
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;

  Eigen::Map<Eigen::VectorXcd> spectrum() const {
    return {reinterpret_cast<std::complex<double>*>(complex), n / 2 + 1};
  }

  Eigen::Index n;
  double* real;
  fftw_complex* complex;
  fftw_plan forward = nullptr;
  fftw_plan inverse = nullptr;
};

RealTransform::RealTransform(Eigen::Index n) {
  if (n < 1) throw InvalidInput(fmt::format("Fourier transform: expected a length of at least 1, found {}", n));
  plans_ = std::make_unique<Plans>(n);
}

RealTransform::~RealTransform() = default;

Eigen::VectorXcd RealTransform::forward(const Eigen::VectorXd& x) {
  Eigen::Map<Eigen::VectorXd>(plans_->real, plans_->n) = x;
  fftw_execute(plans_->forward);
  return plans_->spectrum();
}

Eigen::VectorXd RealTransform::inverse(const Eigen::VectorXcd& X) {
  plans_->spectrum() = X;
  fftw_execute(plans_->inverse);
  return Eigen::Map<Eigen::VectorXd>(plans_->real, plans_->n) / static_cast<double>(plans_->n);
}

}  // namespace slipmode::diagnostics
