#include <slipmode/trade/pareto.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace slipmode::trade {

namespace {

/// The least of the offers let through, by a key that can be ordered; the first of equal ones.
template <class Allow, class Key>
std::optional<std::size_t> least(std::span<const Offer> offers, const Allow& allow, const Key& key) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (!offers[i].known() || !allow(offers[i])) continue;
    if (!found || key(offers[i]) < key(offers[*found])) found = i;
  }
  return found;
}

constexpr auto kAny = [](const Offer&) { return true; };
constexpr auto kByCost = [](const Offer& offer) { return std::tuple(offer.cost, offer.resolved()); };
constexpr auto kByError = [](const Offer& offer) { return std::tuple(offer.resolved(), offer.cost); };

}  // namespace

bool Offer::known() const { return std::isfinite(cost) && std::isfinite(error) && !std::isnan(noise); }

std::vector<std::size_t> pareto_front(std::span<const Offer> offers) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (offers[i].known()) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return kByCost(offers[i]); });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(offers[i].resolved() < best)) continue;
    best = offers[i].resolved();
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> cheapest_within_error(std::span<const Offer> offers, double limit) {
  return least(
      offers, [limit](const Offer& offer) { return offer.assured() <= limit; }, kByCost);
}

std::optional<std::size_t> best_within_budget(std::span<const Offer> offers, double budget) {
  return least(
      offers, [budget](const Offer& offer) { return offer.cost <= budget; }, kByError);
}

std::optional<std::size_t> cheapest(std::span<const Offer> offers) { return least(offers, kAny, kByCost); }

std::optional<std::size_t> most_accurate(std::span<const Offer> offers) { return least(offers, kAny, kByError); }

}  // namespace slipmode::trade
