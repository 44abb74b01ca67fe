#include <slipmode/figures/map_figures.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/figures/bifurcation.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/map_store.hpp>
#include <slipmode/results/table.hpp>
#include "figures/internal/heat_map.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace slipmode::figures {
namespace {

using results::StoreReader;

/// "scene", "centre": the starts a result holds, in that order of names.
std::vector<std::string> starts_of(const StoreReader& store, const std::string& group) {
  constexpr std::string_view kPrefix = "from_";
  std::vector<std::string> starts;
  for (const std::string& name : store.names(group)) {
    if (name.starts_with(kPrefix)) starts.push_back(name.substr(kPrefix.size()));
  }
  return starts;
}

std::string title_of(const std::string& start) {
  return start == "centre" ? "from the centre of the gap" : "from the scene's start";
}

std::string axis_text(const StoreReader& store, const std::string& group) {
  return axis_label(store.text(group + "/label"), store.entry(group + "/values").meaning.units);
}

/// One panel per start, its values made from datasets of that start.
std::vector<HeatMapPanel> map_panels(const StoreReader& store,
                                     const std::function<Eigen::MatrixXd(const std::string& group)>& values) {
  std::vector<HeatMapPanel> panels;
  for (const std::string& start : starts_of(store, results::kMapGroup)) {
    panels.push_back({title_of(start), store.vector(std::string(results::kMapGroup) + "/x/values"),
                      store.vector(std::string(results::kMapGroup) + "/y/values"),
                      values(fmt::format("{}/from_{}", results::kMapGroup, start))});
  }
  return panels;
}

HeatMapLayout map_layout(const StoreReader& store) {
  return {.x_label = axis_text(store, std::string(results::kMapGroup) + "/x"),
          .y_label = axis_text(store, std::string(results::kMapGroup) + "/y"),
          .value_label = {}};
}

/// Crossings of period-1 orbits: those of other orders count more periods and are left out.
Figure crossings(const StoreReader& store) {
  HeatMapLayout layout = map_layout(store);
  layout.value_label = "regime changes per period";
  layout.high = 16.0;
  layout.steps = 9;
  layout.missing = "no period 1";
  return heat_maps(map_panels(store,
                              [&](const std::string& group) -> Eigen::MatrixXd {
                                const Eigen::MatrixXd order = store.matrix(group + "/order");
                                return (order.array() == 1.0).select(store.matrix(group + "/crossings").array(), kNone);
                              }),
                   layout);
}

Figure multipliers(const StoreReader& store) {
  HeatMapLayout layout = map_layout(store);
  layout.value_label = "largest |multiplier|";
  layout.colours = HeatMapLayout::Colours::kGrey;
  layout.missing = "none found";
  return heat_maps(map_panels(store, [&](const std::string& group) { return store.matrix(group + "/multiplier"); }),
                   layout);
}

Figure orders(const StoreReader& store) {
  HeatMapLayout layout = map_layout(store);
  layout.value_label = "period, in periods of the drive";
  layout.low = 1.0;
  layout.high = 8.0;
  layout.steps = 8;
  layout.missing = "none found";
  return heat_maps(map_panels(store,
                              [&](const std::string& group) -> Eigen::MatrixXd {
                                const Eigen::MatrixXd order = store.matrix(group + "/order");
                                return (order.array() > 0.0).select(order.array(), kNone);
                              }),
                   layout);
}

Figure amplitudes(const StoreReader& store) {
  HeatMapLayout layout = map_layout(store);
  const auto panels = map_panels(store, [&](const std::string& group) { return store.matrix(group + "/alternating"); });
  layout.high = 1e-300;
  for (const HeatMapPanel& panel : panels) {
    for (const double value : panel.value.reshaped()) {
      if (std::isfinite(value)) layout.high = std::max(layout.high, value);
    }
  }
  const std::string dataset =
      fmt::format("{}/from_{}/alternating", results::kMapGroup, starts_of(store, results::kMapGroup).front());
  layout.value_label = axis_label("alternating amplitude", store.entry(dataset).meaning.units);
  layout.missing = "none found";
  return heat_maps(panels, layout);
}

/// Rows of a table that belong to one contact.
struct Rows {
  const results::Table& table;
  std::vector<std::size_t> rows;

  Rows(const results::Table& from, double contact) : table(from) {
    const auto& contacts = table.numbers("contact");
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (contacts[i] == contact) rows.push_back(i);
    }
  }
  [[nodiscard]] Eigen::VectorXd column(const std::string& name) const {
    const auto& values = table.numbers(name);
    Eigen::VectorXd picked(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) picked(static_cast<Eigen::Index>(k)) = values[rows[k]];
    return picked;
  }
};

Figure strobe_diagram(const StoreReader& store) {
  const std::string root = results::kStrobeGroup;
  std::vector<BifurcationPanel> panels;
  std::string unit, value_unit;
  for (const std::string& start : starts_of(store, root)) {
    const std::string group = fmt::format("{}/from_{}/sections", root, start);
    const results::Table sections = results::load_table(store, group);
    const Rows first(sections, 0.0);
    panels.push_back({title_of(start), first.column("parameter"), first.column("displacement"), kFullColour});
    unit = store.entry(group + "/parameter").meaning.units;
    value_unit = store.entry(group + "/displacement").meaning.units;
  }
  return bifurcation_diagram(panels, {.parameter = store.text(root + "/label"),
                                      .parameter_unit = unit,
                                      .value = "displacement once per period",
                                      .value_unit = value_unit});
}

/// Points of a curve whose verdict is, or is not, a period of one drive's period.
Series verdict_dots(const Rows& rows, const std::string& value, bool period_one, std::string title,
                    std::string_view colour) {
  const Eigen::VectorXd order = rows.column("order"), x = rows.column("parameter"), y = rows.column(value);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < order.size(); ++k) {
    if ((order(k) == 1.0) == period_one) kept.push_back(k);
  }
  return {std::move(title), x(kept), y(kept), Series::Look::kPoints, colour};
}

/// Both amplitudes of S1 above, and below how far its test is from its verdict.
Figure strobe_amplitudes(const StoreReader& store) {
  const std::string root = results::kStrobeGroup, start = starts_of(store, root).front();
  const std::string group = fmt::format("{}/from_{}/values", root, start);
  const results::Table values = results::load_table(store, group);
  const double contacts = *std::ranges::max_element(values.numbers("contact"));
  std::vector<Panel> panels;
  for (double contact = 0.0; contact <= contacts; contact += 1.0) {
    const Rows rows(values, contact);
    const Eigen::VectorXd x = rows.column("parameter");
    panels.push_back({.title = fmt::format("contact {}", contact + 1.0),
                      .series = {{"alternating", x, rows.column("alternating"), Series::Look::kLine, kFullColour},
                                 {"effective × √2", x, std::numbers::sqrt2 * rows.column("effective"),
                                  Series::Look::kDashed, kPomColour},
                                 verdict_dots(rows, "alternating", false, "not period 1", kLnmColour)}});
  }
  for (double contact = 0.0; contact <= contacts; contact += 1.0) {
    const Rows rows(values, contact);
    panels.push_back({.title = fmt::format("contact {}: relative difference of the two", contact + 1.0),
                      .series = {verdict_dots(rows, "sine_gap", true, "", kFullColour),
                                 verdict_dots(rows, "sine_gap", false, "", kLnmColour)}});
  }
  const std::string unit = store.entry(group + "/parameter").meaning.units;
  return panel_grid(panels, {.columns = static_cast<int>(contacts) + 1,
                             .panel_height = 330,
                             .x_label = axis_label(store.text(root + "/label"), unit),
                             .y_label = {},
                             .shared_y = false});
}

}  // namespace

std::vector<FileFigure> map_figures_of(const StoreReader&) {
  return {{"crossings", "regime changes of period-1 orbits", crossings},
          {"multipliers", "largest |multiplier|", multipliers},
          {"orders", "periods of the orbits", orders},
          {"amplitudes", "alternating amplitudes", amplitudes}};
}

std::vector<FileFigure> strobe_figures_of(const StoreReader&) {
  return {{"strobe", "motion seen once per period against the key", strobe_diagram},
          {"amplitudes", "alternating and effective amplitudes against the key", strobe_amplitudes}};
}

}  // namespace slipmode::figures
