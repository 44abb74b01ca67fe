#include <slipmode/core/decompositions.hpp>

namespace Eigen {
template class JacobiSVD<MatrixXd>;
template class HouseholderQR<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
template class EigenSolver<MatrixXd>;
template class LLT<MatrixXd>;
template class LDLT<MatrixXd>;
template class PartialPivLU<MatrixXd>;
template class FullPivLU<MatrixXd>;

template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
template ColPivHouseholderQR<MatrixXd>& ColPivHouseholderQR<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template void LLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template void LDLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
}  // namespace Eigen
