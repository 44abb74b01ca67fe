#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include "rom/internal/check.hpp"

#include <fmt/format.h>
#include <string_view>
#include <variant>

namespace slipmode::rom {

namespace {

void check_state(const dynamics::State& state, Eigen::Index n, std::string_view where) {
  if (state.q.size() != n || state.v.size() != n) {
    throw InvalidInput(fmt::format("{}: state has {} displacements and {} velocities; expected {} of each", where,
                                   state.q.size(), state.v.size(), n));
  }
}

}  // namespace

dynamics::State lift(const pod::Basis& basis, const dynamics::State& reduced) {
  check_state(reduced, basis.modes(), "lift");
  dynamics::State full = reduced;  // time, contact modes and contacts' own states are the same
  full.q = mean_or_zero(basis) + basis.vectors * reduced.q;
  full.v = basis.vectors * reduced.v;
  return full;
}

dynamics::State restrict_state(const fem::Structure& structure, const pod::Basis& basis, const dynamics::State& full) {
  constexpr double kNothingLost = 1e-12;
  check_basis(basis, structure.size(), "restrict");
  check_state(full, structure.size(), "restrict");
  // S Φ = Q R: the Gram matrix of Q in S⁻¹MS⁻¹, S² = diag M, is well conditioned where Φ is not, nor M of metres and
  // radians.
  const Eigen::VectorXd scale =
      std::visit([](const auto& M) -> Eigen::VectorXd { return M.diagonal().cwiseSqrt(); }, structure.M());
  const Eigen::MatrixXd scaled = scale.asDiagonal() * basis.vectors;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  const Eigen::MatrixXd Q = scale.cwiseInverse().asDiagonal() * orthonormal_columns(scaled);
  const Eigen::MatrixXd MQ = fem::multiply(structure.M(), Q);
  const Eigen::LLT<Eigen::MatrixXd> gram(Q.transpose() * MQ);
  const auto R = qr.matrixQR().topRows(basis.modes()).triangularView<Eigen::Upper>();

  dynamics::State reduced = full;
  reduced.q = R.solve(gram.solve(MQ.transpose() * (full.q - mean_or_zero(basis))));
  reduced.v = R.solve(gram.solve(MQ.transpose() * full.v));
  const double lost = (full.v - basis.vectors * reduced.v).norm();
  if (!(lost <= kNothingLost * full.v.norm())) reduced.modes.clear();
  return reduced;
}

}  // namespace slipmode::rom
