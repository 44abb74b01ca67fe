#pragma once

#include <Eigen/Dense>

/// Eigen's decompositions of MatrixXd, compiled once in decompositions.cpp. Including this instead of <Eigen/Dense>
/// where they are used takes half a minute off a source file. What takes an argument of any type is a template of its
/// own within the class, and is named for the types in use: matrices are passed as MatrixXd, right-hand sides as
/// MatrixXd or VectorXd, not as expressions.
namespace Eigen {
extern template class JacobiSVD<MatrixXd>;
extern template class HouseholderQR<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template class LLT<MatrixXd>;
extern template class LDLT<MatrixXd>;
extern template class PartialPivLU<MatrixXd>;
extern template class FullPivLU<MatrixXd>;

extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                                            int);
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
extern template ColPivHouseholderQR<MatrixXd>& ColPivHouseholderQR<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template void LLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template void LDLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
}  // namespace Eigen
