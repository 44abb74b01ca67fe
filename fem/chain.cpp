#include <slipmode/fem/chain.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>
#include <cmath>
#include <string>

namespace slipmode::fem {

namespace {

using Triplet = Eigen::Triplet<double>;

enum class Sign { kPositive, kNonNegative };

// `count` values from a list of one or `count`.
std::vector<double> expand(const std::vector<double>& values, int count, const char* key, Sign sign) {
  const auto wanted = static_cast<std::size_t>(count);
  if (values.size() != 1 && values.size() != wanted) {
    throw InvalidInput(fmt::format("chain: {} has {} values; expected 1 (for all) or {}", key, values.size(), count));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool in_range = sign == Sign::kPositive ? values[i] > 0.0 : values[i] >= 0.0;
    if (!in_range || !std::isfinite(values[i])) {
      throw InvalidInput(fmt::format("chain: {}[{}] = {}; expected a finite value {} 0", key, i + 1, values[i],
                                     sign == Sign::kPositive ? ">" : ">="));
    }
  }
  return values.size() == wanted ? values : std::vector<double>(wanted, values.front());
}

void check_damping(double value, const char* key) {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    throw InvalidInput(fmt::format("chain: {} = {}; expected a finite value >= 0", key, value));
  }
}

SparseMatrix from_triplets(int n, const std::vector<Triplet>& triplets) {
  SparseMatrix A(n, n);
  A.setFromTriplets(triplets.begin(), triplets.end());
  return A;
}

SparseMatrix assemble_stiffness(const ChainOptions& options) {
  const int n = options.masses;
  const int left = options.left_fixed ? 1 : 0;
  const int springs = n - 1 + left + (options.right_fixed ? 1 : 0);
  // A single free mass has no spring; whatever the list holds is then unused.
  const std::vector<double> k =
      springs == 0 ? std::vector<double>{} : expand(options.stiffness, springs, "stiffness", Sign::kPositive);
  std::vector<Triplet> triplets;
  triplets.reserve(static_cast<std::size_t>(5 * n + 5));
  for (int s = 0; s < springs; ++s) {
    const double value = k[static_cast<std::size_t>(s)];
    const int right_mass = s + 1 - left;  // 0-based; the mass on the spring's other side is one less
    const int left_mass = right_mass - 1;
    if (left_mass >= 0) triplets.emplace_back(left_mass, left_mass, value);
    if (right_mass < n) triplets.emplace_back(right_mass, right_mass, value);
    if (left_mass >= 0 && right_mass < n) {
      triplets.emplace_back(left_mass, right_mass, -value);
      triplets.emplace_back(right_mass, left_mass, -value);
    }
  }
  if (!options.ground_stiffness.empty()) {
    const auto ground = expand(options.ground_stiffness, n, "ground_stiffness", Sign::kNonNegative);
    for (int i = 0; i < n; ++i) triplets.emplace_back(i, i, ground[static_cast<std::size_t>(i)]);
  }
  return from_triplets(n, triplets);
}

}  // namespace

Structure chain(const ChainOptions& options) {
  const int n = options.masses;
  if (n < 1) throw InvalidInput(fmt::format("chain: masses = {}; expected at least 1", n));
  check_damping(options.damping, "damping");
  check_damping(options.mass_damping, "mass_damping");
  const auto masses = expand(options.mass, n, "mass", Sign::kPositive);

  std::vector<Triplet> diagonal;
  std::vector<std::string> names;
  for (int i = 0; i < n; ++i) {
    diagonal.emplace_back(i, i, masses[static_cast<std::size_t>(i)]);
    names.push_back(fmt::format("x{}", i + 1));
  }
  return Structure(from_triplets(n, diagonal), Rayleigh{options.mass_damping, options.damping},
                   assemble_stiffness(options), std::move(names), options.units);
}

}  // namespace slipmode::fem
