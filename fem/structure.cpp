#include <slipmode/fem/structure.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace slipmode::fem {

namespace {

constexpr double kSymmetryTolerance = 1e-10;  // relative to the largest entry; a projection rounds at about n·1e-16
constexpr double kRayleighTolerance = 1e-12;  // relative to the Frobenius norm of C

Eigen::Index rows_of(const Matrix& A) {
  return std::visit([](const auto& m) { return m.rows(); }, A);
}

Eigen::Index cols_of(const Matrix& A) {
  return std::visit([](const auto& m) { return m.cols(); }, A);
}

const SparseMatrix* sparse_of(const Matrix& A) { return std::get_if<SparseMatrix>(&A); }

// Largest entry in magnitude; NaN when any entry is not finite.
double largest_entry(const SparseMatrix& A) {
  double largest = 0.0;
  for (Eigen::Index outer = 0; outer < A.outerSize(); ++outer) {
    for (SparseMatrix::InnerIterator it(A, outer); it; ++it) {
      if (!std::isfinite(it.value())) return std::nan("");
      largest = std::max(largest, std::abs(it.value()));
    }
  }
  return largest;
}

double largest_entry(const Eigen::MatrixXd& A) { return A.allFinite() ? A.cwiseAbs().maxCoeff() : std::nan(""); }

double asymmetry(const SparseMatrix& A) { return largest_entry(SparseMatrix(A - SparseMatrix(A.transpose()))); }
double asymmetry(const Eigen::MatrixXd& A) { return (A - A.transpose()).cwiseAbs().maxCoeff(); }

// Its largest entry.
double check_entries(const Matrix& A, const char* name, Eigen::Index n) {
  if (rows_of(A) != n || cols_of(A) != n) {
    throw InvalidInput(
        fmt::format("structure: {} is {} x {}, expected {} x {} like M", name, rows_of(A), cols_of(A), n, n));
  }
  const double scale = std::visit([](const auto& m) { return largest_entry(m); }, A);
  if (!std::isfinite(scale)) {
    throw InvalidInput(fmt::format("structure: {} holds a value that is not finite; give finite numbers", name));
  }
  return scale;
}

void check_symmetric(const Matrix& A, const char* name, Eigen::Index n) {
  const double scale = check_entries(A, name, n);
  const double skew = std::visit([](const auto& m) { return asymmetry(m); }, A);
  if (skew > kSymmetryTolerance * scale) {
    throw InvalidInput(
        fmt::format("structure: {} is not symmetric: entries across its diagonal differ by {:.3g}, its largest entry "
                    "is {:.3g}; give a symmetric matrix",
                    name, skew, scale));
  }
}

bool is_diagonal(const SparseMatrix& A) {
  for (Eigen::Index outer = 0; outer < A.outerSize(); ++outer) {
    for (SparseMatrix::InnerIterator it(A, outer); it; ++it) {
      if (it.row() != it.col() && it.value() != 0.0) return false;
    }
  }
  return true;
}

// True when every entry farther than `band` from the diagonal is zero.
bool within_band(const SparseMatrix& A, Eigen::Index band) {
  for (Eigen::Index outer = 0; outer < A.outerSize(); ++outer) {
    for (SparseMatrix::InnerIterator it(A, outer); it; ++it) {
      if (std::abs(it.row() - it.col()) > band && it.value() != 0.0) return false;
    }
  }
  return true;
}

bool within_band(const Eigen::MatrixXd& A, Eigen::Index band) {
  for (Eigen::Index col = 0; col < A.cols(); ++col) {
    const Eigen::Index above = std::max<Eigen::Index>(0, col - band);
    const Eigen::Index below = std::max<Eigen::Index>(0, A.rows() - col - band - 1);
    if ((A.col(col).head(above).array() != 0.0).any() || (A.col(col).tail(below).array() != 0.0).any()) return false;
  }
  return true;
}

bool is_positive_definite(const SparseMatrix& A) {
  if (is_diagonal(A)) return (A.diagonal().array() > 0.0).all();
  const Eigen::SimplicialLLT<SparseMatrix> cholesky(A);
  return cholesky.info() == Eigen::Success;
}

bool is_positive_definite(const Eigen::MatrixXd& A) { return Eigen::LLT<Eigen::MatrixXd>(A).info() == Eigen::Success; }

void check_mass_and_stiffness(const Matrix& M, const Matrix& K) {
  const Eigen::Index n = rows_of(M);
  if (n == 0) throw InvalidInput("structure: expected at least one degree of freedom, found a 0 x 0 mass matrix");
  check_symmetric(M, "M", n);
  check_symmetric(K, "K", n);
  if (!std::visit([](const auto& m) { return is_positive_definite(m); }, M)) {
    throw InvalidInput(
        "structure: M is not positive definite; every degree of freedom needs a positive mass (condense massless "
        "ones out)");
  }
}

// Whether C is symmetric; if it is not, its symmetric part must not feed energy in.
bool check_damping(const Matrix& C, Eigen::Index n) {
  constexpr double kLeft = 1e-12;  // what a projection may leave of an eigenvalue 0, of the largest entry
  const double scale = check_entries(C, "C", n);
  if (std::visit([](const auto& m) { return asymmetry(m); }, C) <= kSymmetryTolerance * scale) return true;
  const SparseMatrix sparse = to_sparse(C);
  SparseMatrix lifted = 0.5 * (sparse + SparseMatrix(sparse.transpose()));
  for (Eigen::Index i = 0; i < n; ++i) lifted.coeffRef(i, i) += kLeft * scale;
  if (!is_positive_definite(lifted)) {
    throw InvalidInput(
        "structure: C is not symmetric and its symmetric part is not positive semi-definite: some motion would gain "
        "energy from it; check its signs");
  }
  return false;
}

std::vector<std::string> checked_names(std::vector<std::string> names, Eigen::Index n) {
  if (names.empty()) {
    names.reserve(static_cast<std::size_t>(n));
    for (Eigen::Index i = 1; i <= n; ++i) names.push_back(fmt::format("q{}", i));
  }
  if (names.size() != static_cast<std::size_t>(n)) {
    throw InvalidInput(
        fmt::format("structure: {} names for {} degrees of freedom; give one each or none", names.size(), n));
  }
  return names;
}

void check_units(const std::string& units) {
  if (units != "dimensionless" && units != "SI") {
    throw InvalidInput(fmt::format("structure: units '{}'; expected 'dimensionless' or 'SI'", units));
  }
}

Matrix combine(double a, const Matrix& A, double b, const Matrix& B) {
  if (sparse_of(A) && sparse_of(B)) return SparseMatrix(a * *sparse_of(A) + b * *sparse_of(B));
  return Eigen::MatrixXd(a * to_dense(A) + b * to_dense(B));
}

double dot(const Matrix& A, const Matrix& B) {
  if (sparse_of(A) && sparse_of(B)) return sparse_of(A)->cwiseProduct(*sparse_of(B)).sum();
  return to_dense(A).cwiseProduct(to_dense(B)).sum();
}

double norm(const Matrix& A) {
  return std::visit([](const auto& m) { return m.norm(); }, A);
}

// Least-squares fit C ≈ a M + b K in the Frobenius norm. K is made orthogonal to M first: normal equations would
// square the condition of nearly parallel M and K.
std::optional<Rayleigh> fit_rayleigh(const Matrix& M, const Matrix& C, const Matrix& K) {
  const double scale = norm(C);
  if (scale == 0.0) return Rayleigh{};
  const double mass_squared = dot(M, M);
  const Matrix K_perp = combine(1.0, K, -dot(M, K) / mass_squared, M);
  const double perp_norm = norm(K_perp);
  Rayleigh fit;
  if (perp_norm > kRayleighTolerance * norm(K)) fit.stiffness = dot(C, K_perp) / (perp_norm * perp_norm);
  if (std::abs(fit.stiffness) * norm(K) <= kRayleighTolerance * scale) fit.stiffness = 0.0;
  fit.mass = dot(combine(1.0, C, -fit.stiffness, K), M) / mass_squared;
  if (std::abs(fit.mass) * std::sqrt(mass_squared) <= kRayleighTolerance * scale) fit.mass = 0.0;
  const Matrix rest = combine(1.0, C, -1.0, combine(fit.mass, M, fit.stiffness, K));
  if (norm(rest) > kRayleighTolerance * scale) return std::nullopt;
  return fit;
}

bool chain_like(const Matrix& M, const Matrix& K) {
  return std::visit([](const auto& m) { return within_band(m, 0); }, M) &&
         std::visit([](const auto& m) { return within_band(m, 1); }, K);
}

}  // namespace

Structure::Structure(Matrix M, Matrix C, Matrix K, std::vector<std::string> dof_names, std::string units)
    : M_(std::move(M)), C_(std::move(C)), K_(std::move(K)), units_(std::move(units)) {
  check_mass_and_stiffness(M_, K_);
  symmetric_damping_ = check_damping(C_, size());
  check_units(units_);
  dof_names_ = checked_names(std::move(dof_names), size());
  rayleigh_ = fit_rayleigh(M_, C_, K_);
  chain_like_ = chain_like(M_, K_);
}

Structure::Structure(Matrix M, Rayleigh r, Matrix K, std::vector<std::string> dof_names, std::string units)
    : M_(std::move(M)), K_(std::move(K)), units_(std::move(units)), rayleigh_(r) {
  if (!std::isfinite(r.mass) || !std::isfinite(r.stiffness)) {
    throw InvalidInput(fmt::format("structure: Rayleigh coefficients must be finite, found mass = {}, stiffness = {}",
                                   r.mass, r.stiffness));
  }
  check_mass_and_stiffness(M_, K_);
  check_units(units_);
  dof_names_ = checked_names(std::move(dof_names), size());
  C_ = combine(r.mass, M_, r.stiffness, K_);
  check_symmetric(C_, "C", size());
  chain_like_ = chain_like(M_, K_);
}

Eigen::Index Structure::size() const { return rows_of(M_); }
const Matrix& Structure::M() const { return M_; }
const Matrix& Structure::C() const { return C_; }
const Matrix& Structure::K() const { return K_; }
const std::vector<std::string>& Structure::dof_names() const { return dof_names_; }
const std::string& Structure::units() const { return units_; }
std::optional<Rayleigh> Structure::rayleigh() const { return rayleigh_; }
bool Structure::has_symmetric_damping() const { return symmetric_damping_; }
bool Structure::is_chain_like() const { return chain_like_; }

double Structure::energy(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  if (q.size() != size() || v.size() != size()) {
    throw InvalidInput(
        fmt::format("structure energy: q has {} and v has {} entries, expected {}", q.size(), v.size(), size()));
  }
  const auto half_square = [](const Matrix& A, const Eigen::VectorXd& x) {
    return std::visit([&x](const auto& m) { return 0.5 * x.dot(m * x); }, A);
  };
  return half_square(M_, v) + half_square(K_, q);
}

double Structure::dissipation(const Eigen::VectorXd& v) const {
  if (v.size() != size()) {
    throw InvalidInput(fmt::format("structure dissipation: v has {} entries, expected {}", v.size(), size()));
  }
  return v.dot(multiply(C_, v).col(0));
}

Eigen::MatrixXd multiply(const Matrix& A, const Eigen::MatrixXd& x) {
  return std::visit([&x](const auto& m) { return Eigen::MatrixXd(m * x); }, A);
}

Eigen::MatrixXd to_dense(const Matrix& A) {
  return std::visit([](const auto& m) { return Eigen::MatrixXd(m); }, A);
}

SparseMatrix to_sparse(const Matrix& A) {
  if (const SparseMatrix* sparse = sparse_of(A)) return *sparse;
  return std::get<Eigen::MatrixXd>(A).sparseView(0.0, 0.0);
}

}  // namespace slipmode::fem
