#include "cli/diagnose_model.hpp"
#include "cli/exponents_report.hpp"
#include "cli/field_options.hpp"

#include <slipmode/scene/own_times.hpp>
#include "cli/diagnose_sweep.hpp"

#include <fmt/format.h>
#include <memory>

namespace slipmode::cli {
namespace {

Report diagnose_scene(const Session& session, const DiagnoseRequest& request, const ModelRequest& models) {
  const scene::Scene scene = scene::with_own_times(session.load(request.input));
  check_diagnosis_outputs(request);
  if (!models.over.empty()) {
    if (models.verdict) throw InvalidInput("--verdict and --over: expected one of them");
    DiagnoseRequest with_file = request;
    with_file.output = diagnosis_file(request);
    Report report = diagnose_over(session, scene, with_file, models);
    if (!session.shard) draw_diagnosis(request, with_file.output, report);
    return report;
  }
  if (session.is_divided())
    throw InvalidInput(session.divided_by() + ": values of a key are divided; give one with --over");
  const studies::Subjects subjects = studies::subjects_of(scene, models.stores(), models.modes);
  const auto found = std::make_shared<const studies::ModelDiagnosis>(
      studies::diagnose_models(scene, subjects, models.exponents, models.verdict, session.run_options()));
  const std::vector<results::ModelExponents>& spectra = found->exponents;
  const std::optional<diagnostics::VerdictTable>& verdict = found->verdict;

  Report report;
  report.data = {{"verb", "diagnose"}, {"scene", request.input}, {"exponents", exponents_json(spectra)}};
  report.text = exponents_text(spectra, request.bits, results::Units::of(scene.units));
  if (verdict) {
    report.data["verdict"] = verdict_json(*verdict);
    report.text += verdict_text(*verdict, request.bits);
  }
  const std::string file = diagnosis_file(request);
  if (file.empty()) return report;
  studies::content_of(scene, found).save(file);
  tell_file("Numbers and histories", file, report);
  draw_diagnosis(request, file, report);
  return report;
}

}  // namespace

ModelDiagnosis add_model_diagnosis(CLI::App& command) {
  constexpr const char* kGroup = "Of a model (INPUT is a scene, .toml)";
  const auto models = std::make_shared<ModelRequest>();
  command
      .add_option("MODELS", models->files,
                  "of a scene: reduced models beside the full one; a POD, an ensemble, or a "
                  "result of 'slipmode reduce' each")
      ->group(kGroup);
  command
      .add_flag("--verdict", models->verdict,
                "one table: exponents, dimensions, delay, embedding, spectrum, stick, full and reduced side by side")
      ->group(kGroup);
  command.add_option("--modes", models->modes, "of MODELS; else as [reduction] chooses")
      ->check(within(kCount, true))
      ->group(kGroup);
  add_fields(command, models->exponents, kGroup);
  command.add_option("--over", models->over, "exponents against a key: KEY=FROM:TO:STEP")->group(kGroup);
  command.add_flag("--follow", models->follow, "with --over: start each value where the one before it ended")
      ->group(kGroup);
  return [models](const Session& session, const DiagnoseRequest& request) {
    return diagnose_scene(session, request, *models);
  };
}

}  // namespace slipmode::cli
