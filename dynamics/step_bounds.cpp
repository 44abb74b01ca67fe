#include <slipmode/dynamics/step_tables.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slipmode::dynamics {
namespace {

/// Of a contact's velocity, a sum over the pairs.
constexpr double kSumRounding = 16.0 * std::numeric_limits<double>::epsilon();
constexpr int kHighest = kNodes + 1;

/// One pair in coordinates (s x₁, x₂) in which its free motion does not grow by more than e^{growth t}.
struct ScaledPair {
  double s = 1.0, growth = 0.0;
  Eigen::Matrix2d G;

  ScaledPair(const ModalModel& m, Eigen::Index i) {
    if (m.proportional) s = m.omega(i);
    G << m.g11(i), s * m.g12(i), s > 0.0 ? m.g21(i) / s : 0.0, m.g22(i);
    const double mean = 0.5 * (G(0, 0) + G(1, 1)), half = 0.5 * (G(0, 0) - G(1, 1)), shear = 0.5 * (G(0, 1) + G(1, 0));
    growth = std::max(0.0, mean + std::hypot(half, shear));
  }
  [[nodiscard]] Eigen::RowVector2d row(double first, double second) const {
    return {s > 0.0 ? first / s : 0.0, second};
  }
  [[nodiscard]] Eigen::Vector2d input(double first, double second) const { return {s * first, second}; }
};

/// max |dᵐP_k/dθᵐ| of Legendre's polynomials on [0, 1]: (k + m)!/(m! (k − m)!).
double legendre_slope(int k, int m) {
  double value = 1.0;
  for (int i = k - m + 1; i <= k + m; ++i) value *= i;
  for (int i = 2; i <= m; ++i) value /= i;
  return value;
}

}  // namespace

void StepTables::make(StepBounds& out, int level) const {
  const ModalModel& m = acted_on_;
  const double h = step(level);
  const Eigen::Index nc = m.contacts;
  out.ninth_by_state = out.second_row = out.third_by_state = Eigen::MatrixXd::Zero(2 * m.np, nc);
  // γ⁽ᵏ⁾(0), and bounds of |γ⁽ᵏ⁾|, of the contacts' forces and of the load.
  std::array<Eigen::MatrixXd, kHighest + 1> at_start, most;
  for (int k = 0; k <= kHighest; ++k)
    at_start[static_cast<std::size_t>(k)] = most[static_cast<std::size_t>(k)] = Eigen::MatrixXd::Zero(nc, nc + 1);
  Eigen::MatrixXd inputs(2 * m.np, nc + 1);
  inputs << m.input, m.load;
  const double ninth = std::pow(h, kHighest);
  for (Eigen::Index i = 0; i < m.n; ++i) {
    const ScaledPair pair(m, i);
    const double room = std::exp(pair.growth * h);
    for (Eigen::Index c = 0; c < nc; ++c) {
      Eigen::RowVector2d row = pair.row(m.velocity_row(i, c), m.velocity_row(m.np + i, c));
      const auto by_state = [&](double size, Eigen::MatrixXd& to) {
        to(i, c) += size * pair.s;
        to(m.np + i, c) += size;
      };
      by_state(kSumRounding / radau().remainder[0] * row.norm(), out.ninth_by_state);
      for (int k = 0; k <= kHighest; ++k, row *= pair.G) {
        const auto order = static_cast<std::size_t>(k);
        const double size = room * row.norm();
        for (Eigen::Index d = 0; d <= nc; ++d) {
          const Eigen::Vector2d input = pair.input(inputs(i, d), inputs(m.np + i, d));
          at_start[order](c, d) += row.dot(input);
          most[order](c, d) += size * input.norm();
        }
        if (k == 2) {
          out.second_row(i, c) = row(0) * pair.s;
          out.second_row(m.np + i, c) = row(1);
        }
        if (k == 3) by_state(size, out.third_by_state);
        if (k == kHighest) by_state(ninth * size, out.ninth_by_state);
      }
    }
  }
  const Eigen::Index own = model_.contacts;
  for (std::size_t k = 0; k < out.response.size(); ++k)
    out.response[k] = own > 0 ? most[k].topLeftCorner(own, nc).rowwise().sum().maxCoeff() : 0.0;
  out.response1 = at_start[1];
  out.response2 = at_start[2];
  out.third_by_force = most[3].leftCols(nc);
  out.third_by_load = most[3].col(nc);

  // v⁽⁹⁾ = Σ_m γ⁽⁸⁻ᵐ⁾(0) λ⁽ᵐ⁾ + ∫ γ⁽⁹⁾ λ, for each of the forces' Legendre polynomials.
  out.ninth_by_force.resize(kNodes * nc, nc);
  out.ninth_by_load.resize(nc);
  for (Eigen::Index c = 0; c < nc; ++c)
    for (Eigen::Index d = 0; d <= nc; ++d)
      for (int k = 0; k < (d < nc ? kNodes : 1); ++k) {
        double sum = ninth * h * most[kHighest](c, d);
        for (int j = 0; j <= k; ++j)
          sum += std::pow(h, kHighest - j) * std::abs(at_start[static_cast<std::size_t>(kNodes - j)](c, d)) *
                 legendre_slope(k, j);
        if (d < nc)
          out.ninth_by_force(kNodes * d + k, c) = sum;
        else
          out.ninth_by_load(c) = sum;
      }
  if (nc == 0) return;
  out.ninth_by_mean = out.ninth_by_force(0, 0);
  for (int k = 1; k < kNodes; ++k)  // |λ̂_k| ≤ (2k + 1) max |λ − mean|
    out.ninth_by_spread += radau().lebesgue * (2 * k + 1) * out.ninth_by_force(k, 0);
}

}  // namespace slipmode::dynamics
