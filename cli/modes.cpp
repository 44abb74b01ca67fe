#include "fem/modes.hpp"
#include "cli/text_table.hpp"
#include "cli/units.hpp"
#include "cli/verbs.hpp"
#include "core/errors.hpp"
#include "scene/provenance.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::cli {
namespace {

struct Arguments {
  std::string scene, output;
  Eigen::Index count = 0;
};

struct ModeSets {
  fem::Modes slipping, sticking;
};

/// Directions of all contacts, one per column.
Eigen::MatrixXd contact_directions(const dynamics::HybridSystem& system) {
  Eigen::MatrixXd w(system.size(), static_cast<Eigen::Index>(system.contacts().size()));
  for (Eigen::Index c = 0; c < w.cols(); ++c) w.col(c) = system.contacts()[c].direction;
  return w;
}

ModeSets compute(const dynamics::HybridSystem& system, Eigen::Index count) {
  const Eigen::MatrixXd w = contact_directions(system);
  const Eigen::Index free = system.size() - w.cols();
  ModeSets sets{.slipping = fem::natural_modes(system.structure(), count), .sticking = {}};
  if (free > 0 && w.cols() > 0) {
    sets.sticking = fem::constrained_modes(system.structure(), w, std::min(count, free));
  }
  return sets;
}

/// ζ = (α/ω + β ω)/2; NaN for a rigid-body mode or damping that is not proportional.
double damping_ratio(const fem::Structure& structure, double omega) {
  const auto rayleigh = structure.rayleigh();
  if (!rayleigh || omega == 0.0) return std::nan("");
  return 0.5 * (rayleigh->mass / omega + rayleigh->stiffness * omega);
}

void store(const std::filesystem::path& path, const scene::Scene& scene, const ModeSets& sets) {
  const Units units = Units::of(scene.units);
  scene::StoreWriter writer(path);
  scene::save(writer, scene::provenance_of(scene, "slipmode modes"));
  const auto write = [&](const std::string& group, const fem::Modes& modes, const std::string& what) {
    writer.describe_group(group, what);
    writer.write(group + "/omega", modes.omega, {units.angular, "circular frequencies, ascending"});
    writer.write(group + "/shapes", modes.shapes, {"1", "mass-normalised shapes, dof x mode"});
  };
  write("modes/slipping", sets.slipping, "natural modes with every contact slipping");
  if (sets.sticking.omega.size() > 0) write("modes/sticking", sets.sticking, "natural modes with every contact stuck");
  writer.commit();
}

Report run(const Session& session, const Arguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  const dynamics::HybridSystem system = scene::build_system(scene);
  if (arguments.count < 0 || arguments.count > system.size()) {
    throw InvalidInput(fmt::format("--count {}: expected 1..{} (the degrees of freedom), or 0 for the lowest 20",
                                   arguments.count, system.size()));
  }
  const Eigen::Index count = arguments.count == 0 ? std::min<Eigen::Index>(system.size(), 20) : arguments.count;
  const ModeSets sets = compute(system, count);

  Report report;
  const std::string unit = scene.units == "SI" ? " [rad/s]" : "";
  TextTable table(
      {"mode", "slipping ω" + unit, scene.units == "SI" ? "f [Hz]" : "f = ω/2π", "damping ratio", "sticking ω" + unit});
  for (Eigen::Index k = 0; k < sets.slipping.omega.size(); ++k) {
    const double omega = sets.slipping.omega[k];
    table.add({fmt::format("{}", k + 1), fmt::format("{:.8g}", omega),
               fmt::format("{:.8g}", omega / (2.0 * std::numbers::pi)),
               fmt::format("{:.4g}", damping_ratio(system.structure(), omega)),
               k < sets.sticking.omega.size() ? fmt::format("{:.8g}", sets.sticking.omega[k]) : "–"});
  }
  report.text = fmt::format("{}: {} degrees of freedom\n{}", scene.title, system.size(), table.str());

  const auto list = [](const Eigen::VectorXd& values) { return std::vector<double>(values.begin(), values.end()); };
  report.data = {{"verb", "modes"}, {"degrees_of_freedom", system.size()}, {"units", scene.units}};
  report.data["slipping"] = {{"omega", list(sets.slipping.omega)}};
  report.data["sticking"] = {{"omega", list(sets.sticking.omega)}};
  std::vector<double> ratios;
  for (const double omega : sets.slipping.omega) ratios.push_back(damping_ratio(system.structure(), omega));
  report.data["slipping"]["damping_ratio"] = ratios;
  if (!arguments.output.empty()) {
    store(arguments.output, scene, sets);
    report.data["file"] = arguments.output;
    report.text += fmt::format("Frequencies and shapes: {}\n", arguments.output);
  }
  return report;
}

}  // namespace

Verb add_modes(CLI::App& app) {
  CLI::App* command = app.add_subcommand("modes", "natural frequencies and mode shapes, slipping and sticking");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "also store frequencies and shapes (HDF5)");
  command->add_option("--count", arguments->count, "number of modes; 0: the lowest 20");
  command->footer("Example:\n  slipmode modes datasets/chain10/scene.toml --set structure.masses=40");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
