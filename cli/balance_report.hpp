#pragma once

#include <slipmode/studies/balance_search.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace slipmode::cli {

/// What `--by balance` adds to `orbit find` and `orbit continue`.
struct BalanceArguments {
  std::string by = "shooting";
  std::optional<std::string> harmonics, samples;  ///< else 9, exact
  std::optional<double> error;
  bool certify = false;

  bool operator==(const BalanceArguments&) const = default;
};

void add_balance_options(CLI::App& command, BalanceArguments& out_arguments);

/// @throws InvalidInput  for options of a balance without one
void require_no_balance_options(const BalanceArguments& arguments);

/// The search. @param start  settle (the default), contact or gap
/// @throws InvalidInput  for words that are no numbers, auto without --error
[[nodiscard]] studies::BalanceSearch balance_search_of(const BalanceArguments& arguments, const std::string& start,
                                                       const studies::OrbitSearch& search);

/// What was found, with how it ended. @param verb  that asked
[[nodiscard]] Report balance_report(const std::string& verb, const studies::Family& model,
                                    const studies::BalanceFound& found);

}  // namespace slipmode::cli
