#include <slipmode/pod/pod.hpp>

#include <cmath>

namespace slipmode::pod {

void fix_signs(Eigen::MatrixXd& vectors) {
  constexpr double kTie = 1e-9;
  for (Eigen::Index j = 0; j < vectors.cols(); ++j) {
    const double largest = vectors.col(j).cwiseAbs().maxCoeff();
    Eigen::Index i = 0;
    while (std::abs(vectors(i, j)) < (1.0 - kTie) * largest) ++i;
    if (vectors(i, j) < 0.0) vectors.col(j) *= -1.0;
  }
}

}  // namespace slipmode::pod
