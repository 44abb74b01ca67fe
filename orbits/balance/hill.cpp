#include <slipmode/orbits/balance/hill.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/orbits/floquet.hpp>
#include "orbits/balance/internal/balanced_law.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

namespace slipmode::orbits {
namespace {

/// Functions √2 cos kθ …, √2 sin kθ … that perturbations are made of, 1 where k = 0: k = first, first + step … ≤ last.
struct Grid {
  Eigen::Index first, step, last;

  [[nodiscard]] Eigen::Index cosines() const { return (last - first) / step + 1; }
  [[nodiscard]] Eigen::Index sines() const { return cosines() - (first == 0 ? 1 : 0); }
  [[nodiscard]] Eigen::Index size() const { return cosines() + sines(); }
  [[nodiscard]] bool is_sine(Eigen::Index i) const { return i >= cosines(); }
  [[nodiscard]] Eigen::Index order(Eigen::Index i) const { return first + step * (is_sine(i) ? i - sines() : i); }
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
      const double weight = (grid.order(i) == 0 ? 0.5 : 1.0) * (grid.order(j) == 0 ? 0.5 : 1.0);
      out(i, j) = out(j, i) = entry * std::sqrt(weight);
    }
  return out;
}

/// The matrix whose eigenvalues are the exponents, on (φ; φ̇) function after function.
Eigen::MatrixXd hill_matrix(const dynamics::HybridSystem& system, const Balance& balance,
                            const std::vector<ForceTangent>& answers, const Grid& grid) {
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
  for (Eigen::Index sine = grid.cosines(); sine < B; ++sine) {  // less d/dt of the functions themselves
    const Eigen::Index cosine = sine - grid.sines();
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
  std::vector<std::complex<double>> inside, pairs;
  for (const std::complex<double>& alpha : exponents) {
    if (std::abs(alpha.imag()) < kHillsBand * edge)
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

/// Multipliers of −Φ(T/2): even and odd orders stay among themselves, and come back reversed or as they were. Of both
/// together those with the least imaginary part, |Im α| ≤ Ω/2; near that edge one is seen in both.
Eigen::VectorXcd of_half_periods(const Eigen::VectorXcd& even, const Eigen::VectorXcd& odd, double omega,
                                 Eigen::Index count) {
  constexpr double kSame = 0.1, kSeenTwice = 0.8;
  struct Candidate {
    double off_centre;
    std::complex<double> multiplier;
  };
  std::vector<Candidate> all;
  for (const auto& [sign, exponents] : {std::pair{-1.0, &even}, std::pair{1.0, &odd}})
    for (const std::complex<double>& alpha : *exponents)
      all.push_back({std::abs(alpha.imag()), sign * std::exp(alpha * (std::numbers::pi / omega))});
  std::ranges::stable_sort(all, {}, &Candidate::off_centre);
  std::vector<std::complex<double>> taken;
  for (const Candidate& candidate : all) {
    const std::complex<double> mu = candidate.multiplier;
    const bool again = candidate.off_centre > kSeenTwice * 0.5 * omega &&
                       std::ranges::any_of(taken, [&](const std::complex<double>& other) {
                         return std::abs(other - mu) < kSame * std::abs(mu);
                       });
    if (!again && std::ssize(taken) < count) taken.push_back(mu);
  }
  return sorted_by_modulus(Eigen::Map<const Eigen::VectorXcd>(taken.data(), std::ssize(taken)));
}

}  // namespace

Eigen::VectorXcd hill_multipliers(const dynamics::HybridSystem& system, const Balance& balance,
                                  const HillOptions& options) {
  if (options.perturbation < 0)
    throw InvalidInput(
        fmt::format("perturbation: {}; valid: orders from 1 on, or 0 for the balance's", options.perturbation));
  if (has_memory(system))
    throw InvalidInput(
        "Hill's method does not hold where friction has a contact spring, whose force depends on the motion before; "
        "certify the balance (--certify): the orbit behind it has exact multipliers");
  const Eigen::Index L = options.perturbation > 0 ? options.perturbation : balance.harmonics;
  std::vector<ForceTangent> answers;
  const TrigonometricPolynomial d = counterpart_motion(system.drive(), balance.order, balance.harmonics);
  const std::vector<BalancedLaw> laws = balanced_laws(system);
  for (std::size_t c = 0; c < laws.size(); ++c)
    answers.push_back(tangent(laws[c], seen_by(laws[c], polynomial_of(balance.displacement[c]), d), balance.omega,
                              2 * L, options.jumps));
  const Eigen::Index count = 2 * system.size();
  const auto exponents = [&](const Grid& grid) {
    return sorted_eigenvalues(hill_matrix(system, balance, answers, grid));
  };
  if (options.half_period) return of_half_periods(exponents({0, 2, L}), exponents({1, 2, L}), balance.omega, count);
  const double edge = 0.5 * balance.omega, period = std::numbers::pi / edge;
  const std::vector<std::complex<double>> taken = of_the_strip(exponents({0, 1, L}), edge, count);
  Eigen::VectorXcd out(std::ssize(taken));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const std::complex<double> alpha = taken[static_cast<std::size_t>(i)];
    out[i] = alpha.imag() == edge ? -std::exp(alpha.real() * period) : std::exp(alpha * period);
  }
  return sorted_by_modulus(out);
}

}  // namespace slipmode::orbits
