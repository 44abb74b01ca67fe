#pragma once

#include <slipmode/orbits/spectrum.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kSpectrumGroup = "spectrum";

/// One quantity's coefficients and what it is called.
struct NamedHarmonics {
  std::string name;  ///< "displacement_1" of the first contact, "velocity_1", "force_1"; "q3", "v3" of the third row
  std::string unit, what;
  const orbits::Harmonics* harmonics;
};

/// All quantities of a spectrum. @param rows  what the rows asked for are called, e.g. "3"
[[nodiscard]] std::vector<NamedHarmonics> named(const orbits::Spectrum& spectrum, const std::vector<std::string>& rows,
                                                const Units& units);

/// One row per order, cosine and sine of every quantity as columns. @param all  at least one, of one order
[[nodiscard]] Table harmonics_table(const std::vector<NamedHarmonics>& all);
/// A quantity of such a table.
[[nodiscard]] orbits::Harmonics harmonics_of(const Table& table, const std::string& name);

/// Writes the group `spectrum`: its numbers and the table. @param all  its quantities
void store_spectrum(StoreWriter& store, const orbits::Spectrum& spectrum, const std::vector<NamedHarmonics>& all);

/// That table. @throws InvalidInput  when the file holds no spectrum
[[nodiscard]] Table load_spectrum(const StoreReader& store);

}  // namespace slipmode::results
