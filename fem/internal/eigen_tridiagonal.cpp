#include <slipmode/core/errors.hpp>
#include "fem/internal/eigensolvers.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>
#include <vector>

// LAPACK 3.2 or later; the two trailing lengths belong to the character arguments.
extern "C" void dstemr_(const char* jobz, const char* range, const int* n, double* d, double* e, const double* vl,
                        const double* vu, const int* il, const int* iu, int* m, double* w, double* z, const int* ldz,
                        const int* nzc, int* isuppz, int* tryrac, double* work, const int* lwork, int* iwork,
                        const int* liwork, int* info, std::size_t jobz_length, std::size_t range_length);
extern "C" void dstevr_(const char* jobz, const char* range, const int* n, double* d, double* e, const double* vl,
                        const double* vu, const int* il, const int* iu, const double* abstol, int* m, double* w,
                        double* z, const int* ldz, int* isuppz, double* work, const int* lwork, int* iwork,
                        const int* liwork, int* info, std::size_t jobz_length, std::size_t range_length);

namespace slipmode::fem::detail {

Tridiagonal tridiagonal_form(const Structure& structure) {
  const SparseMatrix M = to_sparse(structure.M());
  const SparseMatrix K = to_sparse(structure.K());
  const Eigen::Index n = structure.size();
  Tridiagonal T;
  T.inverse_root_mass = Eigen::VectorXd(M.diagonal()).cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd& s = T.inverse_root_mass;
  T.diagonal = Eigen::VectorXd(K.diagonal()).cwiseProduct(s).cwiseProduct(s);
  T.off_diagonal = Eigen::VectorXd::Zero(n - 1);
  for (Eigen::Index i = 0; i + 1 < n; ++i) T.off_diagonal(i) = K.coeff(i + 1, i) * s(i) * s(i + 1);
  return T;
}

EigenPairs solve_tridiagonal(const Structure& structure, Eigen::Index count) {
  const Tridiagonal T = tridiagonal_form(structure);
  const int n = static_cast<int>(structure.size());
  const int first = 1;
  const int last = static_cast<int>(count);
  const double unused = 0.0;
  const double full_accuracy = 2.0 * std::numeric_limits<double>::min();
  const int work_size = 20 * n;
  const int iwork_size = 10 * n;
  int found = 0;
  int try_high_relative_accuracy = 1;
  int info = 0;
  Eigen::VectorXd diagonal = T.diagonal;  // both are overwritten, and dstemr uses the extra entry as scratch
  Eigen::VectorXd off_diagonal = Eigen::VectorXd::Zero(n);
  off_diagonal.head(n - 1) = T.off_diagonal;
  EigenPairs pairs{Eigen::VectorXd(n), Eigen::MatrixXd(n, count)};
  std::vector<int> support(static_cast<std::size_t>(2 * count));
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> iwork(static_cast<std::size_t>(iwork_size));
  dstemr_("V", "I", &n, diagonal.data(), off_diagonal.data(), &unused, &unused, &first, &last, &found,
          pairs.values.data(), pairs.vectors.data(), &n, &last, support.data(), &try_high_relative_accuracy,
          work.data(), &work_size, iwork.data(), &iwork_size, &info, 1, 1);
  if (info != 0 || found != last) {
    // MRRR fails where many modes coincide, as those of light masses between heavy ones: bisection and inverse
    // iteration, to which dstevr goes on.
    diagonal = T.diagonal;
    off_diagonal.head(n - 1) = T.off_diagonal;
    dstevr_("V", "I", &n, diagonal.data(), off_diagonal.data(), &unused, &unused, &first, &last, &full_accuracy, &found,
            pairs.values.data(), pairs.vectors.data(), &n, support.data(), work.data(), &work_size, iwork.data(),
            &iwork_size, &info, 1, 1);
  }
  if (info != 0 || found != last) {
    throw NumericalFailure(
        fmt::format("natural modes: LAPACK's dstemr and dstevr found {} of {} modes (info = {}); the "
                    "dense method uses neither",
                    found, count, info),
        std::nan(""), {}, std::nan(""));
  }
  pairs.values.conservativeResize(count);
  pairs.vectors = T.inverse_root_mass.asDiagonal() * pairs.vectors;
  return pairs;
}

}  // namespace slipmode::fem::detail
