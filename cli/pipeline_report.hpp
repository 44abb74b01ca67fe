#pragma once

#include <slipmode/studies/pipeline.hpp>
#include "cli/session.hpp"

#include <string>

namespace slipmode::cli {

/// Summary of a pipeline for programs and for people.
[[nodiscard]] Json to_json(const studies::PipelineResult& result, const scene::Scene& scene);
[[nodiscard]] std::string summary_text(const studies::PipelineResult& result, const scene::Scene& scene);

}  // namespace slipmode::cli
