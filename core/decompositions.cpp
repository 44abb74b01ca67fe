#include "core/decompositions.hpp"

namespace Eigen {
template class JacobiSVD<MatrixXd>;
template class BDCSVD<MatrixXd>;
template class HouseholderQR<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
template class EigenSolver<MatrixXd>;
template class LLT<MatrixXd>;
template class LDLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;
template class FullPivLU<MatrixXd>;
}  // namespace Eigen
