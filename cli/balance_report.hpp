#pragma once

#include <slipmode/studies/balance_search.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <string>

namespace slipmode::cli {

/// What `--by balance` adds to `orbit find` and `orbit continue`.
struct BalanceArguments {
  std::string by = "shooting";
  studies::BalanceWords words;
};

void add_balance_options(CLI::App& command, BalanceArguments& out_arguments);

/// @throws InvalidInput  for options of a balance without one
void require_no_balance_options(const BalanceArguments& arguments);

/// What was found, with how it ended. @param verb  that asked
[[nodiscard]] Report balance_report(const std::string& verb, const studies::Family& model,
                                    const studies::BalanceFound& found);

}  // namespace slipmode::cli
