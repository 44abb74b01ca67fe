#include "orbits/balance/internal/balanced_force.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace slipmode::orbits {
namespace {

using Complex = std::complex<double>;
constexpr double kFullTurn = 2.0 * std::numbers::pi;

Complex moment(const Eigen::VectorXcd& of, Eigen::Index m) { return m < 0 ? std::conj(of[-m]) : of[m]; }

}  // namespace

Eigen::VectorXcd arc_moments(double begin, double end, Eigen::Index moments) {
  Eigen::VectorXcd out(moments + 1);
  out[0] = (end - begin) / kFullTurn;
  const Complex first = std::polar(1.0, begin), last = std::polar(1.0, end);
  Complex at_first = first, at_last = last;
  for (Eigen::Index m = 1; m <= moments; ++m, at_first *= first, at_last *= last)
    out[m] = (at_last - at_first) / Complex(0.0, kFullTurn * static_cast<double>(m));
  return out;
}

std::vector<Complex> sample_turns(int samples) {
  std::vector<Complex> turns;
  for (int n = 0; n < samples; ++n) turns.push_back(std::polar(1.0, kFullTurn * n / samples));
  return turns;
}

void add_linear(const TrigonometricPolynomial& y, const LinearPiece& piece, BalancedForce& out_force) {
  if (piece.set[0] == 0.0) return;
  const Eigen::Index H = y.phasors.size() - 1, L = (out_force.jacobian.rows() - 1) / 2;
  const bool jumps = piece.jumps.size() > 0;
  const auto coefficient = [&](Eigen::Index k) {  // double-sided
    return k == 0 ? y.phasors[0] : k > 0 ? 0.5 * y.phasors[k] : 0.5 * std::conj(y.phasors[-k]);
  };
  for (Eigen::Index j = 0; j <= H; ++j) {
    const double twice = j == 0 ? 1.0 : 2.0;
    Complex force = 0.0;
    for (Eigen::Index k = 0; k <= H; ++k) {
      const Complex gain(-piece.stiffness, -piece.damping * static_cast<double>(k));
      const Complex plus_set = gain * moment(piece.set, k - j), minus_set = std::conj(gain) * moment(piece.set, -k - j);
      force += plus_set * coefficient(k);
      if (k > 0) force += minus_set * coefficient(-k);
      if (j > L || k > L) continue;
      Complex plus = twice * plus_set, minus = twice * minus_set;
      if (jumps) {
        plus += twice * piece.damping * moment(piece.jumps, k - j);
        minus += twice * piece.damping * moment(piece.jumps, -k - j);
      }
      // By cosine_k and sine_k: ŷ_{±k} = (cosine ∓ i sine)/2.
      const Complex by_cosine = k == 0 ? plus : 0.5 * (plus + minus), by_sine = Complex(0.0, -0.5) * (plus - minus);
      out_force.jacobian(j, k) += by_cosine.real();
      if (j > 0) out_force.jacobian(L + j, k) -= by_cosine.imag();
      if (k > 0) out_force.jacobian(j, L + k) += by_sine.real();
      if (j > 0 && k > 0) out_force.jacobian(L + j, L + k) -= by_sine.imag();
    }
    out_force.phasors[j] += twice * (j == 0 ? Complex(force.real()) : force);
  }
  if (piece.constant != 0.0) add_constant(piece.constant, piece.set, out_force);
}

void add_constant(double value, const Eigen::VectorXcd& set, BalancedForce& out_force) {
  out_force.phasors[0] += value * set[0].real();
  for (Eigen::Index j = 1; j < out_force.phasors.size(); ++j) out_force.phasors[j] += 2.0 * value * std::conj(set[j]);
}

void add_following(double rate, double held_at, const Eigen::VectorXcd& set, BalancedForce& out_force) {
  const Eigen::Index B = out_force.jacobian.rows(), L = (B - 1) / 2;
  Eigen::VectorXd column(B), row(B);
  column[0] = rate * set[0].real();
  row[0] = 1.0;
  for (Eigen::Index k = 1; k <= L; ++k) {
    column[k] = 2.0 * rate * set[k].real();
    column[L + k] = 2.0 * rate * set[k].imag();
    row[k] = std::cos(static_cast<double>(k) * held_at);
    row[L + k] = std::sin(static_cast<double>(k) * held_at);
  }
  out_force.jacobian.noalias() += column * row.transpose();
}

}  // namespace slipmode::orbits
