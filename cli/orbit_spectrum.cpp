#include <slipmode/results/provenance.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/orbit_spectra.hpp>
#include "cli/field_options.hpp"
#include "cli/json_values.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::cli {
namespace {

struct OrbitSpectrumArguments {
  std::string orbit, output;
  std::string model = "full";
  studies::SpectrumRequest request;
};

Report run(const Session& session, const OrbitSpectrumArguments& arguments) {
  constexpr std::size_t kShown = 9;  // columns of the table: three contacts
  if (!arguments.output.empty()) require_writable(arguments.output);
  const results::StoreReader store(arguments.orbit);
  require_kind(store, std::array{results::FileKind::kOrbit});
  const scene::Scene scene = results::load_scene_of(store);
  const studies::Family model(scene, {}, studies::model_basis(scene, arguments.model, session.run_options()));
  session.run_options().check_interrupt();
  const auto found = studies::orbit_spectrum(model, store, arguments.request);
  const orbits::Spectrum& spectrum = found->spectrum;
  Report report;
  report.data =
      merged({{"verb", "orbit spectrum"}, {"title", scene.title}, {"model", model.title()}}, fields_json(spectrum));
  std::vector<std::string> header = {"order"};
  std::vector<Eigen::VectorXd> amplitudes;
  Json quantities = Json::array();
  for (const results::NamedHarmonics& own : found->quantities) {
    quantities.push_back(merged({{"name", own.name}}, harmonics_json(*own.harmonics)));
    if (amplitudes.size() == kShown) continue;
    header.push_back(own.name);
    amplitudes.push_back(own.harmonics->amplitude());
  }
  report.data["quantities"] = quantities;
  TextTable table(header);
  for (Eigen::Index k = 0; k <= arguments.request.harmonics; ++k) {
    std::vector<std::string> row = {std::to_string(k)};
    for (const Eigen::VectorXd& own : amplitudes) row.push_back(fmt::format("{:.6e}", own[k]));
    table.add(std::move(row));
  }
  report.text = fmt::format(
      "{}, {}: amplitudes of the orbit's harmonics, order 1 at {:.10g} rad/s; error below {:.0e} "
      "of each quantity\n{}",
      scene.name(), model.title(), spectrum.omega, std::max(spectrum.defect, 1e-15), table.str());
  if (const std::size_t all = found->quantities.size(); all > kShown)
    report.text += fmt::format("{} of {} quantities; the others are in --json and in the file of -o\n", kShown, all);
  if (!arguments.output.empty()) {
    studies::content_of(model, found, arguments.request).save(arguments.output);
    tell_file("Spectrum", arguments.output, report);
  }
  return report;
}

}  // namespace

Verb add_orbit_spectrum(CLI::App& orbit) {
  CLI::App* command = orbit.add_subcommand("spectrum", "Fourier coefficients of an orbit that was found");
  const auto arguments = std::make_shared<OrbitSpectrumArguments>();
  command->add_option("ORBIT", arguments->orbit, "result of 'slipmode orbit find -o' (HDF5)")->required();
  add_fields(*command, arguments->request);
  command
      ->add_option("--dof", arguments->request.dofs,
                   "also displacement and velocity of these degrees of freedom, from 1")
      ->delimiter(',');
  command->add_option("--model", arguments->model, "the model the orbit was found with, as 'orbit find' has it");
  command->add_option("-o,--output", arguments->output, "also store the coefficients (HDF5)");
  command->footer(
      "Orders count from the orbit's own period. Coefficients are those of the exact orbit: nothing is sampled or cut "
      "off.\nExample:\n  slipmode orbit spectrum orbit.h5 --harmonics 49 -o spectrum.h5\n"
      "  slipmode plot spectrum.h5 -o spectrum.svg");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
