#include "diagnostics/series/internal/fourier.hpp"

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

#include <complex>

// In place of fourier_fftw.cpp where FFTW is missing or its licence unwanted: the KISS FFT that comes with Eigen.

namespace slipmode::diagnostics {

struct RealTransform::Plans {
  Eigen::Index n;
  Eigen::FFT<double> transform{Eigen::FFT<double>::impl_type(), Eigen::FFT<double>::HalfSpectrum};
};

RealTransform::RealTransform(Eigen::Index n) {
  if (n < 1) throw InvalidInput(fmt::format("Fourier transform: expected a length of at least 1, found {}", n));
  plans_ = std::make_unique<Plans>(Plans{.n = n});
}

RealTransform::~RealTransform() = default;

Eigen::VectorXcd RealTransform::forward(const Eigen::VectorXd& x) {
  if (plans_->n == 1) return x;  // a length that KISS FFT has no butterfly for
  Eigen::VectorXcd X(plans_->n / 2 + 1);
  plans_->transform.fwd(X.data(), x.data(), plans_->n);
  return X;
}

Eigen::VectorXd RealTransform::inverse(const Eigen::VectorXcd& X) {
  if (plans_->n == 1) return X.real();
  Eigen::VectorXd x(plans_->n);
  plans_->transform.inv(x.data(), X.data(), plans_->n);
  return x;
}

}  // namespace slipmode::diagnostics
