#include <slipmode/figures/basins_figures.hpp>

#include <slipmode/core/none.hpp>
#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/basins_store.hpp>
#include <slipmode/results/table.hpp>
#include "figures/internal/heat_map.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace slipmode::figures {
namespace {

using results::StoreReader;

const std::string kRoot = results::kBasinsGroup;

/// "gap", "period 1, 4 crossings", …: row by row of a table of attractors.
std::string motion_of(const results::Table& table, std::size_t row) {
  return results::attractor_text(table.texts("kind")[row], table.numbers("order")[row],
                                 table.numbers("crossings")[row]);
}

/// Segments of the line on which a number over the grid is zero, by linear interpolation along the cells' sides.
void zero_line(const HeatMapPanel& panel, const Eigen::MatrixXd& number, Eigen::VectorXd& out_x,
               Eigen::VectorXd& out_y) {
  std::vector<double> x, y;
  for (Eigen::Index j = 0; j + 1 < number.rows(); ++j) {
    for (Eigen::Index i = 0; i + 1 < number.cols(); ++i) {
      const std::array<std::pair<Eigen::Index, Eigen::Index>, 5> corners{
          {{j, i}, {j, i + 1}, {j + 1, i + 1}, {j + 1, i}, {j, i}}};
      int met = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [j0, i0] = corners[k];
        const auto [j1, i1] = corners[k + 1];
        const double a = number(j0, i0), b = number(j1, i1);
        if ((a > 0.0) == (b > 0.0)) continue;
        const double share = a / (a - b);
        x.push_back(panel.x(i0) + share * (panel.x(i1) - panel.x(i0)));
        y.push_back(panel.y(j0) + share * (panel.y(j1) - panel.y(j0)));
        if (++met % 2 > 0) continue;
        x.push_back(kNone);
        y.push_back(kNone);
      }
    }
  }
  out_x = to_vector(x);
  out_y = to_vector(y);
}

HeatMapPanel plane(const StoreReader& store, Eigen::MatrixXd value) {
  HeatMapPanel panel{"", store.vector(kRoot + "/x/values"), store.vector(kRoot + "/y/values"), std::move(value)};
  if (store.has(kRoot + "/room")) zero_line(panel, store.matrix(kRoot + "/room"), panel.line_x, panel.line_y);
  return panel;
}

HeatMapLayout layout_of(const StoreReader& store, std::string value_label, std::string missing) {
  const auto axis = [&](const std::string& group) {
    return axis_label(store.text(group + "/label"), store.entry(group + "/values").meaning.units);
  };
  return {.x_label = axis(kRoot + "/x"),
          .y_label = axis(kRoot + "/y"),
          .value_label = std::move(value_label),
          .missing = std::move(missing)};
}

/// One colour for each attractor that some start ends on; the lines are where the linear strip ends.
Figure basins(const StoreReader& store) {
  const Eigen::MatrixXd attractor = store.matrix(kRoot + "/attractor");
  const results::Table table = results::load_table(store, kRoot + "/attractors");
  HeatMapLayout layout = layout_of(store, "ends on", "undecided");
  Eigen::MatrixXd colour = Eigen::MatrixXd::Constant(attractor.rows(), attractor.cols(), kNone);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double number = table.numbers("attractor")[row];
    if (number < 0.0 || table.numbers("starts")[row] == 0.0) continue;
    colour = (attractor.array() == number).select(static_cast<double>(layout.words.size()), colour);
    layout.words.push_back(fmt::format("{:g} {}", number, motion_of(table, row)));
  }
  layout.words.resize(std::max<std::size_t>(layout.words.size(), 2));
  layout.steps = static_cast<int>(layout.words.size());
  layout.high = layout.steps - 1;
  return heat_maps({plane(store, std::move(colour))}, layout);
}

/// Colours over the finite values of a dataset.
Figure number_over_plane(const StoreReader& store, const std::string& name, const std::string& label,
                         const std::string& missing) {
  const Eigen::MatrixXd value = store.matrix(kRoot + "/" + name);
  HeatMapLayout layout = layout_of(store, axis_label(label, store.entry(kRoot + "/" + name).meaning.units), missing);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double one : value.reshaped()) {
    if (!std::isfinite(one)) continue;
    low = std::min(low, one);
    high = std::max(high, one);
  }
  if (low < high) {
    layout.low = low;
    layout.high = high;
  }
  return heat_maps({plane(store, value)}, layout);
}

/// f over ε, both by their logarithms, with the line fitted.
Figure uncertainty(const StoreReader& store) {
  const results::Table table = results::load_table(store, kRoot + "/uncertainty");
  const double slope = store.number(kRoot + "/uncertainty_exponent");
  Eigen::VectorXd x = to_vector(table.numbers("displacement")).array().log10();
  Eigen::VectorXd y = to_vector(table.numbers("share")).array().log10();
  Panel panel{.title = "", .series = {{"share of uncertain starts", x, y, Series::Look::kMarkedLine, kFullColour}}};
  if (std::isfinite(slope)) {
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < y.size(); ++k) {
      if (std::isfinite(y(k)) && y(k) < std::log10(0.5)) used.push_back(k);
    }
    const Eigen::VectorXd along = x(used), level = y(used);
    panel.series.push_back({fmt::format("slope {:.3f} ± {:.3f}", slope, store.number(kRoot + "/uncertainty_error")),
                            along, level.mean() + slope * (along.array() - along.mean()), Series::Look::kLine,
                            kPomColour});
  }
  return panel_grid({panel}, {.panel_height = 460,
                              .x_label = "log_{10} of the step in cells",
                              .y_label = "log_{10} of the share",
                              .legend = "set key top left"});
}

/// Shares over the third key, those of one kind of motion together.
Figure shares(const StoreReader& store) {
  const results::Table table = results::load_table(store, kRoot + "/along");
  std::map<std::string, std::map<double, double>> share_of;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.numbers("starts")[row] > 0.0) {
      share_of[motion_of(table, row)][table.numbers("value")[row]] += table.numbers("share")[row];
    }
  }
  constexpr std::string_view kColours[] = {kFullColour, kPomColour, kLnmColour, kSecondColour};
  Panel panel;
  for (const auto& [motion, points] : share_of) {
    std::vector<double> x, y;
    for (const auto& [value, share] : points) {
      x.push_back(value);
      y.push_back(100.0 * share);
    }
    panel.series.push_back({motion, to_vector(x), to_vector(y), Series::Look::kMarkedLine,
                            kColours[panel.series.size() % std::size(kColours)]});
  }
  return panel_grid({panel}, {.panel_height = 460,
                              .x_label = axis_label(store.text(kRoot + "/along_label"),
                                                    store.entry(kRoot + "/along/value").meaning.units),
                              .y_label = "share of the starts [%]",
                              .legend = kLegendAbove});
}

}  // namespace

std::vector<FileFigure> basins_figures_of(const StoreReader& store) {
  std::vector<FileFigure> all = {
      {"basins", "which attractor each start ends on; lines: the strip of the linear motion", basins},
      {"periods", "periods of the drive until that was known",
       [](const StoreReader& file) {
         return number_over_plane(file, "periods", "periods of the drive until known", "none");
       }},
      {"uncertainty", "share of uncertain starts against the step", uncertainty}};
  if (store.matrix(kRoot + "/coordinate").array().isFinite().any()) {
    all.push_back({"coordinate", "which motion of the gap's continuum each start ends in", [](const StoreReader& file) {
                     return number_over_plane(file, "coordinate", "coordinate in the gap", "not in the gap");
                   }});
  }
  if (store.has(kRoot + "/along")) all.push_back({"shares", "shares over the third key", shares});
  return all;
}

}  // namespace slipmode::figures
