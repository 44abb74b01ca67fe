#include <slipmode/figures/spectrum_figures.hpp>

#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/spectrum_store.hpp>

#include <fmt/format.h>

namespace slipmode::figures {
namespace {

/// Smaller than this share of the largest amplitude is rounding, and would stretch the axis.
constexpr double kLeast = 1e-15;

Figure harmonic_amplitudes(const results::StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  const results::Units units = results::Units::of(scene.units);
  const results::Table table = results::load_spectrum(store);
  const Eigen::VectorXd order = to_vector(table.numbers("order"));
  std::vector<Panel> panels;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    Panel panel{.title = scene.contacts[c].name, .series = {}};
    for (const auto& [word, unit, colour] :
         {std::tuple{"displacement", units.length, kFullColour}, std::tuple{"velocity", units.velocity, kPomColour},
          std::tuple{"force", units.force, kLnmColour}}) {
      const Eigen::ArrayXd size = results::harmonics_of(table, fmt::format("{}_{}", word, c + 1)).amplitude();
      const Eigen::VectorXd shown = (size <= kLeast * size.maxCoeff()).select(std::nan(""), size);
      panel.series.push_back({c == 0 ? axis_label(word, unit) : "", order, shown, Series::Look::kPoints, colour});
    }
    panels.push_back(std::move(panel));
  }
  return panel_grid(panels, {.columns = 1,
                             .panel_height = panels.size() > 1 ? 320 : 560,
                             .x_label = "order",
                             .y_label = "amplitude",
                             .shared_y = false,
                             .log_y = true,
                             .legend = kLegendAbove});
}

}  // namespace

std::vector<FileFigure> spectrum_figures_of(const results::StoreReader&) {
  return {{"spectrum", "amplitude over order at the contacts", harmonic_amplitudes}};
}

}  // namespace slipmode::figures
