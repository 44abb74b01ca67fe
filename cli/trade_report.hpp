#pragma once

#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/effects.hpp>
#include <slipmode/trade/study.hpp>
#include "cli/session.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

/// One sentence per measure, for the same limit [%].
[[nodiscard]] std::vector<std::string> recommendations(const trade::Study& study, double limit);

[[nodiscard]] Json to_json(const trade::Study& study, const scene::Scene& scene);
/// The table for a terminal.
[[nodiscard]] std::string study_text(const trade::Study& study, const scene::Scene& scene);

}  // namespace slipmode::cli
