#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slipmode::diagnostics {

/// Between which two of many radii a distance lies: shell k holds the distances above k of the radii.
///
/// Found by one look-up instead of a search. The bits of a double that is not negative, read as an integer, rise with
/// it; their leading ones are the entry of a table so fine that as a rule one radius at most shares an entry. That
/// radius is compared with, so that the answer is exact.
class Shells {
 public:
  /// @param radii  ascending, finite, ≥ 0, at least one; for squares of distances their squares
  /// @throws InvalidInput  otherwise
  explicit Shells(std::span<const double> radii);

  /// One more than there are radii.
  [[nodiscard]] std::size_t count() const { return edges_.size(); }

  /// Number of radii below the distance. @param distance  ≥ 0, infinity included
  [[nodiscard]] std::size_t of(double distance) const { return in_entry(entry(distance), distance); }

  /// Adds n distances to out_counts, one count per shell. @param scratch  n entries @param out_counts  4 per shell, to
  /// be summed: a count that was just written is not read again at once
  void add(const double* distances, std::size_t n, std::uint32_t* scratch, std::int64_t* out_counts) const;

 private:
  [[nodiscard]] std::uint32_t entry(double distance) const {
    double inside = distance < low_ ? low_ : distance;
    inside = inside > high_ ? high_ : inside;
    return static_cast<std::uint32_t>((std::bit_cast<std::int64_t>(inside) >> shift_) - base_);
  }
  [[nodiscard]] std::uint32_t in_entry(std::uint32_t entry, double distance) const {
    std::uint32_t shell = first_[entry];
    for (std::uint32_t k = 0; k < most_in_entry_; ++k) shell += distance > edges_[shell] ? 1 : 0;
    return shell;
  }

  std::vector<double> edges_;         // the radii, then infinity
  std::vector<std::uint32_t> first_;  // per entry: radii below all its numbers
  double low_, high_;                 // numbers beyond these share the first and the last entry
  int shift_ = 0;
  std::int64_t base_ = 0;
  std::uint32_t most_in_entry_ = 0;  // radii in one entry
};

}  // namespace slipmode::diagnostics
