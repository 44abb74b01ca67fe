#include <slipmode/fem/modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_modes.hpp>
#include <slipmode/studies/natural_modes.hpp>
#include "cli/text_table.hpp"
#include "cli/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace slipmode::cli {
namespace {

struct ModesArguments {
  std::string scene, output;
  Eigen::Index count = 0;
};

/// Damping ratios of the slipping structure's modes; NaN for rigid-body modes and where damping couples modes.
Eigen::VectorXd damping_ratios(const fem::Structure& structure, const fem::Modes& modes) {
  constexpr double kCoupled = 1e-6;  // of the largest entry
  Eigen::VectorXd ratios(modes.omega.size());
  if (const auto rayleigh = structure.rayleigh()) {  // ζ = (α/ω + β ω)/2
    for (Eigen::Index k = 0; k < ratios.size(); ++k) {
      const double omega = modes.omega[k];
      ratios[k] = omega == 0.0 ? std::nan("") : 0.5 * (rayleigh->mass / omega + rayleigh->stiffness * omega);
    }
    return ratios;
  }
  const Eigen::MatrixXd C = modes.shapes.transpose() * fem::multiply(structure.C(), modes.shapes);
  for (Eigen::Index k = 0; k < ratios.size(); ++k) {  // φᵀCφ = 2 ζ ω
    const double others = C.col(k).cwiseAbs().sum() + C.row(k).cwiseAbs().sum() - 2.0 * std::abs(C(k, k));
    const bool coupled = others > kCoupled * C.cwiseAbs().maxCoeff();
    ratios[k] = coupled || modes.omega[k] == 0.0 ? std::nan("") : C(k, k) / (2.0 * modes.omega[k]);
  }
  return ratios;
}

double hertz(double omega) { return omega / (2.0 * std::numbers::pi); }

std::string mode_table(const scene::Scene& scene, const studies::ModeSets& sets, const Eigen::VectorXd& ratios) {
  const std::string unit = scene.units == "SI" ? " [rad/s]" : "";
  const std::string hz = scene.units == "SI" ? "f [Hz]" : "f = ω/2π";
  const bool springs = sets.compliant.omega.size() > 0;
  std::vector<std::string> header = {"mode", "slipping ω" + unit, hz, "damping ratio", "sticking ω" + unit};
  if (scene.beam() != nullptr) header.emplace_back(hz);
  if (springs) header.emplace_back("held by springs " + hz);
  TextTable table(header);
  const auto cell = [](const Eigen::VectorXd& omega, Eigen::Index k, double scale) {
    return k < omega.size() ? fmt::format("{:.8g}", omega[k] * scale) : std::string("–");
  };
  for (Eigen::Index k = 0; k < sets.slipping.omega.size(); ++k) {
    std::vector<std::string> row = {
        fmt::format("{}", k + 1), cell(sets.slipping.omega, k, 1.0), cell(sets.slipping.omega, k, hertz(1.0)),
        std::isnan(ratios[k]) ? "–" : fmt::format("{:.4g}", ratios[k]), cell(sets.sticking.omega, k, 1.0)};
    if (scene.beam() != nullptr) row.push_back(cell(sets.sticking.omega, k, hertz(1.0)));
    if (springs) row.push_back(cell(sets.compliant.omega, k, hertz(1.0)));
    table.add(row);
  }
  const bool coupled = ratios.array().isNaN().any();
  return table.str() +
         (coupled ? "damping ratio –: damping couples this mode to others, or it is one of free motion\n" : "");
}

/// What shear and rotary inertia change, mode by mode.
std::string theory_table(const fem::BeamOptions& beam, const std::vector<fem::TheoryEffect>& effects) {
  TextTable table({"mode", "Euler-Bernoulli [Hz]", "shear", "rotary inertia", "Timoshenko [Hz]", "both"});
  const auto percent = [](double change) { return fmt::format("{:+.3g} %", 100.0 * change); };
  for (std::size_t k = 0; k < effects.size(); ++k) {
    const fem::TheoryEffect& effect = effects[k];
    table.add({fmt::format("{}", k + 1), fmt::format("{:.8g}", effect.euler_bernoulli_hz), percent(effect.shear_change),
               percent(effect.rotary_change), fmt::format("{:.8g}", effect.timoshenko_hz),
               percent(effect.timoshenko_change)});
  }
  const bool timoshenko = beam.theory == fem::BeamTheory::kTimoshenko;
  return fmt::format(
      "\nChange of slipping modes by shear and rotary inertia (Poisson's ratio {:g}, shear coefficient {:g}; this "
      "scene: theory = \"{}\"):\n{}",
      beam.spans.front().poisson_ratio, beam.spans.front().shear_coefficient,
      timoshenko ? "timoshenko" : "euler-bernoulli", table.str());
}

nlohmann::json set_json(const fem::Modes& modes) {
  std::vector<double> omega(modes.omega.begin(), modes.omega.end()), frequencies;
  for (const double value : omega) frequencies.push_back(hertz(value));
  return {{"omega", omega}, {"frequency", frequencies}};
}

nlohmann::json theory_json(const std::vector<fem::TheoryEffect>& effects) {
  nlohmann::json list = nlohmann::json::array();
  for (const fem::TheoryEffect& effect : effects) {
    list.push_back({{"euler_bernoulli_hz", effect.euler_bernoulli_hz},
                    {"shear_hz", effect.shear_hz},
                    {"rotary_hz", effect.rotary_hz},
                    {"timoshenko_hz", effect.timoshenko_hz},
                    {"shear_change", effect.shear_change},
                    {"rotary_change", effect.rotary_change},
                    {"timoshenko_change", effect.timoshenko_change}});
  }
  return list;
}

Report run(const Session& session, const ModesArguments& arguments) {
  if (!arguments.output.empty()) require_writable(arguments.output);
  const scene::Scene scene = session.load(arguments.scene);
  const dynamics::HybridSystem system = scene::build_system(scene);
  const auto found = std::make_shared<const studies::ModeSets>(studies::natural_modes(scene, system, arguments.count));
  const studies::ModeSets& sets = *found;
  const Eigen::VectorXd ratios = damping_ratios(system.structure(), sets.slipping);

  Report report;
  report.text =
      fmt::format("{}: {} degrees of freedom\n{}", scene.name(), system.size(), mode_table(scene, sets, ratios));
  report.data = {{"verb", "modes"}, {"degrees_of_freedom", system.size()}, {"units", scene.units}};
  report.data["slipping"] = set_json(sets.slipping);
  report.data["slipping"]["damping_ratio"] = std::vector<double>(ratios.begin(), ratios.end());
  report.data["sticking"] = set_json(sets.sticking);
  if (sets.compliant.omega.size() > 0) report.data["held_by_springs"] = set_json(sets.compliant);
  if (scene.beam() != nullptr) {
    report.text += theory_table(*scene.beam(), sets.theory);
    report.data["theory_effects"] = theory_json(sets.theory);
  }
  if (!arguments.output.empty()) {
    studies::content_of(scene, found).save(arguments.output);
    tell_file("Frequencies and shapes", arguments.output, report);
  }
  return report;
}

}  // namespace

Verb add_modes(CLI::App& app) {
  CLI::App* command = app.add_subcommand("modes", "natural frequencies and mode shapes, slipping and sticking");
  const auto arguments = std::make_shared<ModesArguments>();
  command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", arguments->output, "also store frequencies and shapes (HDF5)");
  command->add_option("--count", arguments->count, "number of modes; 0: the lowest 20");
  command->footer("Example:\n  slipmode modes datasets/chain10/scene.toml --set structure.masses=40");
  return {command, [arguments](const Session& session) { return run(session, *arguments); }};
}

}  // namespace slipmode::cli
