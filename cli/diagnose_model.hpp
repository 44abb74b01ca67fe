#pragma once

#include "cli/diagnose.hpp"
#include "cli/session.hpp"

#include <CLI/CLI.hpp>
#include <functional>

namespace slipmode::cli {

/// What `slipmode diagnose SCENE.toml` does once the command line has been parsed.
using ModelDiagnosis = std::function<Report(const Session&, const DiagnoseRequest&)>;

/// Adds the options for models to the verb, MODELS as positionals among them, and hands back what runs when INPUT is a
/// scene: exponents from the tangent flow, the table of verdicts, or exponents over a key.
[[nodiscard]] ModelDiagnosis add_model_diagnosis(CLI::App& command);

}  // namespace slipmode::cli
