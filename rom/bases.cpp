#include <slipmode/core/errors.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/rom/reduce.hpp>
#include "rom/internal/check.hpp"

#include <fmt/format.h>
#include <utility>

namespace slipmode::rom {

pod::Basis lnm_basis(const fem::Structure& structure, Eigen::Index count) {
  if (count < 1 || count > structure.size()) {
    throw InvalidInput(fmt::format("natural modes as a basis: {} asked of {} degrees of freedom; expected 1 to {}",
                                   count, structure.size(), structure.size()));
  }
  pod::Basis basis;
  basis.vectors = fem::natural_modes(structure, count).shapes;
  basis.mean = Eigen::VectorXd::Zero(structure.size());
  basis.kind = pod::BasisKind::kLnm;
  basis.provenance = fmt::format("{} lowest of {} natural modes of the slipping structure", count, structure.size());
  return basis;
}

pod::Basis user_basis(Eigen::MatrixXd vectors, Eigen::VectorXd mean) {
  pod::Basis basis;
  basis.vectors = std::move(vectors);
  basis.mean = std::move(mean);
  basis.kind = pod::BasisKind::kUser;
  basis.provenance = "supplied by the user";
  check_basis(basis, -1, "user basis");
  basis.mean = mean_or_zero(basis);
  return basis;
}

}  // namespace slipmode::rom
