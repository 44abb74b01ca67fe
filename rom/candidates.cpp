#include <slipmode/rom/candidates.hpp>

#include <slipmode/rom/reduce.hpp>

namespace slipmode::rom {
namespace {

/// A small ensemble with the mean-free second moments of the one a POD was made of: ±σ_i φ_i.
pod::Ensemble moments(const pod::PodResult& result) {
  const Eigen::MatrixXd half = result.basis.vectors * result.singular_values.head(result.basis.modes()).asDiagonal();
  Eigen::MatrixXd snapshots(half.rows(), 2 * half.cols());
  snapshots << half, -half;
  return {.snapshots = snapshots, .run_begin = {0}};
}

}  // namespace

std::vector<pod::NamedBasis> pom_and_lnm(const fem::Structure& structure, const pod::PodResult& result) {
  pod::Basis lnm = lnm_basis(structure, structure.size());
  lnm.mean = result.basis.mean;
  std::vector<pod::NamedBasis> candidates;
  candidates.push_back({.name = "POM", .basis = result.basis, .captured = pod::cumulative(result.shares)});
  candidates.push_back({.name = "LNM", .basis = lnm, .captured = pod::captured_energy(moments(result), lnm)});
  return candidates;
}

}  // namespace slipmode::rom
