#include <slipmode/figures/shaken_figures.hpp>

#include <slipmode/fem/beam_modes.hpp>
#include <slipmode/fem/modes.hpp>
#include <slipmode/figures/belt_figures.hpp>
#include <slipmode/figures/motion_figures.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/driven_validation_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/shaken_modes.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/driven.hpp>
#include "figures/internal/shapes.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <numbers>

namespace slipmode::figures {
namespace {

using results::StoreReader;

/// @param basis  a scene's word, a name in capitals, or a group's name, which has no signs
std::string_view colour_of_basis(std::string basis) {
  std::ranges::transform(basis, basis.begin(), [](unsigned char letter) { return std::tolower(letter); });
  if (basis.starts_with("pom")) return kPomColour;
  if (basis == "lnm") return kLnmColour;
  return basis.starts_with("lnm") ? kSecondColour : "#CC79A7";
}

Series sections(const StoreReader& store, const std::string& group, const std::string& title, std::string_view colour) {
  const results::Table table = results::load_table(store, group + "/sections");
  return {title, to_vector(table.numbers("parameter")), to_vector(table.numbers("reading")), Series::Look::kDots,
          colour};
}

std::string reading_label(const StoreReader& store, const std::string& group) {
  return axis_label(store.text(group + "/reading"), store.entry(group + "/sections/reading").meaning.units);
}

std::string swept_label(const StoreReader& store, const std::string& group) {
  return axis_label(store.text(group + "/label"), store.entry(group + "/values/parameter").meaning.units);
}

std::vector<std::string> sweep_groups(const StoreReader& store) {
  std::vector<std::string> groups;
  for (const char* name : {"sweep/full", "sweep/full_reverse", "sweep/reduced", "sweep/reduced_reverse"}) {
    if (store.has(name)) groups.emplace_back(name);
  }
  return groups;
}

Figure sweep_sections(const StoreReader& store) {
  std::vector<Panel> panels;
  const std::vector<std::string> groups = sweep_groups(store);
  for (const std::string& group : groups) {
    const auto colour = group.find("full") != std::string::npos ? kFullColour : kPomColour;
    panels.push_back({store.text(group + "/title"), {sections(store, group, "", colour)}});
  }
  return panel_grid(panels, {.columns = 1,
                             .panel_height = panels.size() == 1 ? 560 : 400,
                             .x_label = swept_label(store, groups.front()),
                             .y_label = reading_label(store, groups.front())});
}

/// √2 rms over the swept key, a colour for each label.
Panel labelled_amplitudes(const StoreReader& store, const std::string& group) {
  const results::Table values = results::load_table(store, group + "/values");
  const std::array<std::pair<const char*, std::string_view>, 4> labels = {
      {{"stick", kFullColour}, {"stick-slip", kPomColour}, {"slip", kLnmColour}, {"no friction", kFullColour}}};
  Panel panel{store.text(group + "/title"), {}};
  const Eigen::VectorXd parameter = to_vector(values.numbers("parameter"));
  const Eigen::VectorXd amplitude = std::numbers::sqrt2 * to_vector(values.numbers("rms"));
  panel.series.push_back({"", parameter, amplitude, Series::Look::kLine, "#BBBBBB"});
  for (const auto& [label, colour] : labels) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < values.rows(); ++i) {
      if (values.texts("label")[i] != label) continue;
      x.push_back(parameter[static_cast<Eigen::Index>(i)]);
      y.push_back(amplitude[static_cast<Eigen::Index>(i)]);
    }
    panel.series.push_back({label, to_vector(x), to_vector(y), Series::Look::kDots, colour});
  }
  return panel;
}

Figure amplitudes(const StoreReader& store, const std::vector<std::string>& groups) {
  std::vector<Panel> panels;
  panels.reserve(groups.size());
  for (const std::string& group : groups) panels.push_back(labelled_amplitudes(store, group));
  return panel_grid(panels, {.columns = 1,
                             .panel_height = panels.size() == 1 ? 480 : 360,
                             .x_label = swept_label(store, groups.front()),
                             .y_label = axis_label("amplitude of " + store.text(groups.front() + "/reading"),
                                                   store.entry(groups.front() + "/sections/reading").meaning.units)});
}

/// Models of a validation by basis (the part of the group's name before the number), in order of L.
std::map<std::string, std::vector<std::string>> models_by_basis(const StoreReader& store) {
  std::map<std::string, std::vector<std::string>> models;
  const std::string group = std::string(results::kDrivenValidationGroup) + "/models";
  if (!store.has(group)) return models;
  for (const std::string& name : store.names(group)) models[name.substr(0, name.rfind('_'))].push_back(name);
  return models;
}

/// L = 1 … 6 of one basis over the full model.
Figure multiples(const StoreReader& store, const std::vector<std::string>& models, std::string_view colour) {
  constexpr std::size_t kShown = 6;
  const std::string root = results::kDrivenValidationGroup;
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < std::min(kShown, models.size()); ++i) {
    const std::string group = root + "/models/" + models[i];
    panels.push_back(
        {store.text(group + "/title"),
         {sections(store, root + "/full", "full model", "#BBBBBB"), sections(store, group, "reduced model", colour)}});
  }
  return panel_grid(panels, {.columns = 2,
                             .panel_height = 300,
                             .x_label = swept_label(store, root + "/full"),
                             .y_label = reading_label(store, root + "/full")});
}

Figure agreement(const StoreReader& store) {
  const std::string root = results::kDrivenValidationGroup;
  const results::Table table = results::load_table(store, root + "/agreement");
  std::map<std::string, std::vector<Eigen::Index>> rows;
  for (std::size_t i = 0; i < table.rows(); ++i) rows[table.texts("basis")[i]].push_back(static_cast<Eigen::Index>(i));
  const Eigen::VectorXd modes = to_vector(table.numbers("modes"));
  Panel distance{"mean distance of section points, in units of the full model's rms", {}};
  for (const auto& [basis, of_basis] : rows) {
    distance.series.push_back({basis, modes(of_basis), to_vector(table.numbers("mean_distance"))(of_basis),
                               Series::Look::kMarkedLine, colour_of_basis(basis)});
  }
  const Eigen::VectorXd ends = Eigen::VectorXd::LinSpaced(2, modes.minCoeff(), modes.maxCoeff());
  const double noise = store.number(root + "/noise");
  if (noise > 0.0) {
    distance.series.push_back(
        {"two full sweeps", ends, Eigen::VectorXd::Constant(2, noise), Series::Look::kDashed, kFullColour});
  }
  return panel_grid({distance}, {.columns = 1,
                                 .panel_height = 480,
                                 .x_label = axis_label("number of modes L", "1"),
                                 .y_label = axis_label("distance", "1"),
                                 .log_y = true});
}

/// Vectors of a basis beside the natural modes of the same number.
Figure functions_along(const StoreReader& store, const std::string& group, const std::string& name) {
  constexpr Eigen::Index kShown = 6, kPoints = 200;
  const scene::Scene scene = results::load_scene_of(store);
  const fem::Beam beam = scene::build_beam(scene);
  const pod::Basis basis = results::load_basis(store, group, beam.structure().size());
  const Eigen::Index count = std::min(kShown, basis.modes());
  const Eigen::MatrixXd lnms = fem::natural_modes(beam.structure(), count).shapes;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(kPoints, 0.0, beam.reach());
  std::vector<Panel> panels;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd own = beam_shape(beam, x, basis.vectors.col(k)), lnm = beam_shape(beam, x, lnms.col(k));
    const std::string share =
        k < basis.energy.size() ? fmt::format(": {:.3g} %", 100.0 * basis.energy[k]) : std::string();
    panels.push_back({fmt::format("{} {}{}", name, k + 1, share),
                      {{"linear natural mode", x, turned_to(lnm, own), Series::Look::kDashed, kLnmColour},
                       {name, x, own, Series::Look::kLine, kPomColour}}});
  }
  return panel_grid(
      panels,
      {.columns = 3, .panel_height = 260, .x_label = axis_label("x", "m"), .y_label = axis_label("shape", "1")});
}

FileFigure along_figure(const char* name, const char* what, const std::string& group, const std::string& vectors) {
  return {name, what, [=](const StoreReader& file) { return functions_along(file, group + "/basis", vectors); }};
}

bool is_of_beam(const StoreReader& store) { return results::load_scene_of(store).beam() != nullptr; }

}  // namespace

std::vector<FileFigure> driven_validation_figures_of(const StoreReader& store) {
  const std::string root = results::kDrivenValidationGroup;
  std::vector<FileFigure> out{
      {"agreement", "distance of reduced models to the full one against the number of modes", agreement}};
  const bool swept = results::load_table(store, root + "/full/values").rows() > 1;
  for (const auto& [basis, models] : models_by_basis(store)) {
    if (!swept) break;
    out.push_back({"sweep_" + basis, "sections of reduced models over the full model's",
                   [models = models, colour = colour_of_basis(basis)](const StoreReader& file) {
                     return multiples(file, models, colour);
                   }});
  }
  out.push_back({"labels", "amplitude and label of the full model",
                 [root](const StoreReader& file) { return amplitudes(file, {root + "/full"}); }});
  return out;
}

std::vector<FileFigure> driven_sweep_figures_of(const StoreReader&) {
  return {{"sections", "sections against the swept key", sweep_sections},
          {"labels", "amplitude and label against the swept key",
           [](const StoreReader& file) { return amplitudes(file, sweep_groups(file)); }}};
}

std::vector<FileFigure> shaken_pod_figures_of(const StoreReader& store) {
  std::vector<FileFigure> out;
  if (!is_of_beam(store)) return out;
  if (store.has(results::kPomfGroup)) {
    out.push_back(
        along_figure("pomfs", "modal functions from the sensors beside natural modes", results::kPomfGroup, "POMF"));
  }
  out.push_back(along_figure("poms", "proper orthogonal modes in the mass metric beside natural modes",
                             results::kPodGroup, "mass POM"));
  return out;
}

std::vector<FileFigure> shaken_reduced_figures_of(const StoreReader& store) {
  if (!is_of_beam(store)) return {};
  return {along_figure("shapes", "basis of the reduced model along the beam", results::kReducedGroup, "vector")};
}

std::vector<FileFigure> shaken_trajectory_figures_of(const StoreReader& store) {
  std::vector<FileFigure> out{{"loops", "friction force against relative displacement and velocity", friction_loops},
                              {"delay", "delay map of the reading", reading_delay_map},
                              {"spectrum", "amplitude spectrum of the reading", reading_spectrum}};
  for (FileFigure& figure : trajectory_figures_of(store)) out.push_back(std::move(figure));
  return out;
}

}  // namespace slipmode::figures
