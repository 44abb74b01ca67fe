#include <slipmode/figures/exponents_figures.hpp>

#include <slipmode/figures/exponent_figures.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/exponents_store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace slipmode::figures {
namespace {

using results::StoreReader;

constexpr std::array<std::string_view, 4> kExponentModelColours = {kFullColour, kPomColour, kLnmColour, kSecondColour};

std::string_view model_colour(std::size_t model) { return kExponentModelColours[model % kExponentModelColours.size()]; }

/// Groups of models that have exponents.
std::vector<std::string> exponent_groups(const StoreReader& store) {
  std::vector<std::string> groups;
  for (std::size_t i = 0; store.has(fmt::format("{}/{}", results::kExponentsGroup, i)); ++i) {
    const std::string group = fmt::format("{}/{}", results::kExponentsGroup, i);
    if (store.has(group + "/values")) groups.push_back(group);
  }
  return groups;
}

/// Unit of a file's exponents in bits.
std::string bit_rate(const StoreReader& store) {
  return store.entry(exponent_groups(store).front() + "/values/bits").meaning.units;
}

Eigen::VectorXd bits_of(const std::vector<double>& nats) { return to_vector(nats) / std::numbers::ln2; }

/// As many as the Kaplan-Yorke dimension needs and two more, at least four.
Eigen::Index leading(const StoreReader& store, const std::string& group) {
  const double dimension = store.number(group + "/kaplan_yorke");
  const Eigen::Index needed = std::isfinite(dimension) ? static_cast<Eigen::Index>(std::ceil(dimension)) + 2 : 4;
  return std::max<Eigen::Index>(needed, 4);
}

Eigen::Index leading_exponents(const StoreReader& store) {
  Eigen::Index most = 4;
  for (const std::string& group : exponent_groups(store)) most = std::max(most, leading(store, group));
  return most;
}

Eigen::Index finite_of(const Eigen::VectorXd& values) { return values.array().isFinite().count(); }

Figure exponents_drawn(const StoreReader& store) {
  std::vector<ExponentSeries> models;
  for (const std::string& group : exponent_groups(store)) {
    const results::Table values = results::load_table(store, group + "/values");
    const Eigen::VectorXd bits = bits_of(values.numbers("nats"));
    const Eigen::Index finite = finite_of(bits);
    const Eigen::Index lost = store.integer(group + "/lost");
    models.push_back({.title = lost > 0
                                   ? fmt::format("{} (and {} of minus infinity)", store.text(group + "/title"), lost)
                                   : store.text(group + "/title"),
                      .value = bits.head(finite),
                      .error = bits_of(values.numbers("error")).head(finite),
                      .colour = model_colour(models.size())});
  }
  return exponent_spectrum(models, leading_exponents(store), bit_rate(store));
}

Figure convergence_drawn(const StoreReader& store) {
  const Eigen::Index most = leading_exponents(store);
  std::vector<ExponentHistory> models;
  std::string time_unit;
  for (const std::string& group : exponent_groups(store)) {
    const Eigen::MatrixXd running = store.columns(group + "/running") / std::numbers::ln2;
    const Eigen::Index finite = finite_of(running.rightCols(1));
    models.push_back({.title = store.text(group + "/title"),
                      .time = store.vector(group + "/time"),
                      .running = running.topRows(std::min(most, finite))});
    time_unit = store.entry(group + "/time").meaning.units;
  }
  return exponent_convergence(models, bit_rate(store), time_unit);
}

/// Cumulative distribution of the rates of expansion of the leading directions, interval by interval.
Figure expansion_drawn(const StoreReader& store) {
  constexpr Eigen::Index kShownDirections = 3;
  std::vector<Panel> panels;
  const std::vector<std::string> groups = exponent_groups(store);
  for (Eigen::Index i = 0; i < kShownDirections; ++i) {
    Panel panel{.title = fmt::format("direction {}", i + 1), .series = {}};
    for (std::size_t m = 0; m < groups.size(); ++m) {
      const Eigen::MatrixXd rates = store.columns(groups[m] + "/rates") / std::numbers::ln2;
      if (i >= rates.rows() || !rates.row(i).allFinite()) continue;
      Eigen::VectorXd sorted = rates.row(i).transpose();
      std::sort(sorted.begin(), sorted.end());
      panel.series.push_back({.title = i == 0 ? store.text(groups[m] + "/title") : "",
                              .x = sorted,
                              .y = Eigen::VectorXd::LinSpaced(sorted.size(), 0.0, 1.0),
                              .colour = model_colour(m)});
    }
    if (!panel.series.empty()) panels.push_back(std::move(panel));
  }
  return panel_grid(panels, {.columns = static_cast<int>(panels.size()),
                             .panel_height = 420,
                             .x_label = fmt::format("expansion rate [{}]", bit_rate(store)),
                             .y_label = "share of the intervals below"});
}

Figure exponents_over_key(const StoreReader& store) {
  std::vector<ExponentSweep> models;
  std::string label, unit, value_unit, rate;
  for (const std::string group : {"exponents/full", "exponents/reduced"}) {
    if (!store.has(group)) continue;
    const results::Table values = results::load_table(store, group + "/values");
    ExponentSweep model{.title = store.text(group + "/title"),
                        .slip_parameter = {},
                        .slip_value = {},
                        .parameter = to_vector(values.numbers("parameter")),
                        .exponents = store.columns(group + "/nats") / std::numbers::ln2,
                        .colour = model_colour(models.size())};
    const std::string slips = std::string("sweep/") + (group == "exponents/full" ? "full" : "reduced") + "/slips";
    if (store.has(slips)) {
      const results::Table table = results::load_table(store, slips);
      model.slip_parameter = to_vector(table.numbers("parameter"));
      model.slip_value = to_vector(table.numbers("displacement"));
      value_unit = store.entry(slips + "/displacement").meaning.units;
    }
    rate = results::Units::of(store.entry(group + "/nats").meaning.units == "1/s" ? "SI" : "dimensionless").bit_rate();
    label = store.text(group + "/label");
    unit = store.entry(group + "/values/parameter").meaning.units;
    models.push_back(std::move(model));
  }
  return exponent_sweep(models, axis_label(label, unit), axis_label("displacement as slip begins", value_unit), rate);
}

}  // namespace

std::vector<FileFigure> exponents_figures_of(const StoreReader& store) {
  if (exponent_groups(store).empty()) return {};
  return {{"exponents", "Lyapunov exponents with their errors", exponents_drawn},
          {"convergence", "exponents against the time measured", convergence_drawn},
          {"expansion", "distribution of the expansion over one interval", expansion_drawn}};
}

std::vector<FileFigure> exponent_sweep_figures_of(const StoreReader&) {
  return {{"exponents", "exponents against the swept key, below the bifurcation diagram", exponents_over_key}};
}

}  // namespace slipmode::figures
