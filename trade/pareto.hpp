#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace slipmode::trade {

/// What one configuration costs and how wrong it is, by one measure.
struct Offer {
  double cost = 0.0;   ///< time of one run [s]
  double error = 0.0;  ///< [%]
  double noise = 0.0;  ///< scatter of the error; a smaller one is not known to be smaller [%]

  /// What the error may be: a limit holds with its scatter, or it is not assured.
  [[nodiscard]] double assured() const { return error + noise; }
  /// The larger of error and noise: below its scatter an error is not known to be smaller than another.
  [[nodiscard]] double resolved() const { return error > noise ? error : noise; }
  /// False where cost or error is not a number: the configuration failed, or the measure says nothing about it.
  [[nodiscard]] bool known() const;
};

/// The offers that none other beats: no other one costs no more and has no larger resolved error, one of the two less.
/// By ascending cost; of equal offers the first. Offers that are not known are left out.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Offer> offers);

/// The cheapest offer that is assured to keep to `limit`; of equally cheap ones the better.
[[nodiscard]] std::optional<std::size_t> cheapest_within_error(std::span<const Offer> offers, double limit);

/// The offer with the least resolved error among those that cost at most `budget`; of equal ones the cheaper. Within
/// the noise none is better than another, so there the cheapest is taken.
[[nodiscard]] std::optional<std::size_t> best_within_budget(std::span<const Offer> offers, double budget);

/// The cheapest, and the one with the least resolved error, of all that are known.
[[nodiscard]] std::optional<std::size_t> cheapest(std::span<const Offer> offers);
[[nodiscard]] std::optional<std::size_t> most_accurate(std::span<const Offer> offers);

}  // namespace slipmode::trade
