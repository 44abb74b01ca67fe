#include <slipmode/core/dense_lapack.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/core/none.hpp>

#include <algorithm>
#include <complex>
#include <string>
#include <vector>

// Lengths at the end belong to the character arguments.
extern "C" {
void dgeev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda, double* wr, double* wi,
            double* vl, const int* ldvl, double* vr, const int* ldvr, double* work, const int* lwork, int* info,
            std::size_t jobvl_length, std::size_t jobvr_length);
void dgesdd_(const char* jobz, const int* m, const int* n, double* a, const int* lda, double* s, double* u,
             const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* iwork, int* info,
             std::size_t jobz_length);
}

namespace slipmode {
namespace {

void require(bool found, const char* what) {
  if (!found) throw NumericalFailure(std::string("the ") + what + " of a matrix were not found", kNone, {}, kNone);
}

}  // namespace

Eigenpairs eigenpairs(Eigen::MatrixXd matrix, bool with_vectors) {
  constexpr const char* kWhat = "eigenvalues";
  require(matrix.allFinite(), kWhat);
  const int n = static_cast<int>(matrix.rows()), work_size = 34 * n;
  Eigen::VectorXd re(n), im(n), work(work_size);
  Eigen::MatrixXd right(n, with_vectors ? n : 0);
  double none = 0.0;
  int info = 0;
  dgeev_("N", with_vectors ? "V" : "N", &n, matrix.data(), &n, re.data(), im.data(), &none, &n,
         with_vectors ? right.data() : &none, &n, work.data(), &work_size, &info, 1, 1);
  require(info == 0, kWhat);
  Eigenpairs out{Eigen::VectorXcd(n), right.cast<std::complex<double>>()};
  for (Eigen::Index k = 0; k < n; ++k) out.values[k] = {re[k], im[k]};
  for (Eigen::Index k = 0; k + 1 < right.cols(); ++k) {
    if (im[k] == 0.0) continue;
    // Of a conjugate pair the two columns are real and imaginary part of the first vector.
    out.vectors.col(k).imag() = right.col(k + 1);
    out.vectors.col(k + 1) = out.vectors.col(k).conjugate();
    ++k;
  }
  return out;
}

SingularValues singular_values(Eigen::MatrixXd matrix, bool with_vectors) {
  constexpr const char* kWhat = "singular values";
  require(matrix.allFinite(), kWhat);
  const int m = static_cast<int>(matrix.rows()), n = static_cast<int>(matrix.cols()), count = std::min(m, n);
  const int vectors = with_vectors ? count : 0, lead = std::max(1, vectors);  // LAPACK wants no leading dimension of 0
  SingularValues out{Eigen::MatrixXd(m, vectors), {}, Eigen::VectorXd(count)};
  if (count == 0) return out;
  Eigen::MatrixXd Vt(lead, n);
  std::vector<int> iwork(static_cast<std::size_t>(8 * count));
  double wanted = 0.0;
  int info = 0;
  const auto call = [&](double* work, int work_size) {
    dgesdd_(with_vectors ? "S" : "N", &m, &n, matrix.data(), &m, out.sigma.data(), out.U.data(), &m, Vt.data(), &lead,
            work, &work_size, iwork.data(), &info, 1);
    require(info == 0, kWhat);
  };
  call(&wanted, -1);
  Eigen::VectorXd work(static_cast<Eigen::Index>(wanted));
  call(work.data(), static_cast<int>(work.size()));
  out.V = Vt.topRows(vectors).transpose();
  return out;
}

}  // namespace slipmode
