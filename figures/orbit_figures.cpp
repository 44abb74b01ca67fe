#include <slipmode/figures/orbit_figures.hpp>

#include <slipmode/figures/belt_figures.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/branch_store.hpp>
#include <slipmode/results/orbit_records.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/units.hpp>
#include "figures/internal/response_diagram.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

namespace slipmode::figures {
namespace {

using results::StoreReader;

constexpr std::string_view kStopColour = "#999999";

Series straight(double x0, double y0, double x1, double y1, Series::Look look) {
  return {"", Eigen::VectorXd{{x0, x1}}, Eigen::VectorXd{{y0, y1}}, look, kStopColour};
}

/// A stop as S0 Figure 2.2 draws its subspace: met at the gap, let go where its force is zero.
/// @param side  +1 the right stop, −1 the left one
void add_stop(Panel& panel, const friction::Stop& stop, friction::ContactLoss loss, double side, double top_speed,
              double reach) {
  const double gap = side * stop.gap;
  panel.series.push_back(straight(gap, 0.0, gap, side * top_speed, Series::Look::kLine));
  if (loss == friction::ContactLoss::kGap || stop.damping == 0.0) {
    panel.series.push_back(straight(gap, 0.0, gap, -side * top_speed, Series::Look::kLine));
    return;
  }
  const double depth = std::min(reach, top_speed * stop.damping / stop.stiffness);
  const double speed = depth * stop.stiffness / stop.damping;
  panel.series.push_back(straight(gap, 0.0, gap + side * depth, -side * speed, Series::Look::kDashed));
}

Figure orbit_portrait(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  const results::Units units = results::Units::of(scene.units);
  const dynamics::Trajectory run = results::load_trajectory(store);
  std::vector<Panel> panels;
  for (Eigen::Index c = 0; c < run.contact_q.rows(); ++c) {
    const scene::ContactSpec& contact = scene.contacts[static_cast<std::size_t>(c)];
    const Eigen::VectorXd y = run.contact_q.row(c), v = run.contact_v.row(c);
    Panel panel{.title = contact.name, .series = {}};
    if (const auto* law = friction::clearance(contact.law)) {
      const double top = v.cwiseAbs().maxCoeff(), widest = y.cwiseAbs().maxCoeff();
      const auto beyond = [widest](const friction::Stop& stop) { return std::max(0.0, widest - stop.gap); };
      if (law->left) add_stop(panel, *law->left, law->loss, -1.0, top, beyond(*law->left));
      if (law->right) add_stop(panel, *law->right, law->loss, 1.0, top, beyond(*law->right));
    }
    panel.series.push_back({"", y, v, Series::Look::kLine, kFullColour});
    panel.x_label = axis_label("displacement at " + scene::to_string(contact.at), units.length);
    panels.push_back(std::move(panel));
  }
  return panel_grid(panels, {.columns = panels.size() > 1 ? 2 : 1,
                             .panel_height = 560,
                             .y_label = axis_label("velocity", units.velocity),
                             .shared_x = false,
                             .shared_y = false});
}

Figure orbit_multipliers(const StoreReader& store) {
  const orbits::PeriodicOrbit orbit = results::load_orbit(store);
  Eigen::MatrixXd parts(orbit.multipliers.size(), 2);
  parts << orbit.multipliers.real(), orbit.multipliers.imag();
  return multiplier_plane(parts, results::load_scene_of(store).title);
}

/// A branch of a stored table; colours tell the main branch from those that leave it.
std::string_view colour_of(std::size_t branch) { return branch == 0 ? kFullColour : kPomColour; }

std::vector<bool> stable_points(const results::Table& points) {
  std::vector<bool> stable;
  for (const std::string& word : points.texts("stability")) {
    stable.push_back(word != orbits::to_string(orbits::Stability::kUnstable));
  }
  return stable;
}

std::string axis_label_of(const scene::Scene& scene, const std::string& key) {
  const results::SweepAxis axis = results::sweep_axis(scene, key);
  return axis.label == key ? literal(key) : axis_label(axis.label, axis.units);
}

/// Points and special points of a branch in one sequence: where stability changes, the curve changes its look.
ResponseBranch response_branch(const results::StoredBranch& branch, std::string_view colour) {
  const std::vector<bool> stable = stable_points(branch.points);
  const auto& before = branch.special.numbers("before");
  const bool has_band = branch.points.has("true_error");
  std::vector<double> parameter, value, band;
  ResponseBranch curve{.title = branch.title, .parameter = {}, .value = {}, .stable = {}, .colour = colour};
  for (std::size_t k = 0; k < stable.size(); ++k) {
    parameter.push_back(branch.points.numbers("parameter")[k]);
    value.push_back(branch.points.numbers("alternating_1")[k]);
    if (has_band) band.push_back(branch.points.numbers("true_error")[k]);
    curve.stable.push_back(stable[k]);
    for (std::size_t s = 0; s < before.size() && k + 1 < stable.size(); ++s) {
      if (before[s] != static_cast<double>(k)) continue;
      parameter.push_back(branch.special.numbers("parameter")[s]);
      value.push_back(branch.special.numbers("alternating")[s]);
      if (has_band) band.push_back(std::nan(""));
      curve.stable.push_back(stable[k]);
    }
  }
  curve.parameter = to_vector(parameter);
  curve.value = to_vector(value);
  curve.band = to_vector(band);
  return curve;
}

/// Amplitude of the first contact over the key.
Figure response(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  std::vector<ResponseBranch> curves;
  std::vector<ResponseMark> marks;
  const std::vector<results::StoredBranch> branches = results::load_branches(store);
  for (std::size_t k = 0; k < branches.size(); ++k) {
    const results::StoredBranch& branch = branches[k];
    if (branch.points.rows() > 0) curves.push_back(response_branch(branch, colour_of(k)));
    if (k == 1 && !curves.empty()) curves.back().title = "branches that leave it";
    if (k > 1 && !curves.empty()) curves.back().title.clear();
    for (std::size_t i = 0; i < branch.special.rows(); ++i) {
      marks.push_back({branch.special.texts("kind")[i], branch.special.numbers("parameter")[i],
                       branch.special.numbers("alternating")[i]});
    }
  }
  const std::string place = scene::to_string(scene.contacts.front().at);
  return response_diagram(
      curves, marks,
      {.parameter = axis_label_of(scene, store.text("branches/key")),
       .value = axis_label("half the range of displacement at " + place, results::Units::of(scene.units).length)});
}

/// Curves of special points in the plane of both keys.
Figure curve_plane(const StoreReader& store) {
  constexpr std::array kColours = {kFullColour, kPomColour, kLnmColour, kSecondColour};
  const scene::Scene scene = results::load_scene_of(store);
  std::vector<ResponseBranch> curves;
  std::vector<ResponseMark> marks;
  for (const results::StoredBranch& curve : results::load_curves(store)) {
    if (curve.points.rows() == 0) continue;
    curves.push_back({.title = curve.title,
                      .parameter = to_vector(curve.points.numbers("over")),
                      .value = to_vector(curve.points.numbers("along")),
                      .stable = std::vector<bool>(curve.points.rows(), true),
                      .colour = kColours[curves.size() % kColours.size()]});
    for (std::size_t i = 0; i < curve.special.rows(); ++i)
      marks.push_back(
          {curve.special.texts("kind")[i], curve.special.numbers("over")[i], curve.special.numbers("along")[i]});
  }
  return response_diagram(curves, marks,
                          {.parameter = axis_label_of(scene, store.text("curves/over")),
                           .value = axis_label_of(scene, store.text("curves/along"))});
}

/// |multipliers| over the key, the unit circle's modulus as a line.
Figure branch_multipliers(const StoreReader& store) {
  constexpr double kOfAccount = 1e-4;  // smaller ones are of no account for stability, and would stretch the axis
  constexpr std::size_t kMost = 6;
  const scene::Scene scene = results::load_scene_of(store);
  std::vector<Panel> panels;
  const std::vector<results::StoredBranch> branches = results::load_branches(store);
  for (const results::StoredBranch& branch : branches) {
    if (branch.points.rows() == 0 || panels.size() == kMost) continue;
    const Eigen::VectorXd parameter = to_vector(branch.points.numbers("parameter"));
    Panel panel{.title = branch.title, .series = {}};
    panel.series.push_back(straight(parameter.minCoeff(), 1.0, parameter.maxCoeff(), 1.0, Series::Look::kDashed));
    for (Eigen::Index m = 0; m < branch.modulus.cols(); ++m) {
      const Eigen::ArrayXd own = branch.modulus.col(m);
      const Eigen::VectorXd shown = (own < kOfAccount).select(std::nan(""), own);
      panel.series.push_back({"", parameter, shown, Series::Look::kLine, kFullColour});
    }
    panels.push_back(std::move(panel));
  }
  return panel_grid(panels, {.columns = 1,
                             .panel_height = panels.size() > 1 ? 320 : 560,
                             .x_label = axis_label_of(scene, store.text("branches/key")),
                             .y_label = "|multiplier| [–]",
                             .shared_y = false,
                             .log_y = true});
}

}  // namespace

std::vector<FileFigure> orbit_figures_of(const StoreReader&) {
  return {{"orbit", "phase portrait of the orbit, stops drawn", orbit_portrait},
          {"multipliers", "Floquet multipliers and the unit circle", orbit_multipliers},
          history_figure()};
}

std::vector<FileFigure> curve_figures_of(const StoreReader&) {
  return {{"curves", "curves of special points in the plane of both keys", curve_plane}};
}

std::vector<FileFigure> branch_figures_of(const StoreReader& store) {
  std::vector<FileFigure> all = {
      {"response",
       "amplitude over the key, unstable orbits dashed, special points marked; of balances with their true error",
       response}};
  const auto has_multipliers = [](const results::StoredBranch& branch) { return branch.modulus.cols() > 0; };
  if (std::ranges::any_of(results::load_branches(store), has_multipliers))
    all.push_back({"multipliers", "moduli of the Floquet multipliers over the key", branch_multipliers});
  return all;
}

}  // namespace slipmode::figures
