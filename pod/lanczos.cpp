#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/centred.hpp"

#include <Spectra/SymEigsSolver.h>
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::pod {

namespace {

/// y ↦ (X − q̄)(X − q̄)ᵀ y, one pass over the snapshots.
class GramOperator {
 public:
  using Scalar = double;

  explicit GramOperator(const Centred& centred) : centred_(centred) {}

  [[nodiscard]] Eigen::Index rows() const { return centred_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return centred_.rows(); }

  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Eigen::VectorXd> y(in, rows());
    Eigen::Map<Eigen::VectorXd> z(out, rows());
    z.setZero();
    centred_.for_each_block([&](const auto& block) {
      const Eigen::VectorXd amplitude = block.transpose() * y;
      z.noalias() += block * amplitude;
    });
  }

 private:
  const Centred& centred_;
};

struct Leading {
  Eigen::VectorXd sigma;
  Eigen::MatrixXd vectors;
};

Leading leading(const Centred& centred, Eigen::Index count) {
  constexpr Eigen::Index kMaxRestarts = 1000;
  constexpr double kTolerance = 1e-13;  // of the Gram eigenvalues, that is of the squares
  GramOperator gram(centred);
  const Eigen::Index subspace = std::min(centred.rows(), std::max<Eigen::Index>(2 * count + 10, 20));
  Spectra::SymEigsSolver<GramOperator> solver(gram, count, subspace);
  solver.init();
  solver.compute(Spectra::SortRule::LargestAlge, kMaxRestarts, kTolerance);
  if (solver.info() != Spectra::CompInfo::Successful) {
    throw NumericalFailure(fmt::format("POD: Lanczos found not all of {} leading modes of {} degrees of freedom in {} "
                                       "restarts; ask for fewer modes or use the QR method",
                                       count, centred.rows(), kMaxRestarts),
                           kNone, {}, kNone);
  }
  // A negative Ritz value is rounding about zero.
  return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(), solver.eigenvectors()};
}

/// Leading modes until their share reaches the one asked, doubling their number.
Leading leading_by_share(const Centred& centred, double total, double energy) {
  const Eigen::Index limit = centred.rows() - 1;
  for (Eigen::Index count = std::min<Eigen::Index>(8, limit);; count = std::min(2 * count, limit)) {
    Leading found = leading(centred, count);
    const Eigen::VectorXd shares = found.sigma.array().square() / total;
    if (modes_for_energy(shares, energy) <= count) return found;
    if (count == limit) {
      throw InvalidInput(
          fmt::format("POD: {} modes of {} do not reach the share {}; Lanczos gives leading modes only, use "
                      "the QR method",
                      count, centred.rows(), energy));
    }
  }
}

}  // namespace

Decomposition decompose_lanczos(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  const Centred centred(snapshots, options.remove_mean);
  const Eigen::Index wanted = options.choice.modes;
  if (wanted >= centred.rows() || (wanted == 0 && options.choice.energy == 1.0) || centred.rows() < 2) {
    throw InvalidInput(
        fmt::format("POD: Lanczos gives leading modes only; ask for fewer than {} modes, or a share below "
                    "1, or use the QR method",
                    centred.rows()));
  }
  Decomposition found;
  found.total = centred.total();
  found.mean = centred.mean();
  found.snapshots = centred.cols();
  if (is_constant(found.total, found.mean, found.snapshots)) {
    fail_constant(found.snapshots, found.total, options.remove_mean);
  }
  Leading modes = wanted > 0 ? leading(centred, wanted) : leading_by_share(centred, found.total, options.choice.energy);
  found.sigma = std::move(modes.sigma);
  found.vectors = std::move(modes.vectors);
  found.relative_error = 4.0 * std::sqrt(static_cast<double>(centred.rows()) * std::numeric_limits<double>::epsilon());
  found.method = "Lanczos";
  return found;
}

}  // namespace slipmode::pod
