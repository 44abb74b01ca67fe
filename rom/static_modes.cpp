#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/pod/gram_schmidt.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace slipmode::rom {

namespace {

void check_sizes(Eigen::Index n, const Eigen::MatrixXd& directions, Eigen::Index count) {
  const Eigen::Index m = directions.cols();
  if (directions.rows() != n || m < 1 || m > n || !directions.allFinite()) {
    throw InvalidInput(
        fmt::format("static contact modes: directions are {} x {}; expected {} rows, one per degree of freedom, and 1 "
                    "to {} columns of finite values",
                    directions.rows(), m, n, n));
  }
  if (count < 0 || count > n - m) {
    throw InvalidInput(
        fmt::format("static contact modes: {} natural modes asked beside {} static ones of {} degrees of freedom; "
                    "expected 0 to {}",
                    count, m, n, n - m));
  }
}

[[noreturn]] void fail_singular(const std::string& found) {
  throw InvalidInput(fmt::format(
      "static contact modes: K is singular ({}): a constant contact force has no static response. Restrain the "
      "structure, or use natural modes alone",
      found));
}

/// K⁻¹W. K has no rigid-body modes.
Eigen::MatrixXd solve(const fem::Matrix& K, const Eigen::MatrixXd& W) {
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&K)) {
    const Eigen::LLT<Eigen::MatrixXd> factor(*dense);
    if (factor.info() == Eigen::Success) return factor.solve(W);
  } else {
    const Eigen::SimplicialLLT<fem::SparseMatrix> factor(std::get<fem::SparseMatrix>(K));
    if (factor.info() == Eigen::Success) return factor.solve(W);
  }
  fail_singular("its Cholesky factorisation fails");
}

}  // namespace

pod::Basis lnm_static_basis(const fem::Structure& structure, const Eigen::MatrixXd& directions, Eigen::Index count) {
  const Eigen::Index n = structure.size();
  const Eigen::Index m = directions.cols();
  check_sizes(n, directions, count);
  const fem::Modes modes = fem::natural_modes(structure, std::max<Eigen::Index>(count, 1));
  const Eigen::Index rigid = (modes.omega.array() == 0.0).count();
  if (rigid > 0) fail_singular(fmt::format("at least {} rigid-body mode(s)", rigid));

  Eigen::MatrixXd columns(n, m + count);
  columns << solve(structure.K(), directions), modes.shapes.leftCols(count);
  pod::Basis basis;
  basis.vectors = pod::mass_orthonormalise(columns, structure.M(), "static contact modes with natural modes").vectors;
  basis.mean = Eigen::VectorXd::Zero(n);
  basis.kind = pod::BasisKind::kLnmStatic;
  basis.provenance = fmt::format(
      "{} static contact mode(s), then {} lowest of {} natural modes of the slipping structure, Gram-Schmidt in the "
      "mass "
      "metric",
      m, count, n);
  return basis;
}

pod::Basis lnm_static_basis(const dynamics::HybridSystem& system, Eigen::Index count) {
  if (system.contacts().empty()) {
    throw InvalidInput("static contact modes: the system has no contacts; use natural modes alone");
  }
  Eigen::MatrixXd directions(system.size(), static_cast<Eigen::Index>(system.contacts().size()));
  for (std::size_t c = 0; c < system.contacts().size(); ++c) {
    directions.col(static_cast<Eigen::Index>(c)) = system.contacts()[c].direction;
  }
  return lnm_static_basis(system.structure(), directions, count);
}

}  // namespace slipmode::rom
