#pragma once

#include <slipmode/orbits/branches/balance_branch.hpp>
#include <slipmode/studies/orbit_search.hpp>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace slipmode::studies {

/// Which balance is looked for.
struct BalanceSearch {
  orbits::BalanceOptions options;
  /// Set: the order is chosen by this true error, a share of the half range of every contact's displacement.
  std::optional<double> error = {};
  bool certify = false;  ///< an order that is chosen is certified anyway
};

/// The same as a user says it.
struct BalanceWords {
  std::optional<std::string> harmonics = {}, samples = {};  ///< else 9, exact
  std::optional<double> error = {};
  bool certify = false;
  std::optional<int> near = {};  ///< of a mixed orbit, else 0

  static constexpr auto fields() {
    using Own = BalanceWords;
    return std::tuple{
        optional("harmonics", &Own::harmonics, "", "highest order, or auto: the order that error needs"),
        optional("error", &Own::error, "1",
                 "of harmonics auto: true error, a share of the half range of the displacement", kPositive),
        optional("samples", &Own::samples, "",
                 "of a balance: exact force integrals, or the alternating scheme with so many samples"),
        optional("certify", &Own::certify, "", "shoot from what was found to the exact orbit: true error, multipliers"),
        optional(
            "near", &Own::near, "",
            "of a mixed orbit: degrees of freedom coupled to a contact within so many steps stay in the time domain",
            kFromZero)};
  }
  bool operator==(const BalanceWords&) const = default;
};
/// @param start  "settle" (the default), "contact" or "gap" @param period_order  period in periods of the drive
/// @throws InvalidInput  for words that are no numbers, auto without an error, and near
[[nodiscard]] BalanceSearch balance_search(const BalanceWords& words, const std::string& start, int period_order);

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

/// Which mixed orbit is looked for.
struct MixedSearch {
  orbits::MixedOptions options;
  std::optional<double> error = {};  ///< as BalanceSearch::error
  bool certify = false;              ///< shoot from it on the whole structure; an order that is chosen is anyway
};
/// @param start  "settle": it begins by itself
/// @throws InvalidInput  as balance_search, and for words that are a balance's alone
[[nodiscard]] MixedSearch mixed_search(const BalanceWords& words, const std::string& start, int period_order);

struct MixedFound {
  orbits::MixedOrbit mixed;
  std::optional<orbits::Certificate> certificate = {};
  std::vector<orbits::OrderTrial> trials = {};  ///< of an order that is chosen
  bool met = true;                              ///< the error asked is
};
/// @throws InvalidInput, NumericalFailure  as orbits::mixed_orbit and orbits::mixed_to_error
[[nodiscard]] MixedFound find_mixed(const Family& model, const MixedSearch& search,
                                    const orbits::ShootingOptions& shooting = {});

/// That no order met the error asked, and how near the best came.
[[nodiscard]] std::string not_met(const std::vector<orbits::OrderTrial>& trials);

/// What is kept of one that converged: the balance and, where it is certified, the orbit behind.
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const BalanceFound> found);
/// What is kept of a mixed orbit: the exact orbit behind, which there must be, and how far it is from that.
[[nodiscard]] results::Content content_of(const Family& model, std::shared_ptr<const MixedFound> found);
/// Names of its degrees of freedom in the time domain.
[[nodiscard]] std::vector<std::string> near_names(const Family& model, const orbits::MixedOrbit& mixed);

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
/// @param every  certify every k-th point and the last, where `search` asks for certificates; ≥ 1, else all
/// @throws InvalidInput  as family_over, find_balance and continue_balance
/// Where the stop flag is set on its way, the branch ends there (BranchEnd::kInterrupted).
[[nodiscard]] BalanceContinuation continue_balance(const scene::Scene& scene, const std::string& key,
                                                   const std::optional<pod::NamedBasis>& basis, BalanceSearch search,
                                                   const ContinuationRequest& request, std::optional<int> every,
                                                   const orbits::ShootingOptions& shooting, const RunOptions& run = {});

/// As studies::command_of. @param start, every  as balance_search and continue_balance
[[nodiscard]] std::string command_of(const std::string& key, const std::string& model, const OrbitSearch& search,
                                     const BalanceWords& words, const std::string& start, std::optional<int> every,
                                     const ContinuationRequest& request);
/// Its one branch, to be kept as branches of orbits are.
[[nodiscard]] std::shared_ptr<const std::vector<results::NamedBranch>> branches_of(const BalanceContinuation& found);

}  // namespace slipmode::studies
