#include <slipmode/diagnostics/validation/validate.hpp>
#include "cli/validation_report.hpp"

#include <slipmode/results/records.hpp>
#include <slipmode/results/validation_store.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/scene/solver_options.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/validation.hpp>
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct ValidateArguments {
  std::string scene, input, output;
  bool no_sweep = false, verdict = false;
};

/// @param is_reduced  the bases are a reduced model's: its own size is the one to judge
Report run_shaken(const Session& session, const ValidateArguments& arguments, scene::Scene scene,
                  const std::vector<pod::NamedBasis>& bases, bool is_reduced) {
  if (arguments.no_sweep) scene.shaken.frequencies.reset();
  if (is_reduced) scene.shaken.modes = {static_cast<int>(bases.front().basis.modes())};
  const auto result = studies::validate_shaken(scene, bases, arguments.output, session.run_options());
  Report report;
  report.data = {{"verb", "validate"}, {"file", arguments.output}, {"validation", to_json(result)}};
  report.text = fmt::format("{}Validation: {}\n", summary_text(result, scene), arguments.output);
  return report;
}

Report run(const Session& session, const ValidateArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = scene::with_own_times(session.load(arguments.scene));
  scene::refuse_force(scene, "validate");
  const results::StoreReader store(arguments.input);
  const std::vector<pod::NamedBasis> bases = studies::load_bases(scene, scene::build_system(scene), store);
  if (is_shaken(scene)) {
    if (arguments.verdict)
      throw InvalidInput(
          "--verdict: expected a belt, found a shaker; there 'slipmode diagnose SCENE FILE --verdict' does it");
    const bool is_reduced = results::kind_of(store) == results::FileKind::kReduced;
    return run_shaken(session, arguments, scene, bases, is_reduced);
  }
  diagnostics::ValidationOptions options = studies::validation_options(scene, bases);
  if (arguments.no_sweep) options.sweep_values.clear();
  if (arguments.verdict) options.verdict = scene::verdict_options(scene);
  const diagnostics::ValidationReport result =
      studies::validate(scene, bases, options, arguments.output, session.run_options());

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
