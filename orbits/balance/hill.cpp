#include <slipmode/orbits/balance/hill.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "orbits/balance/internal/balanced_force.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace slipmode::orbits {
namespace {

/// Functions 1, √2 cos kθ …, √2 sin kθ … that perturbations are made of: k = step, 2 step … ≤ last.
struct Grid {
  Eigen::Index step, last;

  [[nodiscard]] Eigen::Index sines() const { return last / step; }
  [[nodiscard]] Eigen::Index size() const { return 2 * sines() + 1; }
  [[nodiscard]] bool is_sine(Eigen::Index i) const { return i > sines(); }
  [[nodiscard]] Eigen::Index order(Eigen::Index i) const { return step * (is_sine(i) ? i - sines() : i); }
};

/// Multiplication by p(θ), from its moments g_m = (1/2π) ∫ e^{imθ} p dθ.
Eigen::MatrixXd multiplication(const Eigen::VectorXcd& g, const Grid& grid) {
  Eigen::MatrixXd out(grid.size(), grid.size());
  for (Eigen::Index i = 0; i < grid.size(); ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Eigen::Index apart = grid.order(i) - grid.order(j), sum = grid.order(i) + grid.order(j);
      const std::complex<double> difference = apart < 0 ? std::conj(g[-apart]) : g[apart];
      const double entry = !grid.is_sine(i)  ? difference.real() + g[sum].real()
                           : grid.is_sine(j) ? difference.real() - g[sum].real()
                                             : g[sum].imag() + difference.imag();
      out(i, j) = out(j, i) = entry * (i == 0 ? 0.5 : j == 0 ? std::sqrt(0.5) : 1.0);
    }
  return out;
}

/// The matrix whose eigenvalues are the exponents, on (φ; φ̇) function after function.
Eigen::MatrixXd hill_matrix(const dynamics::HybridSystem& system, const Balance& balance,
                            const std::vector<StopTangent>& answers, const Grid& grid) {
  const Eigen::Index n = system.size(), B = grid.size(), half = n * B;
  const Eigen::LLT<Eigen::MatrixXd> mass(fem::to_dense(system.structure().M()));
  const Eigen::MatrixXd K = mass.solve(fem::to_dense(system.structure().K())),
                        C = mass.solve(fem::to_dense(system.structure().C()));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * half, 2 * half);
  for (Eigen::Index i = 0; i < B; ++i) {
    out.block(i * n, half + i * n, n, n).setIdentity();
    out.block(half + i * n, i * n, n, n) = -K;
    out.block(half + i * n, half + i * n, n, n) = -C;
  }
  for (std::size_t c = 0; c < answers.size(); ++c) {
    const Eigen::VectorXd& w = system.contacts()[c].direction;
    const Eigen::MatrixXd along = mass.solve(w) * w.transpose();
    const Eigen::MatrixXd stiffness = multiplication(answers[c].stiffness, grid),
                          damping = multiplication(answers[c].damping, grid);
    for (Eigen::Index i = 0; i < B; ++i)
      for (Eigen::Index j = 0; j < B; ++j) {
        out.block(half + i * n, j * n, n, n) += stiffness(i, j) * along;
        out.block(half + i * n, half + j * n, n, n) += damping(i, j) * along;
      }
  }
  for (Eigen::Index cosine = 1; cosine <= grid.sines(); ++cosine) {  // less d/dt of the functions themselves
    const Eigen::Index sine = cosine + grid.sines();
    const double rate = static_cast<double>(grid.order(sine)) * balance.omega;
    for (Eigen::Index i = 0; i < 2 * half; i += half) {
      out.block(i + cosine * n, i + sine * n, n, n).diagonal().array() -= rate;
      out.block(i + sine * n, i + cosine * n, n, n).diagonal().array() += rate;
    }
  }
  return out;
}

/// Those of the strip |Im α| ≤ `edge`, `count` of them. Near its edges truncation leaves each multiplier −e^{aT} as a
/// pair a ± ib, b just inside or just outside, and each pair of complex ones as two such, one inside and one outside.
std::vector<std::complex<double>> of_the_strip(const Eigen::VectorXcd& exponents, double edge, Eigen::Index count) {
  constexpr double kBand = 0.1;  // of the edge
  std::vector<std::complex<double>> inside, pairs;
  for (const std::complex<double>& alpha : exponents) {
    if (std::abs(alpha.imag()) < (1.0 - kBand) * edge)
      inside.push_back(alpha);
    else if (alpha.imag() > 0.0)
      pairs.push_back(alpha);
  }
  const auto off_centre = [](const std::complex<double>& alpha) { return std::abs(alpha.imag()); };
  std::ranges::stable_sort(inside, {}, off_centre);
  if (std::ssize(inside) > count) inside.resize(static_cast<std::size_t>(count));
  std::ranges::stable_sort(pairs, {}, [&](const auto& alpha) { return std::abs(alpha.imag() - edge); });
  pairs.resize(std::min(pairs.size(), static_cast<std::size_t>(count) - inside.size()));
  while (!pairs.empty()) {
    const std::complex<double> first = pairs.front();
    pairs.erase(pairs.begin());
    const auto twin =
        std::ranges::min_element(pairs, {}, [&](const auto& other) { return std::abs(other.real() - first.real()); });
    const bool complex =
        twin != pairs.end() && std::abs(twin->real() - first.real()) < std::abs(twin->imag() - first.imag());
    if (!complex) {
      inside.emplace_back(first.real(), edge);
      continue;
    }
    const std::complex<double> mean(0.5 * (first.real() + twin->real()),
                                    edge - 0.5 * std::abs(twin->imag() - first.imag()));
    inside.insert(inside.end(), {mean, std::conj(mean)});
    pairs.erase(twin);
  }
  return inside;
}

}  // namespace

Eigen::VectorXcd hill_multipliers(const dynamics::HybridSystem& system, const Balance& balance,
                                  const HillOptions& options) {
  if (options.perturbation < 0)
    throw InvalidInput(
        fmt::format("perturbation: {}; valid: orders from 1 on, or 0 for the balance's", options.perturbation));
  const Eigen::Index L = options.perturbation > 0 ? options.perturbation : balance.harmonics;
  std::vector<StopTangent> answers;
  for (std::size_t c = 0; c < system.contacts().size(); ++c)
    answers.push_back(stop_tangent(*friction::clearance(system.contacts()[c].law),
                                   polynomial_of(balance.displacement[c]), balance.omega, 2 * L, options.jumps));
  // Over half a period even orders stay among themselves: what moves in them comes back with its sign.
  const Eigen::Index step = options.half_period ? 2 : 1;
  const double edge = 0.5 * static_cast<double>(step) * balance.omega, time = std::numbers::pi / edge;
  const Eigen::VectorXcd exponents = sorted_eigenvalues(hill_matrix(system, balance, answers, {step, L}));
  const std::vector<std::complex<double>> taken = of_the_strip(exponents, edge, 2 * system.size());
  Eigen::VectorXcd out(std::ssize(taken));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const std::complex<double> alpha = taken[static_cast<std::size_t>(i)];
    const std::complex<double> mu = alpha.imag() == edge ? -std::exp(alpha.real() * time) : std::exp(alpha * time);
    out[i] = options.half_period ? 0.0 - mu : mu;
  }
  return sorted_by_modulus(out);
}

}  // namespace slipmode::orbits
