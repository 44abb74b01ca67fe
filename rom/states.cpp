#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/rom/reduce.hpp>
#include "rom/internal/check.hpp"

#include <fmt/format.h>
#include <string_view>

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
  // Φ = Q R: the Gram matrix of Q is as well conditioned as M, that of Φ need not be.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis.vectors);
  const Eigen::MatrixXd Q = orthonormal_columns(basis.vectors);
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
