#pragma once

#include <slipmode/results/shaken_modes.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// Tables of energies and of LNMs' shares (the form of S4 Tables 5.1 and 5.2), and the same as JSON.
[[nodiscard]] std::string text_of(const results::ShakenModes& modes);
[[nodiscard]] Json json_of(const results::ShakenModes& modes);

}  // namespace slipmode::cli
