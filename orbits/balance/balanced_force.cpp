#include "orbits/balance/internal/balanced_force.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// Every `step`-th moment, of both signs, real and imaginary parts apart: what is Toeplitz in them goes by columns.
class TwoSided {
 public:
  TwoSided(const Eigen::VectorXcd& of, Eigen::Index step)
      : middle_(std::max<Eigen::Index>(of.size() - 1, 0) / step), re_(2 * middle_ + 1), im_(2 * middle_ + 1) {
    for (Eigen::Index i = 0; i * step < of.size(); ++i) {
      re_[middle_ + i] = re_[middle_ - i] = of[i * step].real();
      im_[middle_ + i] = of[i * step].imag();
      im_[middle_ - i] = -of[i * step].imag();
    }
  }

  /// From the moment first · step on.
  [[nodiscard]] auto re(Eigen::Index first, Eigen::Index count) const { return re_.segment(middle_ + first, count); }
  [[nodiscard]] auto im(Eigen::Index first, Eigen::Index count) const { return im_.segment(middle_ + first, count); }

 private:
  Eigen::Index middle_;
  Eigen::ArrayXd re_, im_;
};

}  // namespace

Eigen::VectorXcd arc_moments(double begin, double end, Eigen::Index moments) {
  Eigen::VectorXcd out(moments + 1);
  out[0] = (end - begin) / kFullTurn;
  const Complex first = std::polar(1.0, begin), last = std::polar(1.0, end);
  Complex at_first = first, at_last = last;
  for (Eigen::Index m = 1; m <= moments; ++m, at_first *= first, at_last *= last)
    out[m] = Complex(0.0, -1.0 / (kFullTurn * static_cast<double>(m))) * (at_last - at_first);
  return out;
}

std::vector<Complex> sample_turns(int samples) {
  std::vector<Complex> turns;
  turns.reserve(static_cast<std::size_t>(samples));
  for (int n = 0; n < samples; ++n) turns.push_back(std::polar(1.0, kFullTurn * n / samples));
  return turns;
}

void add_linear(const TrigonometricPolynomial& y, const LinearPiece& piece, BalancedForce& out_force) {
  if (piece.set[0] == 0.0) return;
  const Orders& leading = out_force.leading;
  const Orders orders = leading.up_to(y.phasors.size() - 1);
  const Eigen::Index n = orders.count, L = leading.count, mean = orders.has_mean() ? 1 : 0;
  const TwoSided set(piece.set, orders.step), jumps(piece.jumps, orders.step);
  // Of ŷ_k and ŷ_{−k} on λ̂_j for all j, where g_{k−j} is the conjugate of g_{j−k}.
  Eigen::ArrayXd plus_re(n), plus_im(n), minus_re(n), minus_im(n);
  Eigen::ArrayXd force_re = Eigen::ArrayXd::Zero(n), force_im = Eigen::ArrayXd::Zero(n);
  const auto add_column = [=](const auto& re, const auto& im, auto&& out_column) {  // (re + i im) as numbers of λ_j
    out_column.head(L) += re.head(L).matrix();
    out_column.tail(L - mean) -= im.segment(mean, L - mean).matrix();
    if (mean > 0) out_column[0] -= 0.5 * re[0];
  };
  for (Eigen::Index b = 0; b < n; ++b) {
    const Eigen::Index k = orders.at(b), sum = b + 2 * orders.first / orders.step;  // j + k, in steps, for the first j
    const double rest = -piece.stiffness, rate = -piece.damping * static_cast<double>(k);
    plus_re = rest * set.re(-b, n) + rate * set.im(-b, n);
    plus_im = rate * set.re(-b, n) - rest * set.im(-b, n);
    minus_re = rest * set.re(sum, n) - rate * set.im(sum, n);
    minus_im = -rate * set.re(sum, n) - rest * set.im(sum, n);
    const double c = 0.5 * y.phasors[k].real(), s = k == 0 ? 0.0 : 0.5 * y.phasors[k].imag();
    force_re += c * (plus_re + minus_re) - s * (plus_im - minus_im);
    force_im += c * (plus_im + minus_im) + s * (plus_re - minus_re);
    if (b >= L) continue;
    if (piece.damping != 0.0 && piece.jumps.size() > 0) {
      plus_re += piece.damping * jumps.re(-b, n);
      plus_im -= piece.damping * jumps.im(-b, n);
      minus_re += piece.damping * jumps.re(sum, n);
      minus_im -= piece.damping * jumps.im(sum, n);
    }
    // By cosine_k and sine_k: ŷ_{±k} = (cosine ∓ i sine)/2.
    add_column(plus_re + minus_re, plus_im + minus_im, out_force.jacobian.col(b));
    if (k > 0) add_column(plus_im - minus_im, minus_re - plus_re, out_force.jacobian.col(L - mean + b));
  }
  for (Eigen::Index a = 0; a < n; ++a)
    out_force.phasors[orders.at(a)] +=
        orders.at(a) == 0 ? Complex(force_re[a]) : 2.0 * Complex(force_re[a], force_im[a]);
  if (piece.constant != 0.0) add_constant(piece.constant, piece.set, out_force);
}

void add_constant(double value, const Eigen::VectorXcd& set, BalancedForce& out_force) {
  const Orders orders = out_force.leading.up_to(out_force.phasors.size() - 1);
  for (Eigen::Index a = 0; a < orders.count; ++a) {
    const Eigen::Index j = orders.at(a);
    out_force.phasors[j] += j == 0 ? Complex(value * set[0].real()) : 2.0 * value * std::conj(set[j]);
  }
}

void add_following(double rate, double held_at, const Eigen::VectorXcd& set, BalancedForce& out_force) {
  const Orders& leading = out_force.leading;
  const Eigen::Index L = leading.count, mean = leading.has_mean() ? 1 : 0;
  Eigen::VectorXd column(leading.numbers()), row(leading.numbers());
  const Complex turn = std::polar(1.0, static_cast<double>(leading.step) * held_at);
  Complex here = std::polar(1.0, static_cast<double>(leading.first) * held_at);
  for (Eigen::Index a = 0; a < L; ++a, here *= turn) {
    const Eigen::Index k = leading.at(a);
    column[a] = (k == 0 ? 1.0 : 2.0) * rate * set[k].real();
    row[a] = here.real();
    if (k == 0) continue;
    column[L - mean + a] = 2.0 * rate * set[k].imag();
    row[L - mean + a] = here.imag();
  }
  out_force.jacobian.noalias() += column * row.transpose();
}

}  // namespace slipmode::orbits
