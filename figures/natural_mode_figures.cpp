#include <slipmode/figures/natural_mode_figures.hpp>

#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include "figures/internal/shapes.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <optional>

namespace slipmode::figures {
namespace {

using results::StoreReader;

struct ModeSet {
  const char* name;
  std::string_view colour;
  bool dashed = false;  ///< seen over what it nearly equals
};
constexpr std::array<ModeSet, 3> kSets = {
    {{"slipping", kLnmColour}, {"sticking", kPomColour}, {"compliant", kSecondColour, true}}};

/// Displacements over the place along a beam, elsewhere over the number of the degree of freedom.
class ShapeAxis {
 public:
  explicit ShapeAxis(const scene::Scene& scene) {
    if (scene.beam() != nullptr) beam_ = scene::build_beam(scene);
    const auto n = static_cast<double>(scene.size());
    x_ = beam_ ? Eigen::VectorXd::LinSpaced(kPoints, 0.0, beam_->reach())
               : Eigen::VectorXd::LinSpaced(scene.size(), 1.0, n);
  }
  [[nodiscard]] Series of(const ModeSet& set, const Eigen::VectorXd& shape) const {
    const bool few = !beam_ && shape.size() <= kMarked;
    return {set.name, x_, beam_ ? beam_shape(*beam_, x_, shape) : normalised(shape),
            set.dashed ? Series::Look::kDashed
            : few      ? Series::Look::kMarkedLine
                       : Series::Look::kLine,
            set.colour};
  }
  [[nodiscard]] std::string label() const { return beam_ ? axis_label("x", "m") : "degree of freedom"; }

 private:
  static constexpr Eigen::Index kPoints = 200, kMarked = 60;
  std::optional<fem::Beam> beam_;
  Eigen::VectorXd x_;
};

Figure shapes_drawn(const StoreReader& store) {
  constexpr Eigen::Index kShown = 6;
  const ShapeAxis axis(results::load_scene_of(store));
  std::vector<Panel> panels;
  for (const ModeSet& set : kSets) {
    const std::string group = fmt::format("modes/{}", set.name);
    if (!store.has(group)) continue;
    const Eigen::VectorXd omega = store.vector(group + "/omega");
    const Eigen::MatrixXd shapes = store.matrix(group + "/shapes");
    for (Eigen::Index k = 0; k < std::min(kShown, omega.size()); ++k) {
      if (k == std::ssize(panels)) panels.push_back({fmt::format("mode {}, ω =", k + 1), {}});
      Panel& panel = panels[static_cast<std::size_t>(k)];
      Series own = axis.of(set, shapes.col(k));
      if (!panel.series.empty()) own.y = turned_to(own.y, panel.series.front().y);
      panel.title += fmt::format("{} {:.4g}", panel.series.empty() ? "" : ",", omega[k]);
      panel.series.push_back(std::move(own));
    }
  }
  return panel_grid(panels,
                    {.columns = 3, .panel_height = 260, .x_label = axis.label(), .y_label = axis_label("shape", "1")});
}

}  // namespace

std::vector<FileFigure> natural_mode_figures_of(const StoreReader&) {
  return {{"modes", "the lowest natural modes, contacts slipping, stuck, and held by their springs", shapes_drawn}};
}

}  // namespace slipmode::figures
