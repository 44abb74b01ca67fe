#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include "fem/internal/eigensolvers.hpp"
#include "fem/internal/separate_modes.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace slipmode::fem {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// From this size on pairs are sought one by one where they are clearly separate.
constexpr Eigen::Index kManyModes = 64;
constexpr int kMaxSweeps = 60;  // per eigenvalue; two are usual

// Implicit QL with Wilkinson's shift on a symmetric tridiagonal matrix of entries of order 1 (Golub & Van Loan, Matrix
// Computations, 8.3; Martin & Wilkinson, Numer. Math. 12 (1968) 377). `d` [n] becomes the eigenvalues. e(i) couples i
// and i + 1, e(n−1) is scratch. The rotations go to the columns of `rows`, which becomes rows·U.
class ImplicitQl {
 public:
  ImplicitQl(Eigen::VectorXd& d, Eigen::VectorXd& e, Eigen::MatrixXd& rows) : d_(d), e_(e), rows_(rows) {}

  void run() {
    for (Eigen::Index first = 0; first < d_.size(); ++first) {
      int sweeps = 0;
      for (Eigen::Index last = block_end(first); last != first; last = block_end(first)) {
        if (++sweeps > kMaxSweeps) {
          throw NumericalFailure(fmt::format("modal rows: eigenvalue {} of {} did not converge in {} QL sweeps",
                                             first + 1, d_.size(), kMaxSweeps),
                                 std::nan(""), {}, std::abs(e_(first)));
        }
        sweep(first, last);
      }
    }
  }

 private:
  // The last index of the unreduced block that starts at `first`.
  [[nodiscard]] Eigen::Index block_end(Eigen::Index first) const {
    Eigen::Index last = first;
    while (last + 1 < d_.size() && std::abs(e_(last)) > kEpsilon * (std::abs(d_(last)) + std::abs(d_(last + 1)))) {
      ++last;
    }
    return last;
  }

  void sweep(Eigen::Index first, Eigen::Index last) {
    const double half_gap = (d_(first + 1) - d_(first)) / (2.0 * e_(first));
    double g = d_(last) - d_(first) + e_(first) / (half_gap + std::copysign(std::hypot(half_gap, 1.0), half_gap));
    double sine = 1.0;
    double cosine = 1.0;
    double shift = 0.0;
    for (Eigen::Index i = last - 1; i >= first; --i) {
      const double f = sine * e_(i);
      const double b = cosine * e_(i);
      const double length = std::sqrt(f * f + g * g);  // entries are of order 1: no overflow
      e_(i + 1) = length;
      if (length == 0.0) {  // the block splits here; the next sweeps take its parts
        d_(i + 1) -= shift;
        e_(last) = 0.0;
        return;
      }
      sine = f / length;
      cosine = g / length;
      g = d_(i + 1) - shift;
      const double t = (d_(i) - g) * sine + 2.0 * cosine * b;
      shift = sine * t;
      d_(i + 1) = g + shift;
      g = cosine * t - b;
      rotate(i, sine, cosine);
    }
    d_(first) -= shift;
    e_(first) = g;
    e_(last) = 0.0;
  }

  void rotate(Eigen::Index i, double sine, double cosine) {
    for (Eigen::Index row = 0; row < rows_.rows(); ++row) {
      const double upper = rows_(row, i + 1);
      const double lower = rows_(row, i);
      rows_(row, i + 1) = sine * lower + cosine * upper;
      rows_(row, i) = cosine * lower - sine * upper;
    }
  }

  Eigen::VectorXd& d_;
  Eigen::VectorXd& e_;
  Eigen::MatrixXd& rows_;
};

void check(const Structure& structure, const Eigen::MatrixXd& vectors) {
  if (!structure.is_chain_like()) {
    throw InvalidInput("modal rows: M must be diagonal and K tridiagonal; use natural_modes for other structures");
  }
  if (vectors.rows() != structure.size()) {
    throw InvalidInput(fmt::format("modal rows: vectors have {} rows, expected {} like the structure", vectors.rows(),
                                   structure.size()));
  }
  if (!vectors.allFinite()) throw InvalidInput("modal rows: a vector holds a value that is not finite");
}

std::vector<Eigen::Index> ascending_order(const Eigen::VectorXd& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&values](Eigen::Index a, Eigen::Index b) { return values(a) < values(b); });
  return order;
}

}  // namespace

ModalRows modal_rows(const Structure& chain_like, const Eigen::MatrixXd& vectors) {
  check(chain_like, vectors);
  const detail::Tridiagonal T = detail::tridiagonal_form(chain_like);
  const Eigen::Index n = chain_like.size();
  const double largest = T.diagonal.cwiseAbs().maxCoeff();  // bounds the off-diagonal too: K is semi-definite
  const double scale = largest > 0.0 ? largest : 1.0;
  Eigen::VectorXd d = T.diagonal / scale;
  Eigen::VectorXd e = Eigen::VectorXd::Zero(n);
  e.head(n - 1) = T.off_diagonal / scale;
  Eigen::MatrixXd rows = vectors.transpose() * T.inverse_root_mass.asDiagonal();
  if (auto modes = n >= kManyModes ? detail::separate_modes(d, e.head(n - 1), rows) : std::nullopt) {
    d = std::move(modes->values);
    rows = std::move(modes->rows);
  } else {
    ImplicitQl(d, e, rows).run();
  }

  const double rounding = static_cast<double>(n) * kEpsilon * d.cwiseAbs().maxCoeff();
  if (d.minCoeff() < -rounding) {
    throw InvalidInput(
        fmt::format("modal rows: K is not positive semi-definite, it has an eigenvalue ω² = {:.3g}; "
                    "check the signs of the stiffness matrix",
                    scale * d.minCoeff()));
  }
  d = (d.array() <= rounding).select(0.0, d);
  const auto order = ascending_order(d);
  return {(scale * d(order)).cwiseSqrt(), rows(Eigen::all, order)};
}

}  // namespace slipmode::fem
