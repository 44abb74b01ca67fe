#pragma once

#include <slipmode/orbits/balance/balance_branch.hpp>
#include <slipmode/studies/orbit_search.hpp>

#include <optional>
#include <vector>

namespace slipmode::studies {

/// Which balance is looked for.
struct BalanceSearch {
  orbits::BalanceOptions options;
  /// Set: the order is chosen by this true error, a share of the half range of every contact's displacement.
  std::optional<double> error = {};
  bool certify = false;  ///< an order that is chosen is certified anyway
};

struct BalanceFound {
  orbits::Balance balance;
  std::optional<orbits::Certificate> certificate = {};
  std::vector<orbits::OrderTrial> trials = {};  ///< of an order that is chosen
  bool met = true;                              ///< the error asked is
  /// Multipliers by Hill's method, and by what it leaves when jumps are left out; empty without a balance, where n H
  /// is above kMostForHill, and where a contact remembers (orbits::has_memory).
  Eigen::VectorXcd hill = {}, hill_without_jumps = {};
};

/// Degrees of freedom times harmonics up to which exponents are taken: they cost its third power, here seconds.
inline constexpr int kMostForHill = 400;

/// @param shooting  tolerance, iterations, segments of the shooting that certifies
/// @throws InvalidInput  as orbits::balance and orbits::balance_to_error
[[nodiscard]] BalanceFound find_balance(const Family& model, const BalanceSearch& search,
                                        const orbits::ShootingOptions& shooting = {});

/// A branch of balances over a key, of one order throughout.
struct BalanceContinuation {
  BalanceFound found;          ///< the balance it begins with
  double start = 0.0;          ///< the key's value there
  orbits::Branch branch = {};  ///< empty where no balance was found
  std::optional<orbits::BranchCertificate> certificate = {};
  std::vector<orbits::OrderTrial> trials = {};  ///< of an order that is chosen: the worst error along each
};

/// Finds a balance where continue_orbit would find its orbit, and follows it. With `search.error` the order grows, by
/// 1.3 at a time, until every certified point that has an orbit behind meets the error.
/// @param every  certify every k-th point, where `search` asks for certificates; ≥ 1
/// @throws InvalidInput  as family_over, find_balance and continue_balance
/// @throws Interrupted   when the stop flag was set
[[nodiscard]] BalanceContinuation continue_balance(const scene::Scene& scene, const std::string& key,
                                                   const std::optional<pod::NamedBasis>& basis, BalanceSearch search,
                                                   const ContinuationRequest& request, int every,
                                                   const orbits::ShootingOptions& shooting, const RunOptions& run = {});

}  // namespace slipmode::studies
