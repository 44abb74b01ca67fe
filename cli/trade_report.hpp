#pragma once

#include "cli/session.hpp"
#include "results/store.hpp"
#include "trade/advice.hpp"
#include "trade/effects.hpp"
#include "trade/study.hpp"

#include <string>
#include <vector>

namespace slipmode::cli {

inline constexpr const char* kTradeGroup = "trade";

/// Writes the group `trade`: a table `candidates`, the reference, its scatter and how long everything ran.
void store_study(results::StoreWriter& writer, const trade::Study& study, const scene::Scene& scene);

/// One sentence per measure, for the same limit [%].
[[nodiscard]] std::vector<std::string> recommendations(const trade::Study& study, double limit);

[[nodiscard]] Json to_json(const trade::Study& study, const scene::Scene& scene);
/// The table for a terminal.
[[nodiscard]] std::string study_text(const trade::Study& study, const scene::Scene& scene);

}  // namespace slipmode::cli
