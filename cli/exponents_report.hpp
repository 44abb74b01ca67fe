#pragma once

#include <slipmode/results/exponents_store.hpp>
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// Side by side as a table for a terminal, with what they add up to. @param bits  rather than nats
/// @param units  of their scene
[[nodiscard]] std::string exponents_text(const std::vector<results::ModelExponents>& models, bool bits,
                                         const results::Units& units);
/// A number; infinities as words, NaN as null: JSON has none of them.
[[nodiscard]] Json exponent_json(double value);
[[nodiscard]] Json exponents_json(const std::vector<results::ModelExponents>& models);

/// One row for every figure, models side by side, each ± half the difference between the halves of its data.
[[nodiscard]] std::string verdict_text(const diagnostics::VerdictTable& verdict, bool bits);
[[nodiscard]] Json verdict_json(const diagnostics::VerdictTable& verdict);

}  // namespace slipmode::cli
