#pragma once

#include <slipmode/studies/balance_search.hpp>
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace slipmode::cli {

/// What `--by balance` and `--by mixed` add to `orbit find`, the first to `orbit continue` too.
struct BalanceArguments {
  std::string by = "shooting";
  studies::BalanceWords words;
};

/// @param ways  words of --by
void add_balance_options(CLI::App& command, BalanceArguments& out_arguments, const std::vector<std::string>& ways);

/// @throws InvalidInput  for options of a balance or a mixed orbit without one
void require_no_balance_options(const BalanceArguments& arguments);

/// A mixed orbit, the same.
[[nodiscard]] Report mixed_report(const studies::Family& model, const studies::MixedFound& found);

/// What was found, with how it ended. @param verb  that asked
[[nodiscard]] Report balance_report(const std::string& verb, const studies::Family& model,
                                    const studies::BalanceFound& found);

}  // namespace slipmode::cli
