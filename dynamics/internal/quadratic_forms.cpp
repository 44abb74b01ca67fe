#include "dynamics/internal/quadratic_forms.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace slipmode::dynamics {
namespace {

/// Sums of two decay rates below this share of another rate leave too few digits in a form.
constexpr double kSlowest = 1e-5;
/// To this share the viscous form and minus the energy are the same form.
constexpr double kSameForm = 1e-10;
/// From this many pairs on. With fewer the form costs little more, and takes x_f from the pairs as the other sums do:
/// where x_f and what the inputs hold are each far larger than their sum, that is a few digits better.
constexpr Eigen::Index kManyPairs = 32;

/// Factors of a pair's components that make its block's entries of one size.
Eigen::Vector2d scales(const ModalModel& pairs, Eigen::Index i) {
  const double up = std::abs(pairs.g12(i)), down = std::abs(pairs.g21(i));
  return {up > 0.0 && down > 0.0 ? std::sqrt(down / up) : 1.0, 1.0};
}

/// Slowest decay of a pair: the smallest −Re of its eigenvalues.
double decay(const Eigen::Matrix2d& G) {
  const double half = G.trace() / 2.0, gap = half * half - G.determinant();
  return gap <= 0.0 ? -half : -half > 0.0 ? G.determinant() / (-half + std::sqrt(gap)) : -half - std::sqrt(gap);
}

/// q̇ᵀCq̇ = xᵀ(this)x.
Eigen::MatrixXd viscous_square(const ModalModel& pairs) {
  const Eigen::MatrixXd& L = pairs.dissipation_root;
  if (L.size() > 0) return L.transpose() * L;
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(2 * pairs.np, 2 * pairs.np);
  if (pairs.n > 0) square.bottomRightCorner(pairs.np, pairs.np).diagonal() = pairs.damping;
  return square;
}

/// GᵀY + YG = Q, as RegimeForms keeps Y; left as it is where Q is zero. False without a finite solution.
bool solve_quadratic(const ModalModel& pairs, const Eigen::MatrixXd& Q, Eigen::MatrixXd& out_Y) {
  if (Q.isZero(0.0)) return true;
  const auto np = pairs.np;
  out_Y = Eigen::MatrixXd::Zero(2 * np, 2 * np);
  for (Eigen::Index i = 0; i < pairs.n; ++i)
    for (Eigen::Index j = i; j < pairs.n; ++j) {
      // In scaled displacements, ω η, the blocks' entries are of one size, so that a slow decay is not lost beside ω².
      const Eigen::Vector2d si = scales(pairs, i), sj = scales(pairs, j);
      Eigen::Matrix2d q;
      q << Q(i, j), Q(i, np + j), Q(np + i, j), Q(np + i, np + j);
      if (q.isZero(0.0)) continue;
      q = (si.cwiseInverse().asDiagonal() * q * sj.cwiseInverse().asDiagonal()).eval();
      // (I ⊗ G_iᵀ + G_jᵀ ⊗ I) vec Y = vec Q, columns stacked.
      const Eigen::Matrix2d Gi = si.asDiagonal() * block(pairs, i) * si.cwiseInverse().asDiagonal();
      const Eigen::Matrix2d Gj = sj.asDiagonal() * block(pairs, j) * sj.cwiseInverse().asDiagonal();
      Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
      A.topLeftCorner<2, 2>() = A.bottomRightCorner<2, 2>() = Gi.transpose();
      A.topLeftCorner<2, 2>().diagonal().array() += Gj(0, 0);
      A.bottomRightCorner<2, 2>().diagonal().array() += Gj(1, 1);
      A.topRightCorner<2, 2>().diagonal().array() += Gj(1, 0);
      A.bottomLeftCorner<2, 2>().diagonal().array() += Gj(0, 1);
      const Eigen::Vector4d y = A.partialPivLu().solve(Eigen::Map<const Eigen::Vector4d>(q.data()));
      if (!y.allFinite()) return false;
      const Eigen::Matrix2d Y = si.asDiagonal() * Eigen::Map<const Eigen::Matrix2d>(y.data()) * sj.asDiagonal();
      const double both = i == j ? 1.0 : 2.0;
      out_Y(j, i) = both * Y(0, 0);
      out_Y(np + j, np + i) = both * Y(1, 1);
      out_Y(np + i, j) += both * Y(1, 0);
      out_Y(np + j, i) += both * Y(0, 1);
    }
  return true;
}

/// Whether Y is minus the energy of free motion, contact springs included, each entry by the energies of its two
/// coordinates.
bool is_energy(const Regime& r, const ModalModel& slipping, const Eigen::MatrixXd& Y) {
  if (r.pairs.n < kManyPairs || Y.size() == 0 || !slipping.proportional || r.to_oscillators.rows() > 0) return false;
  // A spring that pushes makes of the energy a small difference.
  const auto pushes = [](const ContactAnswer& answer) { return answer.stiffness < 0.0; };
  if (std::any_of(r.answers.begin(), r.answers.end(), pushes)) return false;
  const auto n = slipping.np;
  Eigen::MatrixXd energy = r.to_slipping.bottomRows(n).transpose() * r.to_slipping.bottomRows(n);
  const Eigen::MatrixXd stretched = slipping.omega.asDiagonal() * r.to_slipping.topRows(n);
  energy += stretched.transpose() * stretched;
  for (Eigen::Index c = 0; c < r.speed_input(); ++c)
    energy += r.answers[static_cast<std::size_t>(c)].stiffness * r.displacement_row.col(c) *
              r.displacement_row.col(c).transpose();
  // Half of it, and half of the doubled triangle with its mirror image.
  const Eigen::MatrixXd gap = (Y + Y.transpose() + energy).cwiseAbs() / 2.0;
  const Eigen::VectorXd size = energy.diagonal().cwiseMax(0.0).cwiseSqrt();
  return (gap.array() <= kSameForm * (size * size.transpose()).array()).all();
}

/// The forms that no drive enters.
void make_forms(const Regime& r, const ModalModel& slipping, RegimeForms& out) {
  const ModalModel& pairs = r.pairs;
  const auto np = pairs.np;
  Eigen::MatrixXd contact = Eigen::MatrixXd::Zero(2 * np, 2 * np);
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) {
    if (r.spring(c) > 0.0 || r.slope(c) != 0.0) continue;
    const Eigen::VectorXd f = r.force_row.col(c), v = r.velocity_row.col(c);
    contact += (f * v.transpose() + v * f.transpose()) / 2.0;
  }
  out.found =
      solve_quadratic(pairs, contact, out.contact) && solve_quadratic(pairs, viscous_square(pairs), out.viscous);
  out.viscous_is_energy = out.found && is_energy(r, slipping, out.viscous);
}

}  // namespace

Eigen::Matrix2d block(const ModalModel& pairs, Eigen::Index i) {
  return (Eigen::Matrix2d() << pairs.g11(i), pairs.g12(i), pairs.g21(i), pairs.g22(i)).finished();
}

const RegimeForms& quadratic_forms(const RegimeTables& tables, const ModalModel& slipping) {
  return tables.forms([&slipping](const Regime& regime, RegimeForms& out) { make_forms(regime, slipping, out); });
}

bool decays(const ModalModel& pairs, double rate) {
  for (Eigen::Index i = 0; i < pairs.n; ++i) {
    const Eigen::Matrix2d G = block(pairs, i);
    const double beside = rate > 0.0 ? rate : std::sqrt(std::abs(G.determinant()));
    if (!(2.0 * decay(G) > kSlowest * beside)) return false;
  }
  return true;
}

double quadratic(const Eigen::MatrixXd& Y, const Eigen::VectorXd& x) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < Y.cols(); j += kLanes) {
    const Eigen::Index below = x.size() - j;
    const Eigen::Matrix<double, kLanes, 1> columns =
        Y.block<Eigen::Dynamic, kLanes>(j, j, below, kLanes).transpose() * x.tail(below);
    sum += columns.dot(x.segment<kLanes>(j));
  }
  return sum;
}

double free_energy(const Regime& r, const ModalModel& slipping, const Eigen::VectorXd& lifted,
                   const Eigen::VectorXd& free) {
  const auto n = slipping.np;
  double twice = lifted.tail(n).squaredNorm() + slipping.omega.cwiseProduct(lifted.head(n)).squaredNorm();
  for (Eigen::Index c = 0; c < r.speed_input(); ++c) {
    const double stiffness = r.answers[static_cast<std::size_t>(c)].stiffness;
    if (stiffness == 0.0) continue;
    const double force =
        r.spring(c) > 0.0 ? r.force_row.col(c).dot(free) : stiffness * r.displacement_row.col(c).dot(free);
    twice += force * force / stiffness;
  }
  return twice / 2.0;
}

}  // namespace slipmode::dynamics
