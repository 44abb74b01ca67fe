#include "cli/diagnose.hpp"

#include <slipmode/results/series_input.hpp>
#include <slipmode/results/series_store.hpp>
#include "cli/diagnose_model.hpp"
#include "cli/field_options.hpp"
#include "cli/series_findings.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <filesystem>

namespace slipmode::cli {
namespace {

struct DiagnoseArguments {
  DiagnoseRequest request;
  results::SeriesRequest series;
  diagnostics::StudyOptions study;
  std::vector<std::string> tools;
  std::string unit = "bits";
};

/// What makes the numbers doubtful, and what to use instead.
std::vector<std::string> warnings_of(const diagnostics::SeriesStudy& study, const results::SeriesInput& input) {
  if (!study.smoothness || !study.smoothness->doubtful) return {};
  std::string text = fmt::format(
      "the record is not smooth: {:.3g} % of it in flat stretches, {:.2g} kinks per mean period, as stick and slip "
      "make; "
      "embedding and all that builds on it are doubtful.",
      100.0 * study.smoothness->flat_share, study.smoothness->kinks_per_period);
  text += input.smoother.empty() ? " Take a channel far from the contacts, a velocity rather than a force"
                                 : fmt::format(" Take the channel farthest from the contacts: {}", input.smoother);
  return {text};
}

Report diagnosis_report(const std::shared_ptr<const diagnostics::SeriesStudy>& kept, const results::SeriesInput& input,
                        const DiagnoseArguments& arguments) {
  const diagnostics::SeriesStudy& study = *kept;
  const std::vector<diagnostics::Finding> findings = diagnostics::findings_of(study, arguments.request.bits);
  const std::vector<std::string> warnings = warnings_of(study, input);
  Report report;
  report.data = {{"verb", "diagnose"}, {"series", study.series.name}, {"what", input.what}};
  report.text = fmt::format("{}: {}\n", study.series.name, input.what);
  if (study.verdict) {
    report.data["verdict"] = diagnostics::to_string(study.verdict->motion);
    report.data["reason"] = study.verdict->reason;
    report.text +=
        fmt::format("Verdict: {}: {}\n", diagnostics::to_string(study.verdict->motion), study.verdict->reason);
  }
  report.data["findings"] = findings_json(findings);
  report.data["warnings"] = warnings;
  report.text += findings_text(findings);
  for (const std::string& warning : warnings) report.text += fmt::format("Warning: {}\n", warning);
  Json not_run = Json::array();
  for (const diagnostics::ToolFailure& failure : study.failures) {
    not_run.push_back({{"tool", diagnostics::to_string(failure.tool)}, {"reason", failure.reason}});
    report.text += fmt::format("No {}: {}\n", diagnostics::to_string(failure.tool), failure.reason);
  }
  report.data["not_run"] = not_run;
  const std::string file = diagnosis_file(arguments.request);
  if (file.empty()) return report;
  results::content_of(kept, input, arguments.request.bits).save(file);
  tell_file("Numbers and curves", file, report);
  draw_diagnosis(arguments.request, file, report);
  return report;
}

Report diagnose_series(const Session& session, DiagnoseArguments arguments) {
  arguments.study.tools = diagnostics::series_tools(arguments.tools);
  check_diagnosis_outputs(arguments.request);
  const results::SeriesInput input = results::read_series(arguments.request.input, arguments.series);
  if (!arguments.study.strobe) arguments.study.strobe = input.drive_period;
  if (session.seed) arguments.study.seed = *session.seed;
  arguments.study.run = session.run_options().parallel("diagnose");
  return diagnosis_report(
      std::make_shared<const diagnostics::SeriesStudy>(diagnostics::study_series(input.series, arguments.study)), input,
      arguments);
}

void add_record_options(CLI::App& command, DiagnoseArguments& arguments) {
  constexpr const char* kGroup = "Record";
  command.add_option("--time", arguments.series.time, "column or dataset with the instants, when not called time")
      ->group(kGroup);
  add_fields(command, arguments.series, kGroup);
}

void add_tool_options(CLI::App& command, DiagnoseArguments& arguments) {
  constexpr const char* kGroup = "Tools";
  diagnostics::StudyOptions& study = arguments.study;
  command.add_option("--tools", arguments.tools, "only these, e.g. information,wolf; all without")
      ->delimiter(',')
      ->group(kGroup);
  command.add_option("--unit", arguments.unit, "of exponents and information: bits or nats")
      ->check(CLI::IsMember({"bits", "nats"}))
      ->group(kGroup);
  command.add_option("--bins", study.bins, "of equal width for mutual information, e.g. 5,10,20")
      ->delimiter(',')
      ->check(CLI::Range(2, 1000))
      ->group(kGroup);
  add_fields(command, study, kGroup);
}

/// Options that only a model has: those the verb got from `begin` up to `end`.
struct ModelOptions {
  std::size_t begin, end;
};

void refuse_model_options(const CLI::App& command, const ModelOptions& of_models) {
  const auto options = command.get_options();
  for (std::size_t k = of_models.begin; k < of_models.end; ++k) {
    if (options[k]->count() == 0) continue;
    throw InvalidInput(fmt::format("{}: for models only; INPUT is then a scene (.toml)", options[k]->get_name()));
  }
}

}  // namespace

Verb add_diagnose(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "diagnose", "what a record or a model is: periodic, quasi-periodic, chaotic; exponents, dimensions");
  const auto arguments = std::make_shared<DiagnoseArguments>();
  command
      ->add_option("INPUT", arguments->request.input,
                   "a record: FILE or FILE:SERIES, a result file (HDF5) or CSV with a header; or a scene (.toml)")
      ->required();
  command->add_option("-o,--output", arguments->request.output, "also store numbers and curves (HDF5)");
  command->add_option("--figures", arguments->request.figures, "folder for all figures, svg and png");
  add_record_options(*command, *arguments);
  add_tool_options(*command, *arguments);
  command->footer(
      "Example:\n  slipmode diagnose run.h5                    # the velocity farthest from the contacts\n"
      "  slipmode diagnose run.h5:v/3 --unit nats -o v3.h5 --figures v3\n"
      "  slipmode diagnose lorenz.csv:x --to 500 --tools information,false-neighbours\n"
      "  slipmode diagnose henon.csv --interval 1");
  const std::size_t begin = command->get_options().size();
  const ModelDiagnosis diagnose_model = add_model_diagnosis(*command);
  const ModelOptions of_models{begin, command->get_options().size()};
  const auto run = [command, arguments, of_models, diagnose_model](const Session& session) {
    arguments->request.bits = arguments->unit == "bits";
    if (std::filesystem::path(arguments->request.input).extension() == ".toml") {
      return diagnose_model(session, arguments->request);
    }
    refuse_model_options(*command, of_models);
    session.refuse_overrides(arguments->request.input, "it is a record; give a scene (.toml) with it");
    if (session.is_divided())
      throw InvalidInput(session.divided_by() + ": for a scene with --over; a record is one piece");
    return diagnose_series(session, *arguments);
  };
  return {.command = command, .run = run, .divides = true};
}

}  // namespace slipmode::cli
