#pragma once

#include <slipmode/trade/advice.hpp>
#include <slipmode/trade/orbit_methods.hpp>
#include <slipmode/trade/study.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

[[nodiscard]] Json to_json(const trade::Study& study, const scene::Scene& scene);
/// The table for a terminal.
[[nodiscard]] std::string study_text(const trade::Study& study, const scene::Scene& scene);

[[nodiscard]] Json to_json(const trade::OrbitStudy& study);
[[nodiscard]] std::string orbits_text(const trade::OrbitStudy& study);

/// Why rows have no errors; empty where all have.
[[nodiscard]] std::string failures_text(const trade::Study& study);

/// How a written scene is run, or its reduced model.
[[nodiscard]] std::string how_to_run(const trade::Variant& variant, const std::string& path);

}  // namespace slipmode::cli
