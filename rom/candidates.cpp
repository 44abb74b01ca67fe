#include <slipmode/rom/candidates.hpp>

#include <slipmode/rom/reduce.hpp>

#include <utility>

namespace slipmode::rom {
namespace {

/// A small ensemble with the mean-free second moments of the one a POD was made of: ±σ_i φ_i.
pod::Ensemble moments(const pod::PodResult& result) {
  const Eigen::MatrixXd half = result.basis.vectors * result.singular_values.head(result.basis.modes()).asDiagonal();
  Eigen::MatrixXd snapshots(half.rows(), 2 * half.cols());
  snapshots << half, -half;
  return {.snapshots = snapshots, .run_begin = {0}};
}

/// A basis about the mean of a POD, with what it captures of its energy.
pod::NamedBasis about_mean(std::string name, pod::Basis basis, const pod::PodResult& result) {
  basis.mean = result.basis.mean;
  Eigen::VectorXd captured = pod::captured_energy(moments(result), basis);
  return {.name = std::move(name), .basis = std::move(basis), .captured = std::move(captured)};
}

}  // namespace

std::vector<pod::NamedBasis> pom_and_lnm(const fem::Structure& structure, const pod::PodResult& result) {
  std::vector<pod::NamedBasis> candidates;
  candidates.push_back({.name = "POM", .basis = result.basis, .captured = pod::cumulative(result.shares)});
  candidates.push_back(about_mean("LNM", lnm_basis(structure, structure.size()), result));
  return candidates;
}

pod::NamedBasis lnm_and_static(const dynamics::HybridSystem& system, const pod::PodResult& result) {
  const auto contacts = static_cast<Eigen::Index>(system.contacts().size());
  return about_mean("LNM+static", lnm_static_basis(system, system.size() - contacts), result);
}

}  // namespace slipmode::rom
