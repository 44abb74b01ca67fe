#pragma once

#include <Eigen/Core>
#include <memory>

namespace slipmode::diagnostics {

/// Fourier transforms of real series of one fixed length n; plans and buffers are made once. By FFTW
/// (fourier_fftw.cpp), O(n log n) for any n, or without it (SLIPMODE_FFTW off) by KISS FFT (fourier_kiss.cpp), O(n ·
/// its prime factors). One object serves one thread at a time; different objects may be used, made and destroyed in
/// different threads.
class RealTransform {
 public:
  /// @param n  length, ≥ 1
  /// @throws InvalidInput  for n < 1
  explicit RealTransform(Eigen::Index n);
  ~RealTransform();
  RealTransform(const RealTransform&) = delete;
  RealTransform& operator=(const RealTransform&) = delete;

  /// X_k = Σ_j x_j e^{−2πijk/n}, k = 0 … n/2 [n/2 + 1].
  /// @param x  series [n]
  [[nodiscard]] Eigen::VectorXcd forward(const Eigen::VectorXd& x);

  /// x_j = (1/n) Σ_k X_k e^{2πijk/n} over all k, with X_{n−k} the conjugate of X_k: undoes forward [n].
  /// @param X  transform [n/2 + 1]
  [[nodiscard]] Eigen::VectorXd inverse(const Eigen::VectorXcd& X);

 private:
  struct Plans;
  std::unique_ptr<Plans> plans_;
};

}  // namespace slipmode::diagnostics
