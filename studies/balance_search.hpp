#pragma once

#include <slipmode/orbits/balance/certificate.hpp>
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
};

/// @param shooting  tolerance, iterations, segments of the shooting that certifies
/// @throws InvalidInput  as orbits::balance and orbits::balance_to_error
[[nodiscard]] BalanceFound find_balance(const Family& model, const BalanceSearch& search,
                                        const orbits::ShootingOptions& shooting = {});

}  // namespace slipmode::studies
