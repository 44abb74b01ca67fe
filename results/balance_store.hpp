#pragma once

#include <slipmode/orbits/mixed/certificate.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kBalanceGroup = "balance";
inline constexpr const char* kMixedGroup = "mixed";

/// Writes the group `balance`: its numbers, a table of coefficients, one row per order, and the orders tried.
/// @param certificate  or null: its verdict and errors
void store_balance(StoreWriter& store, const orbits::Balance& balance, const orbits::Certificate* certificate,
                   const std::vector<orbits::OrderTrial>& trials, const Units& units);

/// Writes the group `mixed`: its numbers, what it held in the time domain, and the orders tried.
/// @param near  names of its degrees of freedom near the contacts
void store_mixed(StoreWriter& store, const orbits::MixedOrbit& mixed, const std::vector<std::string>& near,
                 const orbits::Certificate& certificate, const std::vector<orbits::OrderTrial>& trials,
                 const Units& units);

/// Displacements of the contacts and Ω, as figures need them.
struct StoredBalance {
  double omega = 0.0;
  std::vector<orbits::Harmonics> displacement;
  Table trials;
};
/// @throws InvalidInput  when the file holds no balance, or a damaged one
[[nodiscard]] StoredBalance load_balance(const StoreReader& store);

}  // namespace slipmode::results
