#pragma once

#include "cli/session.hpp"
#include "diagnostics/verdict.hpp"
#include "results/store.hpp"
#include "results/units.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

inline constexpr const char* kExponentsGroup = "exponents";
inline constexpr const char* kVerdictGroup = "verdict";

/// A model's exponents, or why there are none.
struct ModelExponents {
  std::string name;
  diagnostics::LyapunovSpectrum spectrum;
  std::string failure;
};

/// Writes `exponents/<i>` for every model: values with errors, their history, rates per interval, balance of volumes.
void store_exponents(results::StoreWriter& writer, const std::vector<ModelExponents>& models,
                     const results::Units& units);
/// Side by side as a table for a terminal, with what they add up to. @param bits  rather than nats
[[nodiscard]] std::string exponents_text(const std::vector<ModelExponents>& models, bool bits);
/// A number; infinities as words, NaN as null: JSON has none of them.
[[nodiscard]] Json exponent_json(double value);
[[nodiscard]] Json exponents_json(const std::vector<ModelExponents>& models);

/// Writes the table `verdict`, a row for every figure of every model.
void store_verdict(results::StoreWriter& writer, const diagnostics::VerdictTable& verdict, const results::Units& units);
/// One row for every figure, models side by side, each ± half the difference between the halves of its data.
[[nodiscard]] std::string verdict_text(const diagnostics::VerdictTable& verdict, bool bits);
[[nodiscard]] Json verdict_json(const diagnostics::VerdictTable& verdict);
/// The exponents of a table's models.
[[nodiscard]] std::vector<ModelExponents> exponents_of(const diagnostics::VerdictTable& verdict);

}  // namespace slipmode::cli
