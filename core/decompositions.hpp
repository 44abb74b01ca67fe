#pragma once

#include <Eigen/Dense>

/// Eigen's decompositions of MatrixXd, compiled once in decompositions.cpp. Including this instead of <Eigen/Dense>
/// where they are used takes half a minute off a source file.
namespace Eigen {
extern template class JacobiSVD<MatrixXd>;
extern template class BDCSVD<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template class LLT<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class FullPivLU<MatrixXd>;
}  // namespace Eigen
