#pragma once

#include <slipmode/orbits/balance/balance.hpp>
#include <slipmode/orbits/mixed/mixed.hpp>
#include <slipmode/orbits/shooting.hpp>

#include <string>
#include <vector>

namespace slipmode::orbits {

/// What is true of a balance or a mixed orbit: the exact orbit that Newton's shooting reaches from it, and how far the
/// approximation is from that.
struct Certificate {
  /// An orbit was reached, and nowhere farther from it than a quarter of a contact's half range.
  bool behind = false;
  ShootingResult found;       ///< the exact orbit, with its multipliers, events and word
  std::vector<double> error;  ///< sup over the period of |y − y_orbit|, per contact [m]; empty without an orbit
  double relative = 0.0;      ///< the largest of them, each as a share of its contact's half range
  std::string verdict;        ///< in a sentence
};

/// Shoots from a balance to the exact orbit and measures the distance.
/// @param options  order is the balance's, whatever is given here
/// The supremum is that of a grid of 500 points or 24 a harmonic, whichever is more, each local largest one improved
/// by the parabola through three.
[[nodiscard]] Certificate certify(const dynamics::HybridSystem& system, const Balance& balance,
                                  const ShootingOptions& options = {});

/// The same from a mixed orbit. Shooting carries tangents of the whole structure: their cost grows as n².
[[nodiscard]] Certificate certify(const dynamics::HybridSystem& system, const MixedOrbit& mixed,
                                  const ShootingOptions& options = {});

/// The distance from an orbit that is known, without shooting. @param known  has converged
[[nodiscard]] Certificate compare(const dynamics::HybridSystem& system, const Balance& balance,
                                  const ShootingResult& known);
[[nodiscard]] Certificate compare(const dynamics::HybridSystem& system, const MixedOrbit& mixed,
                                  const ShootingResult& known);

/// sup |y_balance − y_orbit| of each contact [m].
[[nodiscard]] std::vector<double> true_errors(const Balance& balance, const OrbitSeries& orbit);

/// One order that was tried.
struct OrderTrial {
  int harmonics = 0, iterations = 0;
  double error = 0.0;  ///< Certificate::relative; NaN where no orbit lies behind
};

/// A balance or a mixed orbit whose order was chosen.
template <class Approximation>
struct ToError {
  bool met = false;  ///< the error asked is, by this
  /// Where it is not: the one of least true error; the last where no orbit lies behind any.
  Approximation approximation;
  Certificate certificate;
  std::vector<OrderTrial> trials;
};
using CertifiedBalance = ToError<Balance>;
using CertifiedMixed = ToError<MixedOrbit>;

/// The lowest order, to within a factor of 1.5, whose true error is at most `error`: orders grow by at most 1.3, or by
/// one, from one to the next, each begun from the best before.
/// @param error  as a share of the half range of each contact's displacement, > 0
/// @param most   orders that are tried at most
/// @throws InvalidInput  for an error that is not positive; and as `balance`
[[nodiscard]] CertifiedBalance balance_to_error(const dynamics::HybridSystem& system, BalanceOptions options,
                                                double error, int most = 4000, const ShootingOptions& shooting = {});

/// The same of the mixed method, whose steps cost the third power of orders. One shooting on the whole structure, as
/// long as the orbit it ends on lies behind the orders that follow.
/// @throws InvalidInput, NumericalFailure  likewise, and as `mixed_orbit`
[[nodiscard]] CertifiedMixed mixed_to_error(const dynamics::HybridSystem& system, MixedOptions options, double error,
                                            int most = 200, const ShootingOptions& shooting = {});

}  // namespace slipmode::orbits
