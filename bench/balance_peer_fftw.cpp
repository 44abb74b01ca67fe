#include "bench/balance_peer.hpp"

#include <fftw3.h>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::bench {
namespace {

using Eigen::Index;

constexpr double kNewtonTolerance = 1e-12;
constexpr int kMostSteps = 60;

/// Coefficients of one displacement or force: mean, cosines, sines [2H + 1].
using Coefficients = Eigen::VectorXd;

class FftwScheme : public AlternatingScheme {
 public:
  FftwScheme(int harmonics, int samples)
      : H_(harmonics),
        N_(samples),
        B_(2 * harmonics + 1),
        base_(N_, B_),
        slope_(N_, B_),
        real_(N_, B_ + 1),
        complex_(N_ / 2 + 1, B_ + 1) {
    for (Index n = 0; n < N_; ++n) {
      base_(n, 0) = 1.0;
      slope_(n, 0) = 0.0;
      for (Index k = 1; k <= H_; ++k) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(k * n % N_) / static_cast<double>(N_);
        base_(n, k) = std::cos(angle);
        base_(n, H_ + k) = std::sin(angle);
        slope_(n, k) = -static_cast<double>(k) * std::sin(angle);
        slope_(n, H_ + k) = static_cast<double>(k) * std::cos(angle);
      }
    }
    const int length = samples, columns = static_cast<int>(B_ + 1);
    auto* spectrum = reinterpret_cast<fftw_complex*>(complex_.data());
    to_time_ = fftw_plan_dft_c2r_1d(length, spectrum, real_.data(), FFTW_MEASURE);
    to_orders_ = fftw_plan_many_dft_r2c(1, &length, columns, real_.data(), nullptr, 1, length, spectrum, nullptr, 1,
                                        length / 2 + 1, FFTW_MEASURE);
  }
  FftwScheme(const FftwScheme&) = delete;
  FftwScheme& operator=(const FftwScheme&) = delete;
  ~FftwScheme() override {
    fftw_destroy_plan(to_time_);
    fftw_destroy_plan(to_orders_);
  }

  [[nodiscard]] PeerBalance solve(const PeerProblem& problem) const override {
    return newton(problem, linear_response(problem));
  }

  [[nodiscard]] PeerBalance solve(const PeerProblem& problem, const PeerBalance& near) const override {
    Eigen::VectorXd x(problem.M.rows() * B_);
    for (Index i = 0; i < problem.M.rows(); ++i) {
      const orbits::Harmonics& own = near.displacement[static_cast<std::size_t>(i)];
      x.segment(i * B_, H_ + 1) = own.cosine;
      x.segment(i * B_ + H_ + 1, H_) = own.sine.tail(H_);
    }
    return newton(problem, std::move(x));
  }

 private:
  /// Dynamic stiffness of all orders, by degree of freedom and order.
  [[nodiscard]] Eigen::MatrixXd linear_part(const PeerProblem& problem, bool springs) const {
    const Index n = problem.M.rows();
    Eigen::MatrixXd K = problem.K, A = Eigen::MatrixXd::Zero(n * B_, n * B_);
    for (const PeerElement& element : problem.elements)
      if (springs && element.kind == PeerElement::Kind::kJenkins) K(element.dof, element.dof) += element.stiffness;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        A(i * B_, j * B_) = K(i, j);
        for (Index k = 1; k <= H_; ++k) {
          const double w = static_cast<double>(k) * problem.omega;
          const double own = K(i, j) - w * w * problem.M(i, j), cross = w * problem.C(i, j);
          A(i * B_ + k, j * B_ + k) = A(i * B_ + H_ + k, j * B_ + H_ + k) = own;
          A(i * B_ + k, j * B_ + H_ + k) = cross;
          A(i * B_ + H_ + k, j * B_ + k) = -cross;
        }
      }
    return A;
  }

  [[nodiscard]] Eigen::VectorXd load(const PeerProblem& problem) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(problem.M.rows() * B_);
    out[problem.driven * B_ + H_ + 1] = problem.amplitude;
    return out;
  }

  [[nodiscard]] Eigen::VectorXd linear_response(const PeerProblem& problem) const {
    return linear_part(problem, true).partialPivLu().solve(load(problem));
  }

  /// Newton's method, steps halved until the residual falls.
  [[nodiscard]] PeerBalance newton(const PeerProblem& problem, Eigen::VectorXd x) const {
    PeerBalance out;
    const Eigen::MatrixXd A = linear_part(problem, false);
    const Eigen::VectorXd p = load(problem);
    Eigen::MatrixXd J;
    Eigen::VectorXd r = residual(problem, A, p, x, J);
    const double small = kNewtonTolerance * p.cwiseAbs().maxCoeff();
    while (r.cwiseAbs().maxCoeff() > small && out.iterations < kMostSteps) {
      ++out.iterations;
      const Eigen::VectorXd step = J.partialPivLu().solve(-r);
      double share = 1.0;
      Eigen::MatrixXd next_J;
      Eigen::VectorXd next = residual(problem, A, p, x + step, next_J);
      while (!(next.norm() < r.norm()) && share > 1e-3) {
        share *= 0.5;
        next = residual(problem, A, p, x + share * step, next_J);
      }
      if (!(next.norm() < r.norm())) break;
      x += share * step;
      r = std::move(next);
      J = std::move(next_J);
    }
    out.converged = r.cwiseAbs().maxCoeff() <= 100.0 * small;
    for (Index i = 0; i < problem.M.rows(); ++i) {
      orbits::Harmonics own{x.segment(i * B_, H_ + 1), Eigen::VectorXd::Zero(H_ + 1)};
      own.sine.tail(H_) = x.segment(i * B_ + H_ + 1, H_);
      out.displacement.push_back(std::move(own));
    }
    return out;
  }

  Eigen::VectorXd residual(const PeerProblem& problem, const Eigen::MatrixXd& A, const Eigen::VectorXd& p,
                           const Eigen::VectorXd& x, Eigen::MatrixXd& out_jacobian) const {
    Eigen::VectorXd r = A * x - p;
    out_jacobian = A;
    for (const PeerElement& element : problem.elements) {
      const Index at = element.dof * B_;
      sample(element, problem.omega, x.segment(at, B_));
      fftw_execute_dft_r2c(to_orders_, real_.data(), reinterpret_cast<fftw_complex*>(complex_.data()));
      const double scale = 1.0 / static_cast<double>(N_);
      const auto coefficients = [&](Index column, auto&& out) {
        out[0] += scale * complex_(0, column).real();
        for (Index k = 1; k <= H_; ++k) {
          out[k] += 2.0 * scale * complex_(k, column).real();
          out[H_ + k] -= 2.0 * scale * complex_(k, column).imag();
        }
      };
      coefficients(B_, r.segment(at, B_));
      for (Index j = 0; j < B_; ++j) coefficients(j, out_jacobian.col(at + j).segment(at, B_));
    }
    return r;
  }

  /// Derivatives by each coefficient, and the force, in time: the columns of real_.
  void sample(const PeerElement& element, double omega, const Eigen::Ref<const Coefficients>& x) const {
    const Eigen::VectorXd y = in_time(x, false);
    if (element.kind == PeerElement::Kind::kJenkins) {
      sample_jenkins(element, y);
      return;
    }
    const Eigen::VectorXd v = omega * in_time(x, true);
    Eigen::VectorXd by_y(N_), by_v(N_);
    for (Index n = 0; n < N_; ++n) {
      const double beyond = std::abs(y[n]) - element.reach;
      const bool pressed = beyond > 0.0;
      by_y[n] = pressed ? element.stiffness : 0.0;
      by_v[n] = pressed ? element.damping : 0.0;
      real_(n, B_) = pressed ? std::copysign(element.stiffness * beyond, y[n]) + element.damping * v[n] : 0.0;
    }
    for (Index j = 0; j < B_; ++j)
      real_.col(j) = by_y.cwiseProduct(base_.col(j)) + omega * by_v.cwiseProduct(slope_.col(j));
  }

  void sample_jenkins(const PeerElement& element, const Eigen::VectorXd& y) const {
    const double limit = element.stiffness * element.reach;
    std::vector<char> slides(static_cast<std::size_t>(N_));
    double force = 0.0;
    for (Index turn = 0; turn < 2; ++turn)  // the second round is periodic
      for (Index n = 0; n < N_; ++n) {
        const double trial = force + element.stiffness * (y[n] - y[n == 0 ? N_ - 1 : n - 1]);
        force = std::clamp(trial, -limit, limit);
        slides[static_cast<std::size_t>(n)] = force != trial;
        real_(n, B_) = force;
      }
    for (Index j = 0; j < B_; ++j) {
      double rate = 0.0;
      for (Index turn = 0; turn < 2; ++turn)
        for (Index n = 0; n < N_; ++n) {
          const double change = element.stiffness * (base_(n, j) - base_(n == 0 ? N_ - 1 : n - 1, j));
          rate = slides[static_cast<std::size_t>(n)] != 0 ? 0.0 : rate + change;
          real_(n, j) = rate;
        }
    }
  }

  [[nodiscard]] Eigen::VectorXd in_time(const Eigen::Ref<const Coefficients>& x, bool rate) const {
    complex_.col(0).setZero();
    complex_(0, 0) = rate ? 0.0 : x[0];
    for (Index k = 1; k <= H_; ++k) {
      const std::complex<double> half = 0.5 * std::complex<double>(x[k], -x[H_ + k]);
      complex_(k, 0) = rate ? std::complex<double>(0.0, static_cast<double>(k)) * half : half;
    }
    fftw_execute_dft_c2r(to_time_, reinterpret_cast<fftw_complex*>(complex_.data()), real_.data());
    return real_.col(0);
  }

  Index H_, N_, B_;
  Eigen::MatrixXd base_, slope_;  ///< 1, cos kθ, sin kθ at the samples, and their derivatives [N x B]
  mutable Eigen::MatrixXd real_;  ///< [N x B + 1]
  mutable Eigen::MatrixXcd complex_;
  fftw_plan to_time_ = nullptr, to_orders_ = nullptr;
};

}  // namespace

std::unique_ptr<AlternatingScheme> alternating_scheme(int harmonics, int samples) {
  return std::make_unique<FftwScheme>(harmonics, samples);
}

}  // namespace slipmode::bench
