#include <slipmode/core/errors.hpp>
#include <slipmode/results/records.hpp>
#include "results/internal/contact_record.hpp"

#include <fmt/format.h>

namespace slipmode::results {

namespace {

void save_matrix(StoreWriter& store, const std::string& name, const fem::Matrix& matrix, const std::string& units,
                 const std::string& what) {
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&matrix)) {
    store.write(name, *dense, {units, what + ", dof x dof"});
    return;
  }
  const auto& sparse = std::get<fem::SparseMatrix>(matrix);
  std::vector<std::int64_t> rows, cols;
  std::vector<double> values;
  for (Eigen::Index outer = 0; outer < sparse.outerSize(); ++outer) {
    for (fem::SparseMatrix::InnerIterator entry(sparse, outer); entry; ++entry) {
      rows.push_back(entry.row());
      cols.push_back(entry.col());
      values.push_back(entry.value());
    }
  }
  store.describe_group(name, what + ", sparse: entry k is values[k] at (rows[k], columns[k]), from 0");
  store.write(name + "/rows", rows, {"", "row of each entry, from 0"});
  store.write(name + "/columns", cols, {"", "column of each entry, from 0"});
  store.write(name + "/values", values, {units, "value of each entry"});
}

Eigen::MatrixXd load_dense(const StoreReader& store, const std::string& name, Eigen::Index n) {
  Eigen::MatrixXd values = store.matrix(name, n, n);
  if (!values.allFinite()) store.fail(name, "holds NaN or an infinity; expected finite numbers, make the file again");
  return values;
}

fem::Matrix load_matrix(const StoreReader& store, const std::string& name, Eigen::Index n) {
  if (store.entry(name).kind != StoreEntry::Kind::kGroup) return load_dense(store, name, n);
  const Eigen::VectorXd values = store.vector(name + "/values");
  if (!values.allFinite()) store.fail(name, "holds NaN or an infinity; expected finite numbers, make the file again");
  const auto rows = store.integers(name + "/rows", values.size());
  const auto cols = store.integers(name + "/columns", values.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] < 0 || rows[k] >= n || cols[k] < 0 || cols[k] >= n) {
      store.fail(name,
                 fmt::format("entry {} lies at ({}, {}); expected indices from 0 to {}", k, rows[k], cols[k], n - 1));
    }
    entries.emplace_back(static_cast<int>(rows[k]), static_cast<int>(cols[k]), values(static_cast<Eigen::Index>(k)));
  }
  fem::SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

fem::Structure load_structure(const StoreReader& store, const std::string& group) {
  const std::vector<std::string> names = store.texts(group + "/dof_names");
  const auto n = static_cast<Eigen::Index>(names.size());
  const std::string units = store.text(group + "/units");
  const fem::Matrix M = load_matrix(store, group + "/M", n);
  const fem::Matrix C = load_matrix(store, group + "/C", n);
  const fem::Matrix K = load_matrix(store, group + "/K", n);
  // The coefficients where they give C to the last bit, else C: either way the model is the one that was saved.
  if (store.has(group + "/rayleigh")) {
    const Eigen::VectorXd rayleigh = store.vector(group + "/rayleigh", 2);
    fem::Structure proportional(M, fem::Rayleigh{rayleigh(0), rayleigh(1)}, K, names, units);
    if (fem::to_sparse(proportional.C()).isApprox(fem::to_sparse(C), 0.0)) return proportional;
  }
  return {M, C, K, names, units};
}

}  // namespace

void save(StoreWriter& store, const std::string& group, const dynamics::HybridSystem& system) {
  const fem::Structure& structure = system.structure();
  store.describe_group(group, "structure with contacts: M q'' + C q' + K q = load + sum of w lambda");
  store.write(group + "/units", structure.units(), {"", "dimensionless or SI"});
  store.write(group + "/dof_names", structure.dof_names(), {"", "name of each dof"});
  save_matrix(store, group + "/M", structure.M(), "kg", "mass matrix");
  save_matrix(store, group + "/C", structure.C(), "N s/m", "damping matrix");
  save_matrix(store, group + "/K", structure.K(), "N/m", "stiffness matrix");
  if (const auto rayleigh = structure.rayleigh()) {
    store.write(group + "/rayleigh", std::vector<double>{rayleigh->mass, rayleigh->stiffness},
                {"1/s, s", "C = first M + second K"});
  }
  store.write(group + "/load", system.load(), {"N", "constant load on each dof; empty: none"});
  store.write_columns(group + "/force_directions", system.force_directions(),
                      {"1", "what the harmonics of a force drive act along, direction x dof; empty: none"});
  save_contacts(store, group + "/contacts", system.contacts(), system.size());
  save_drive(store, group + "/drive", system.drive());
}

dynamics::HybridSystem load_system(const StoreReader& store, const std::string& group) {
  Eigen::VectorXd load = store.vector(group + "/load");
  if (!load.allFinite()) store.fail(group + "/load", "holds NaN or an infinity; make the file again");
  try {
    fem::Structure structure = load_structure(store, group);
    std::vector<friction::Contact> contacts = load_contacts(store, group + "/contacts", structure.size());
    const std::string directions = group + "/force_directions";  // not in files of versions that had no forces
    Eigen::MatrixXd forces =
        store.has(directions) ? store.columns(directions, structure.size()) : Eigen::MatrixXd(structure.size(), 0);
    return {std::move(structure), std::move(contacts), load_drive(store, group + "/drive"), std::move(load),
            std::move(forces)};
  } catch (const InvalidInput& error) {
    const std::string what = error.what();
    if (what.starts_with(store.path().string())) throw;
    store.fail(group, what + "; the file is damaged, make it again");
  }
}

void save(StoreWriter& store, const std::string& group, const ReducedModel& model) {
  store.describe_group(group, "reduced model and the basis it was projected on");
  save(store, group + "/system", model.system);
  save(store, group + "/basis", model.basis);
}

ReducedModel load_reduced(const StoreReader& store, const std::string& group) {
  pod::Basis basis = load_basis(store, group + "/basis");
  dynamics::HybridSystem system = load_system(store, group + "/system");
  if (system.size() != basis.modes()) {
    store.fail(group, fmt::format("the system has {} dofs, the basis {} modes; the file is inconsistent, make it again",
                                  system.size(), basis.modes()));
  }
  return {std::move(system), std::move(basis)};
}

}  // namespace slipmode::results
