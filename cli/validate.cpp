#include <slipmode/diagnostics/validation/validate.hpp>
#include "cli/validation_report.hpp"

#include <slipmode/results/records.hpp>
#include <slipmode/results/validation_store.hpp>
#include <slipmode/scene/own_times.hpp>
#include "cli/shaken_bases.hpp"
#include "cli/shaken_model.hpp"
#include "cli/shaken_validation.hpp"
#include "cli/steps.hpp"
#include "cli/validate_run.hpp"
#include "cli/validation_setup.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct ValidateArguments {
  std::string scene, input, output;
  bool no_sweep = false, verdict = false;
};

Report run_shaken(const Session& session, const ValidateArguments& arguments, scene::Scene scene,
                  const dynamics::HybridSystem& full) {
  if (arguments.no_sweep) scene.shaken.frequencies.reset();
  const auto candidates = load_shaken_candidates(scene, full, arguments.input);
  if (results::StoreReader(arguments.input).has(results::kReducedGroup)) {  // its own size is the one to judge
    scene.shaken.modes = {static_cast<int>(candidates.front().basis.modes())};
  }
  const auto result = validate_shaken_into(session, scene, candidates, arguments.output);
  Report report;
  report.data = {{"verb", "validate"}, {"file", arguments.output}, {"validation", to_json(result)}};
  report.text = fmt::format("{}Validation: {}\n", summary_text(result, scene), arguments.output);
  return report;
}

Report run(const Session& session, const ValidateArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  refuse_force(scene, "validate");
  const dynamics::HybridSystem full = scene::build_system(scene);
  if (is_shaken(scene)) {
    if (arguments.verdict)
      throw InvalidInput(
          "--verdict: expected a belt, found a shaker; there 'slipmode diagnose SCENE FILE --verdict' does it");
    return run_shaken(session, arguments, scene, full);
  }
  const auto candidates = load_candidates(scene, full.structure(), arguments.input);
  diagnostics::ValidationOptions options = validation_options(scene, candidates);
  if (arguments.no_sweep) options.sweep_values.clear();
  if (arguments.verdict) options.verdict = verdict_options(scene);
  const diagnostics::ValidationReport result =
      validate_into(session, scene, full, candidates, options, arguments.output);

  Report report;
  report.data = {{"verb", "validate"}, {"file", arguments.output}, {"validation", to_json(result)}};
  report.text = fmt::format("{}Validation: {}\n", summary_text(result), arguments.output);
  return report;
}

}  // namespace

Verb add_validate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("validate", "compare reduced models with the full one");
  const auto arguments = std::make_shared<ValidateArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command
      ->add_option("FILE", arguments->input,
                   "what to judge: a POD or an ensemble (POMs and LNMs of every size), or a reduced model")
      ->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_flag("--no-sweep", arguments->no_sweep,
                    "leave the bifurcation diagram out; under a shaker: the drive's own frequency only");
  command->add_flag("--verdict", arguments->verdict,
                    "also exponents, dimensions, delay, embedding, spectrum, stick of full and reduced side by side");
  command->footer("Example:\n  slipmode validate datasets/chain10/scene.toml pod.h5 -o validation.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
