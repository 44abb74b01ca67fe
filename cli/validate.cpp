#include <slipmode/diagnostics/validation/validate.hpp>
#include "cli/validation_report.hpp"

#include <slipmode/studies/validation.hpp>
#include "cli/times_report.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>

namespace slipmode::cli {
namespace {

struct ValidateArguments {
  std::string scene, input, output;
  bool no_sweep = false, verdict = false;
};

Report run(const Session& session, const ValidateArguments& arguments) {
  require_writable(arguments.output);
  const studies::Validation done =
      studies::validate(session.load(arguments.scene), results::StoreReader(arguments.input),
                        {.sweep = !arguments.no_sweep, .verdict = arguments.verdict}, arguments.output,
                        session.run_options(), session.division());
  if (session.has_a_share()) return part_made(session, done.values, arguments.output, "values");
  Report report;
  report.data = {{"verb", "validate"},
                 {"file", arguments.output},
                 {"validation", done.belt ? to_json(*done.belt) : to_json(*done.driven)}};
  report.text = done.belt ? summary_text(*done.belt, results::Units::of(done.scene.units))
                          : summary_text(*done.driven, done.scene);
  tell_without_slips(done.scene, report);
  tell_chosen_times(done.scene, {"validation"}, report);
  tell_resumed(session, done.values.resumed, "values", report);
  report.text += fmt::format("Validation: {}\n", arguments.output);
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
                    "leave the bifurcation diagram out; under a shaker or a force: at the drive's own frequency only");
  command->add_flag("--verdict", arguments->verdict,
                    "also exponents, dimensions, delay, embedding, spectrum, stick of full and reduced side by side");
  command->footer("Example:\n  slipmode validate datasets/chain10/scene.toml pod.h5 -o validation.h5");
  return {.command = command,
          .run = [arguments](const Session& session) { return run(session, *arguments); },
          .divides = true};
}

}  // namespace slipmode::cli
