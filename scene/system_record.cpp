#include "scene/records.hpp"

#include <fmt/format.h>
#include "core/errors.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace slipmode::scene {

namespace {

constexpr std::array<const char*, 3> kLaws = {"coulomb", "stribeck", "tanh"};  // in the order of friction::Law
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

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

double alpha_of(const friction::Law& law) {
  if (const auto* stribeck = std::get_if<friction::Stribeck>(&law)) return stribeck->alpha;
  if (const auto* tanh = std::get_if<friction::TanhRegularised>(&law)) return tanh->alpha;
  return kAbsent;
}

double epsilon_of(const friction::Law& law) {
  const auto* tanh = std::get_if<friction::TanhRegularised>(&law);
  return tanh != nullptr ? tanh->epsilon : kAbsent;
}

void save_contacts(StoreWriter& store, const std::string& group, const dynamics::HybridSystem& system) {
  const auto& contacts = system.contacts();
  std::vector<std::string> names, laws;
  std::vector<double> mu_s, mu_k, alpha, epsilon, load, offset;
  Eigen::MatrixXd direction(system.size(), static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const friction::Contact& contact = contacts[c];
    names.push_back(contact.name);
    laws.emplace_back(kLaws[contact.law.index()]);
    mu_s.push_back(friction::static_coefficient(contact.law));
    mu_k.push_back(friction::limit_coefficient(contact.law));
    alpha.push_back(alpha_of(contact.law));
    epsilon.push_back(epsilon_of(contact.law));
    load.push_back(contact.normal_load.constant);
    offset.push_back(contact.offset);
    direction.col(static_cast<Eigen::Index>(c)) = contact.direction;
  }
  store.describe_group(group, "friction contacts, one entry of each dataset per contact");
  store.write(group + "/name", names, {"", "name"});
  store.write(group + "/law", laws, {"", "coulomb, stribeck or tanh"});
  store.write(group + "/mu_s", mu_s, {"1", "static coefficient"});
  store.write(group + "/mu_k", mu_k, {"1", "kinetic coefficient"});
  store.write(group + "/alpha", alpha, {"s/m", "decay with sliding speed; NaN where the law has none"});
  store.write(group + "/epsilon", epsilon, {"m/s", "regularisation speed; NaN where the law has none"});
  store.write(group + "/normal_load", load, {"N", "normal load"});
  store.write(group + "/offset", offset, {"m", "added to the contact displacement"});
  store.write_columns(group + "/direction", direction, {"1", "contact directions w, contact x dof"});
}

friction::Law make_law(const StoreReader& store, const std::string& group, const std::string& law, double mu_s,
                       double mu_k, double alpha, double epsilon) {
  if (law == kLaws[0]) return friction::Coulomb{mu_s, mu_k};
  if (law == kLaws[1]) return friction::Stribeck{mu_s, mu_k, alpha};
  if (law == kLaws[2]) return friction::TanhRegularised{mu_s, mu_k, alpha, epsilon};
  store.fail(group + "/law", fmt::format("'{}'; expected coulomb, stribeck or tanh", law));
}

std::vector<friction::Contact> load_contacts(const StoreReader& store, const std::string& group, Eigen::Index n) {
  const std::vector<std::string> names = store.texts(group + "/name");
  const auto count = static_cast<Eigen::Index>(names.size());
  const std::vector<std::string> laws = store.texts(group + "/law", count);
  const Eigen::VectorXd mu_s = store.vector(group + "/mu_s", count);
  const Eigen::VectorXd mu_k = store.vector(group + "/mu_k", count);
  const Eigen::VectorXd alpha = store.vector(group + "/alpha", count);
  const Eigen::VectorXd epsilon = store.vector(group + "/epsilon", count);
  const Eigen::VectorXd load = store.vector(group + "/normal_load", count);
  const Eigen::VectorXd offset = store.vector(group + "/offset", count);
  const Eigen::MatrixXd direction = store.columns(group + "/direction", n, count);
  std::vector<friction::Contact> contacts;
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto at = static_cast<std::size_t>(c);
    contacts.push_back({.direction = direction.col(c),
                        .law = make_law(store, group, laws[at], mu_s(c), mu_k(c), alpha(c), epsilon(c)),
                        .normal_load = load(c),
                        .offset = offset(c),
                        .name = names[at]});
  }
  return contacts;
}

void save_drive(StoreWriter& store, const std::string& group, const friction::Belt& belt) {
  store.describe_group(group, "belt under the contacts");
  store.write(group + "/kind", std::string("belt"), {"", "kind of drive"});
  store.write(group + "/speed", belt.speed, {"m/s", "speed at the start"});
  store.write(group + "/end_speed", belt.end_speed, {"m/s", "speed after the ramp"});
  store.write(group + "/ramp_begin", belt.ramp_begin, {"s", "start of the ramp"});
  store.write(group + "/ramp_end", belt.ramp_end, {"s", "end of the ramp; not after ramp_begin: no ramp"});
}

friction::Drive load_drive(const StoreReader& store, const std::string& group) {
  const std::string kind = store.text(group + "/kind");
  if (kind != "belt") store.fail(group + "/kind", fmt::format("'{}'; expected belt", kind));
  return friction::Belt{store.number(group + "/speed"), store.number(group + "/end_speed"),
                        store.number(group + "/ramp_begin"), store.number(group + "/ramp_end")};
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
  save_contacts(store, group + "/contacts", system);
  save_drive(store, group + "/drive", *system.drive().belt());
}

dynamics::HybridSystem load_system(const StoreReader& store, const std::string& group) {
  Eigen::VectorXd load = store.vector(group + "/load");
  if (!load.allFinite()) store.fail(group + "/load", "holds NaN or an infinity; make the file again");
  try {
    fem::Structure structure = load_structure(store, group);
    std::vector<friction::Contact> contacts = load_contacts(store, group + "/contacts", structure.size());
    return {std::move(structure), std::move(contacts), load_drive(store, group + "/drive"), std::move(load)};
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

}  // namespace slipmode::scene
