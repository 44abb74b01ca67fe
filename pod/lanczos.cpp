#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>
#include "pod/internal/assemble.hpp"
#include "pod/internal/centred.hpp"

#include <Spectra/SymEigsSolver.h>
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace slipmode::pod {

namespace {

/// The snapshots less their mean, as Lanczos sees them.
struct Gram {
  Eigen::Index dofs, snapshots;
  Eigen::VectorXd mean;
  double total;                                                  ///< ‖X − q̄‖²_F
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> apply;  ///< y ↦ (X − q̄)(X − q̄)ᵀ y
};

/// One pass over the snapshots a step. @param centred  outlives this
Gram gram_of(const Centred& centred) {
  return {.dofs = centred.rows(),
          .snapshots = centred.cols(),
          .mean = centred.mean(),
          .total = centred.total(),
          .apply = [&centred](const Eigen::VectorXd& y) {
            Eigen::VectorXd z = Eigen::VectorXd::Zero(y.size());
            centred.for_each_block([&](const auto& block) {
              const Eigen::VectorXd amplitude = block.transpose() * y;
              z.noalias() += block * amplitude;
            });
            return z;
          }};
}

/// @param sum  outlives this
Gram gram_of(const SnapshotTriangle& sum) {
  return {.dofs = sum.R.cols(),
          .snapshots = sum.count,
          .mean = sum.origin + sum.mean,
          .total = sum.R.squaredNorm(),
          .apply = [&R = sum.R](const Eigen::VectorXd& y) {
            const Eigen::VectorXd amplitude = R.triangularView<Eigen::Upper>() * y;
            return Eigen::VectorXd(R.transpose().triangularView<Eigen::Lower>() * amplitude);
          }};
}

/// As Spectra wants it.
class GramOperator {
 public:
  using Scalar = double;

  explicit GramOperator(const Gram& gram) : gram_(gram) {}

  [[nodiscard]] Eigen::Index rows() const { return gram_.dofs; }
  [[nodiscard]] Eigen::Index cols() const { return gram_.dofs; }

  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) = gram_.apply(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }

 private:
  const Gram& gram_;
};

struct Leading {
  Eigen::VectorXd sigma;
  Eigen::MatrixXd vectors;
};

Leading leading(const Gram& gram, Eigen::Index count) {
  constexpr Eigen::Index kMaxRestarts = 1000;
  constexpr double kTolerance = 1e-13;  // of the Gram eigenvalues, that is of the squares
  GramOperator applied(gram);
  const Eigen::Index subspace = std::min(gram.dofs, std::max<Eigen::Index>(2 * count + 10, 20));
  Spectra::SymEigsSolver<GramOperator> solver(applied, count, subspace);
  solver.init();
  solver.compute(Spectra::SortRule::LargestAlge, kMaxRestarts, kTolerance);
  if (solver.info() != Spectra::CompInfo::Successful) {
    throw NumericalFailure(fmt::format("POD: Lanczos found not all of {} leading modes of {} degrees of freedom in {} "
                                       "restarts; ask for fewer modes or use the QR method",
                                       count, gram.dofs, kMaxRestarts),
                           kNone, {}, kNone);
  }
  // A negative Ritz value is rounding about zero.
  return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(), solver.eigenvectors()};
}

/// Leading modes until their share reaches the one asked, doubling their number.
Leading leading_by_share(const Gram& gram, double energy) {
  const Eigen::Index limit = gram.dofs - 1;
  for (Eigen::Index count = std::min<Eigen::Index>(8, limit);; count = std::min(2 * count, limit)) {
    Leading found = leading(gram, count);
    const Eigen::VectorXd shares = found.sigma.array().square() / gram.total;
    if (modes_for_energy(shares, energy) <= count) return found;
    if (count == limit) {
      throw InvalidInput(
          fmt::format("POD: {} modes of {} do not reach the share {}; Lanczos gives leading modes only, use "
                      "the QR method",
                      count, gram.dofs, energy));
    }
  }
}

Decomposition decompose(const Gram& gram, const PodOptions& options) {
  const Eigen::Index wanted = options.choice.modes;
  if (wanted >= gram.dofs || (wanted == 0 && options.choice.energy == 1.0) || gram.dofs < 2) {
    throw InvalidInput(
        fmt::format("POD: Lanczos gives leading modes only; ask for fewer than {} modes, or a share below "
                    "1, or use the QR method",
                    gram.dofs));
  }
  Decomposition found;
  found.total = gram.total;
  found.mean = gram.mean;
  found.snapshots = gram.snapshots;
  if (is_constant(found.total, found.mean, found.snapshots)) {
    fail_constant(found.snapshots, found.total, options.remove_mean);
  }
  Leading modes = wanted > 0 ? leading(gram, wanted) : leading_by_share(gram, options.choice.energy);
  found.sigma = std::move(modes.sigma);
  found.vectors = std::move(modes.vectors);
  found.relative_error = 4.0 * std::sqrt(static_cast<double>(gram.dofs) * std::numeric_limits<double>::epsilon());
  found.method = "Lanczos";
  return found;
}

}  // namespace

Decomposition decompose_lanczos(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  const Centred centred(snapshots, options.remove_mean);
  return decompose(gram_of(centred), options);
}

Decomposition decompose_lanczos(const SnapshotTriangle& sum, const PodOptions& options) {
  return decompose(gram_of(sum), options);
}

}  // namespace slipmode::pod
