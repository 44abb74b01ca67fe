#include <slipmode/fem/modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/fem/beam_modes.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/units.hpp>
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

struct ModeSets {
  fem::Modes slipping;
  fem::Modes sticking;                    ///< every contact held; empty when nothing is left to move
  fem::Modes compliant;                   ///< every contact held by its spring or stop; empty unless each has one
  std::vector<fem::TheoryEffect> theory;  ///< of a beam
};

/// Directions of all contacts, one per column.
Eigen::MatrixXd contact_directions(const dynamics::HybridSystem& system) {
  Eigen::MatrixXd w(system.size(), static_cast<Eigen::Index>(system.contacts().size()));
  for (Eigen::Index c = 0; c < w.cols(); ++c) w.col(c) = system.contacts()[c].direction;
  return w;
}

/// Stiffness that holds a stuck contact, or one at its stop; 0 for a law without a spring.
double contact_stiffness(const friction::Law& law) {
  const friction::Clearance* clearance = friction::clearance(law);
  return clearance != nullptr ? clearance->stops().back().stiffness : friction::spring_stiffness(law);
}

ModeSets compute(const scene::Scene& scene, const dynamics::HybridSystem& system, Eigen::Index count) {
  const Eigen::MatrixXd w = contact_directions(system);
  const Eigen::Index free = system.size() - w.cols();
  ModeSets sets{
      .slipping = fem::natural_modes(system.structure(), count), .sticking = {}, .compliant = {}, .theory = {}};
  if (can_stick(system) && free > 0 && w.cols() > 0) {
    sets.sticking = fem::constrained_modes(system.structure(), w, std::min(count, free));
  }
  Eigen::VectorXd stiffness(w.cols());
  std::ranges::transform(system.contacts(), stiffness.begin(),
                         [](const friction::Contact& contact) { return contact_stiffness(contact.law); });
  if (w.cols() > 0 && (stiffness.array() > 0.0).all()) {
    sets.compliant = fem::compliant_modes(system.structure(), w, stiffness, count);
  }
  if (scene.beam() != nullptr) sets.theory = fem::theory_effects(*scene.beam(), count);
  return sets;
}

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

void store(const std::filesystem::path& path, const scene::Scene& scene, const ModeSets& sets) {
  const results::Units units = results::Units::of(scene.units);
  results::StoreWriter writer(path, results::FileKind::kModes, scene.units);
  results::save(writer, results::provenance_of(scene, "slipmode modes"));
  const auto write = [&](const std::string& group, const fem::Modes& modes, const std::string& what) {
    writer.describe_group(group, what);
    writer.write(group + "/omega", modes.omega, {units.angular, "circular frequencies, ascending"});
    writer.write(group + "/shapes", modes.shapes, {"1", "mass-normalised shapes, dof x mode"});
  };
  write("modes/slipping", sets.slipping, "natural modes with every contact slipping");
  if (sets.sticking.omega.size() > 0) write("modes/sticking", sets.sticking, "natural modes with every contact stuck");
  if (sets.compliant.omega.size() > 0) {
    write("modes/compliant", sets.compliant, "natural modes with every contact held by its spring or stop");
  }
  writer.commit();
}

std::string mode_table(const scene::Scene& scene, const ModeSets& sets, const Eigen::VectorXd& ratios) {
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
    std::vector<std::string> row = {fmt::format("{}", k + 1), cell(sets.slipping.omega, k, 1.0),
                                    cell(sets.slipping.omega, k, hertz(1.0)), fmt::format("{:.4g}", ratios[k]),
                                    cell(sets.sticking.omega, k, 1.0)};
    if (scene.beam() != nullptr) row.push_back(cell(sets.sticking.omega, k, hertz(1.0)));
    if (springs) row.push_back(cell(sets.compliant.omega, k, hertz(1.0)));
    table.add(row);
  }
  return table.str();
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
  if (arguments.count < 0 || arguments.count > system.size()) {
    throw InvalidInput(fmt::format("--count {}: expected 1..{} (the degrees of freedom), or 0 for the lowest 20",
                                   arguments.count, system.size()));
  }
  const Eigen::Index count = arguments.count == 0 ? std::min<Eigen::Index>(system.size(), 20) : arguments.count;
  const ModeSets sets = compute(scene, system, count);
  const Eigen::VectorXd ratios = damping_ratios(system.structure(), sets.slipping);

  Report report;
  report.text =
      fmt::format("{}: {} degrees of freedom\n{}", scene.title, system.size(), mode_table(scene, sets, ratios));
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
    store(arguments.output, scene, sets);
    report.data["file"] = arguments.output;
    report.text += fmt::format("Frequencies and shapes: {}\n", arguments.output);
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
