#pragma once

#include <slipmode/diagnostics/validation/verdict.hpp>
#include <slipmode/results/store.hpp>
#include <slipmode/results/units.hpp>

#include <string>
#include <vector>

namespace slipmode::results {

inline constexpr const char* kExponentsGroup = "exponents";
inline constexpr const char* kVerdictGroup = "verdict";

/// A model's exponents, or why there are none.
struct ModelExponents {
  std::string name;
  diagnostics::LyapunovSpectrum spectrum;
  std::string failure;
};

/// Writes `exponents/<i>` for every model: values with errors, their history, rates per interval, balance of volumes.
void store_exponents(StoreWriter& writer, const std::vector<ModelExponents>& models, const Units& units);
/// Writes the table `verdict`, a row for every figure of every model.
void store_verdict(StoreWriter& writer, const diagnostics::VerdictTable& verdict, const Units& units);
/// The exponents of a table's models.
[[nodiscard]] std::vector<ModelExponents> exponents_of(const diagnostics::VerdictTable& verdict);

/// A line of the verdict.
struct VerdictRow {
  std::string name, unit;
  std::vector<diagnostics::Halved> values;  ///< one per model
};
[[nodiscard]] std::vector<VerdictRow> verdict_rows(const diagnostics::VerdictTable& verdict, double unit,
                                                   const std::string& unit_name);

}  // namespace slipmode::results
