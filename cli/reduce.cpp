#include <slipmode/fem/modes.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/reduction.hpp>
#include "cli/field_options.hpp"
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <cmath>

namespace slipmode::cli {
namespace {

struct ReduceArguments {
  std::string scene, basis, output;
  Eigen::Index modes = 0;
};

Report run(const Session& session, const ReduceArguments& arguments) {
  require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  const dynamics::HybridSystem full = scene::build_system(scene);
  const pod::NamedBasis source = studies::load_basis(scene, full, arguments.basis);
  const auto reduction = std::make_shared<const studies::Reduction>(
      studies::reduce(scene, full, source, arguments.basis, arguments.modes));
  studies::content_of(scene, reduction).save(arguments.output);
  const Eigen::Index modes = reduction->model.basis.modes();

  const Eigen::VectorXd omega_full = fem::natural_modes(full.structure(), modes).omega;
  const Eigen::VectorXd omega_reduced = fem::natural_modes(reduction->model.system.structure()).omega;
  TextTable table({"mode", "ω full", "ω reduced"});
  for (Eigen::Index k = 0; k < modes; ++k) {
    table.add(
        {fmt::format("{}", k + 1), fmt::format("{:.8g}", omega_full[k]), fmt::format("{:.8g}", omega_reduced[k])});
  }
  Report report;
  report.data = {{"verb", "reduce"},
                 {"file", arguments.output},
                 {"modes", modes},
                 {"degrees_of_freedom", full.size()},
                 {"omega_full", std::vector<double>(omega_full.begin(), omega_full.end())},
                 {"omega_reduced", std::vector<double>(omega_reduced.begin(), omega_reduced.end())}};
  std::string energy;
  if (std::isfinite(reduction->captured)) {
    report.data["energy"] = reduction->captured;
    energy = fmt::format(", {:.3f} % of the energy", 100.0 * reduction->captured);
  }
  report.text = fmt::format("{} degrees of freedom reduced to {} modes ({}){}\n{}Reduced model: {}\n", full.size(),
                            modes, source.name, energy, table.str(), arguments.output);
  return report;
}

}  // namespace

Verb add_reduce(CLI::App& app) {
  CLI::App* command = app.add_subcommand("reduce", "project a scene's model on a basis");
  const auto arguments = std::make_shared<ReduceArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command
      ->add_option("BASIS", arguments->basis,
                   "result of 'slipmode pod', or the word lnm, under a shaker also lnm+static")
      ->required();
  command->add_option("-o,--output", arguments->output, "result file (HDF5)")->required();
  command->add_option("--modes", arguments->modes, "number of modes; 0: as [reduction] says")
      ->check(within(kFromZero, true));
  command->footer("Example:\n  slipmode reduce datasets/chain10/scene.toml pod.h5 --modes 6 -o rom6.h5");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
