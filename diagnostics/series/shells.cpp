#include <slipmode/diagnostics/series/shells.hpp>

#include <slipmode/core/errors.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::diagnostics {

namespace {

constexpr int kMantissaBits = 52;
constexpr std::int64_t kMostEntries = 1 << 16;

}  // namespace

Shells::Shells(std::span<const double> radii) : edges_(radii.begin(), radii.end()) {
  if (edges_.empty() || !std::is_sorted(edges_.begin(), edges_.end()) || !(edges_.front() >= 0.0) ||
      !std::isfinite(edges_.back())) {
    throw InvalidInput(fmt::format(
        "counting by radius: expected at least one radius, all finite, not negative and ascending, found {}{}",
        edges_.size(), edges_.empty() ? "" : fmt::format(" from {} to {}", edges_.front(), edges_.back())));
  }
  low_ = std::abs(edges_.front());  // without the sign of −0, whose bits are those of a negative integer
  high_ = std::nextafter(edges_.back(), std::numeric_limits<double>::infinity());
  const auto first_bits = std::bit_cast<std::int64_t>(low_), last_bits = std::bit_cast<std::int64_t>(high_);
  const auto radii_below = [&](double value) { return std::lower_bound(edges_.begin(), edges_.end(), value); };
  for (int bits = 0; bits <= kMantissaBits; ++bits) {
    const int shift = kMantissaBits - bits;
    const std::int64_t base = first_bits >> shift, entries = (last_bits >> shift) - base + 1;
    if (entries > kMostEntries && bits > 0) break;  // equal radii share an entry however fine
    shift_ = shift;
    base_ = base;
    first_.resize(static_cast<std::size_t>(entries));
    most_in_entry_ = 0;
    for (std::int64_t k = 0; k < entries; ++k) {
      const auto begin = k == 0 ? edges_.begin() : radii_below(std::bit_cast<double>((base + k) << shift));
      const auto end = k + 1 == entries ? edges_.end() : radii_below(std::bit_cast<double>((base + k + 1) << shift));
      first_[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(begin - edges_.begin());
      most_in_entry_ = std::max(most_in_entry_, static_cast<std::uint32_t>(end - begin));
    }
    if (most_in_entry_ <= 1) break;
  }
  edges_.push_back(std::numeric_limits<double>::infinity());
}

void Shells::add(const double* distances, std::size_t n, std::uint32_t* scratch, std::int64_t* out_counts) const {
  for (std::size_t k = 0; k < n; ++k) scratch[k] = entry(distances[k]);
  if (most_in_entry_ == 1) {
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t shell = first_[scratch[k]];
      ++out_counts[4 * (shell + (distances[k] > edges_[shell] ? 1 : 0)) + (k & 3)];
    }
  } else {
    for (std::size_t k = 0; k < n; ++k) ++out_counts[4 * in_entry(scratch[k], distances[k]) + (k & 3)];
  }
}

}  // namespace slipmode::diagnostics
