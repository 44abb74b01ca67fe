#include "dynamics/internal/sprung_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace slipmode::dynamics {
namespace {

using Complex = std::complex<double>;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// A mode that a support couples to none by more than this share of its eigenvalue is left as it is.
constexpr double kUnreached = 1e-18;
/// Largest remainder of the equations of motion, as a share of the sum of their terms.
constexpr double kRemainder = 1e-13;
/// Eigenvalues closer than this share of their size are one.
constexpr double kOne = 1e-11;
constexpr int kSweeps = 60;
/// Shifts below this share of a root's distance from its pole that no longer shrink are rounding.
constexpr double kSettled = 1e-10;

// As complex numbers' own operators, without their care for infinities, which costs a call each.
Complex times(Complex x, Complex y) {
  return {x.real() * y.real() - x.imag() * y.imag(), x.real() * y.imag() + x.imag() * y.real()};
}
Complex inverse(Complex x) {
  const double share = 1.0 / (x.real() * x.real() + x.imag() * x.imag());
  return {x.real() * share, -x.imag() * share};
}

/// Eigenvalues in the upper half plane, their eigenvectors, and ξᵀ (2λ + C) ξ of each.
struct DampedModes {
  Eigen::VectorXcd values, norms;  ///< [n]
  Eigen::MatrixXcd shapes;         ///< [n x n]
};

/// a / (λ − p) and its mirror image together are (first λ + second) / ((λ − p)(λ − p̄)): a mode far slower than λ would
/// lose to the difference of the two what λ is larger than it.
struct PairTerm {
  double first, second;
};
PairTerm pair_term(Complex a, Complex p) {
  return {2.0 * a.real(), -2.0 * (a.real() * p.real() + a.imag() * p.imag())};
}

/// The roots of f(λ) = 1 + (k + d λ) g(λ), g = Σ a_j / (λ − p_j) over poles p and their mirror images, by Aberth's
/// iteration. Each root is kept as its distance from one pole, so that differences from poles have all their digits.
class SecularEquation {
 public:
  SecularEquation(Eigen::VectorXcd poles, const Eigen::VectorXcd& residues, double stiffness, double damping)
      : p_(std::move(poles)), k_(stiffness), d_(damping), delta_(p_.size()) {
    for (Eigen::Index j = 0; j < p_.size(); ++j) {
      terms_.push_back(pair_term(residues(j), p_(j)));
      anchor_.push_back(j);
      delta_(j) = first_guess(j, residues(j));
    }
  }

  /// False where they do not converge, or are real.
  bool solve() {
    const Eigen::Index n = p_.size();
    std::vector<bool> done(static_cast<std::size_t>(n), false);
    Eigen::VectorXd last = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool all = true;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (done[static_cast<std::size_t>(i)]) continue;
        const Complex shift = correction(i);
        if (!std::isfinite(shift.real()) || !std::isfinite(shift.imag())) return false;
        delta_(i) -= shift;
        // The mirror image of a root is a root.
        if (root(i).imag() < 0.0) delta_(i) = std::conj(root(i)) - p_(anchor(i));
        const double size = std::abs(shift), distance = std::abs(delta_(i));
        done[static_cast<std::size_t>(i)] =
            size <= 4.0 * kEpsilon * distance || (size <= kSettled * distance && size > last(i) / 4.0);
        last(i) = size;
        all &= done[static_cast<std::size_t>(i)];
        move_anchor(i);
      }
      if (all) return in_upper_half_plane();
    }
    return false;
  }

  [[nodiscard]] Complex root(Eigen::Index i) const { return p_(anchor(i)) + delta_(i); }
  /// 1 / ((λ_i − p_j)(λ_i − p̄_j)).
  [[nodiscard]] Complex receptance(Eigen::Index i, Eigen::Index j) const {
    return inverse(times(from_pole(i, j), root(i) - std::conj(p_(j))));
  }
  /// ξᵀ (2λ + C) ξ of the vector ξ = Σ_j ξ_j (ξ_jᵀw) / (λ − p_j): −g′ + d g², g = −1 / (k + d λ).
  [[nodiscard]] Complex norm(Eigen::Index i) const {
    const Complex g = -1.0 / (k_ + d_ * root(i));
    return -sums(i).slope + d_ * g * g;
  }

 private:
  struct Sums {
    Complex value, slope, poles;  ///< g, g′, Σ 1 / (λ − p_j)
  };

  [[nodiscard]] Eigen::Index anchor(Eigen::Index i) const { return anchor_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Complex from_pole(Eigen::Index i, Eigen::Index j) const { return p_(anchor(i)) - p_(j) + delta_(i); }

  [[nodiscard]] Sums sums(Eigen::Index i) const {
    Sums sum;
    const Complex z = root(i);
    for (Eigen::Index j = 0; j < p_.size(); ++j) {
      const auto [first, second] = terms_[static_cast<std::size_t>(j)];
      const Complex share = receptance(i, j), logarithmic = 2.0 * times(z - p_(j).real(), share);
      const Complex value = times(first * z + second, share);
      sum.value += value;
      sum.slope += first * share - times(value, logarithmic);
      sum.poles += logarithmic;
    }
    return sum;
  }

  /// Newton's shift of the numerator polynomial, with the other roots divided out.
  [[nodiscard]] Complex correction(Eigen::Index i) const {
    const Complex z = root(i);
    const Sums sum = sums(i);
    const Complex impedance = k_ + d_ * z, f = 1.0 + impedance * sum.value;
    if (f == 0.0) return 0.0;
    Complex others = 0.0;
    for (Eigen::Index j = 0; j < p_.size(); ++j) {
      if (j != i) others += inverse(p_(anchor(i)) - p_(anchor(j)) + (delta_(i) - delta_(j)));
      others += inverse(z - std::conj(root(j)));
    }
    return 1.0 / (sum.poles + (d_ * sum.value + impedance * sum.slope) / f - others);
  }

  /// To first order in the support, at most half way to the nearest other pole.
  [[nodiscard]] Complex first_guess(Eigen::Index i, Complex residue) const {
    const Complex shift = -(k_ + d_ * p_(i)) * residue;
    double gap = p_(i).imag();
    for (Eigen::Index j = 0; j < p_.size(); ++j)
      if (j != i) gap = std::min(gap, std::abs(p_(j) - p_(i)));
    return std::abs(shift) > 0.5 * gap ? shift * (0.5 * gap / std::abs(shift)) : shift;
  }

  void move_anchor(Eigen::Index i) {
    Eigen::Index nearest = anchor(i);
    double least = std::abs(delta_(i));
    for (Eigen::Index j = 0; j < p_.size(); ++j)
      if (const double distance = std::abs(from_pole(i, j)); distance < least) {
        least = distance;
        nearest = j;
      }
    if (nearest == anchor(i)) return;
    delta_(i) = from_pole(i, nearest);
    anchor_[static_cast<std::size_t>(i)] = nearest;
  }

  [[nodiscard]] bool in_upper_half_plane() const {
    for (Eigen::Index i = 0; i < p_.size(); ++i)
      if (!(root(i).imag() > kOne * std::abs(root(i)))) return false;
    return true;
  }

  Eigen::VectorXcd p_;
  std::vector<PairTerm> terms_;
  double k_, d_;
  std::vector<Eigen::Index> anchor_;
  Eigen::VectorXcd delta_;
};

/// False where the support is left to `pair_form`.
bool add(const Support& support, DampedModes& modes) {
  const Eigen::VectorXcd reach = modes.shapes.transpose() * support.w.cast<Complex>();
  const auto shift = [&](Eigen::Index j) {
    return std::abs((support.stiffness + support.damping * modes.values(j)) * reach(j) * reach(j) / modes.norms(j));
  };
  double largest = 0.0;
  for (Eigen::Index j = 0; j < reach.size(); ++j) largest = std::max(largest, shift(j));
  std::vector<Eigen::Index> reached;
  for (Eigen::Index j = 0; j < reach.size(); ++j)
    if (std::sqrt(shift(j) * largest) > kUnreached * std::abs(modes.values(j))) reached.push_back(j);
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Complex p = modes.values(reached[i]);
      if (std::abs(modes.values(reached[j]) - p) <= kOne * std::abs(p)) return false;
    }
  const Eigen::VectorXcd poles = modes.values(reached), own = reach(reached);
  const Eigen::VectorXcd share = own.cwiseQuotient(modes.norms(reached));
  SecularEquation equation(poles, own.cwiseProduct(share), support.stiffness, support.damping);
  if (!equation.solve()) return false;

  // Σ_j ξ_j share_j / (λ − p_j) and its mirror image, as PairTerm has them.
  const auto m = static_cast<Eigen::Index>(reached.size());
  const Eigen::MatrixXcd old = modes.shapes(Eigen::all, reached);
  Eigen::MatrixXd first(old.rows(), m), second(old.rows(), m);
  Eigen::MatrixXcd receptance(m, m);
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index l = 0; l < old.rows(); ++l) {
      const PairTerm term = pair_term(old(l, j) * share(j), poles(j));
      first(l, j) = term.first;
      second(l, j) = term.second;
    }
    for (Eigen::Index i = 0; i < m; ++i) receptance(j, i) = equation.receptance(i, j);
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index to = reached[static_cast<std::size_t>(i)];
    modes.values(to) = equation.root(i);
    modes.norms(to) = equation.norm(i);
  }
  const Eigen::MatrixXcd slow = first.cast<Complex>() * receptance;
  modes.shapes(Eigen::all, reached) = slow * modes.values(reached).asDiagonal() + second.cast<Complex>() * receptance;
  return true;
}

/// Supports along one direction are one support: the second would be reached through what the first has left.
std::vector<Support> joined(const std::vector<Support>& supports) {
  std::vector<Support> out;
  for (const Support& support : supports) {
    const auto same = std::ranges::find_if(out, [&](const Support& other) {
      const double share = other.w.dot(support.w) / other.w.squaredNorm();
      return (support.w - share * other.w).norm() <= kOne * support.w.norm();
    });
    if (same == out.end()) {
      out.push_back(support);
      continue;
    }
    const double share = support.w.squaredNorm() / same->w.squaredNorm();
    same->stiffness += share * support.stiffness;
    same->damping += share * support.damping;
  }
  return out;
}

}  // namespace

std::optional<PairForm> sprung_pairs(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                                     const std::vector<Support>& supports) {
  const Eigen::Index n = omega.size();
  DampedModes modes{Eigen::VectorXcd(n), Eigen::VectorXcd(n), Eigen::MatrixXcd::Identity(n, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double half = damping(i) / 2.0, square = (omega(i) - half) * (omega(i) + half);
    if (!(square > kOne * omega(i) * omega(i))) return std::nullopt;
    modes.values(i) = {-half, std::sqrt(square)};
    modes.norms(i) = {0.0, 2.0 * std::sqrt(square)};
  }
  const std::vector<Support> own = joined(supports);
  for (const Support& support : own)
    if (!add(support, modes)) return std::nullopt;

  PairForm form;
  form.g11 = form.g22 = modes.values.real();
  form.g12 = modes.values.imag();
  form.g21 = -form.g12;
  form.T.resize(2 * n, 2 * n);
  form.T_inverse.resize(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // Right eigenvectors (ω ξ, λ ξ); left ones of the symmetric equations ((λ + C) ξ / ω, ξ).
    const Complex z = modes.values(i);
    const Eigen::VectorXcd shape = modes.shapes.col(i);
    Eigen::VectorXcd damped = z * shape + damping.cast<Complex>().cwiseProduct(shape);
    Eigen::VectorXcd remainder = z * damped + omega.cwiseAbs2().cast<Complex>().cwiseProduct(shape);
    double terms = std::norm(z) * shape.norm() + omega.cwiseAbs2().cwiseProduct(shape.cwiseAbs()).norm();
    for (const Support& support : own) {
      const Complex there = support.w.cast<Complex>().cwiseProduct(shape).sum();
      damped += support.damping * there * support.w;
      remainder += (support.stiffness + z * support.damping) * there * support.w;
      terms += std::abs(support.stiffness + z * support.damping) * support.w.norm() *
               support.w.cwiseAbs().dot(shape.cwiseAbs());
    }
    if (!(remainder.norm() <= kRemainder * terms)) return std::nullopt;
    Eigen::VectorXcd right(2 * n), left(2 * n);
    right << omega.cast<Complex>().cwiseProduct(shape), z * shape;
    left << damped.cwiseQuotient(omega.cast<Complex>()), shape;
    const double size = right.norm();
    left *= 2.0 * size / modes.norms(i);
    form.T.col(i) = right.real() / size;
    form.T.col(n + i) = right.imag() / size;
    form.T_inverse.row(i) = left.real();
    form.T_inverse.row(n + i) = -left.imag();
  }
  // Beside a stiff support left and right vectors, each found by itself, leave 1e-10 of one another.
  form.T_inverse += form.T_inverse * (Eigen::MatrixXd::Identity(2 * n, 2 * n) - form.T * form.T_inverse);
  return form;
}

}  // namespace slipmode::dynamics
