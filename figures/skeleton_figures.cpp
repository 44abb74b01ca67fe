#include <slipmode/figures/skeleton_figures.hpp>

#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/phase_portraits.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/skeleton_store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/scene/scene.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipmode::figures {
namespace {

using results::StoreReader;

std::string group_of(const std::string& model) { return fmt::format("{}/{}", results::kSkeletonGroup, model); }

std::string_view model_colour(const std::string& model) { return model == "full" ? kFullColour : kPomColour; }

/// "full", "reduced": the models a result holds.
std::vector<std::string> models_of(const StoreReader& store) {
  std::vector<std::string> models;
  for (const std::string model : {"full", "reduced"}) {
    if (store.has(group_of(model))) models.push_back(model);
  }
  return models;
}

/// The first contact's displacement and velocity from points of the full model.
class ContactView {
 public:
  explicit ContactView(const StoreReader& store)
      : scene_(results::load_scene_of(store)), contact_(scene::build_system(scene_).contacts().front()) {}

  [[nodiscard]] PhasePortrait attractor(const StoreReader& store, const std::string& model) const {
    const Eigen::MatrixXd portrait = store.columns(group_of(model) + "/portrait", 2);
    return {model + " model", portrait.row(0), portrait.row(1), model_colour(model)};
  }

  /// @param index  of the orbit, from 0
  [[nodiscard]] PhasePortrait orbit(const StoreReader& store, const std::string& model, std::size_t index) const {
    const results::Table orbits = results::load_table(store, group_of(model) + "/orbits");
    const Eigen::MatrixXd path = store.columns(fmt::format("{}/orbit_{:03}/path", group_of(model), index + 1));
    const Eigen::Index n = path.rows() / 2, count = path.cols();
    Eigen::VectorXd y(count + 1), rate(count + 1);
    y.head(count) = (path.topRows(n).transpose() * contact_.direction).array() + contact_.offset;
    rate.head(count) = path.bottomRows(n).transpose() * contact_.direction;
    y(count) = y(0);
    rate(count) = rate(0);
    return {
        fmt::format("T = {:.3f}, {:.1f} %", orbits.numbers("period")[index], 100.0 * orbits.numbers("share")[index]), y,
        rate, model_colour(model)};
  }

  [[nodiscard]] PortraitLayout layout(int columns, PortraitLayout::Axes axes) const {
    const results::Units units = results::Units::of(scene_.units);
    return {.columns = columns,
            .displacement = "displacement",
            .displacement_unit = units.length,
            .velocity = "velocity",
            .velocity_unit = units.velocity,
            .axes = axes};
  }

 private:
  scene::Scene scene_;
  friction::Contact contact_;
};

/// The attractor, then its orbits with the largest share in the order of their periods.
Figure orbit_portraits(const StoreReader& store) {
  constexpr std::size_t kShown = 11;
  const std::string model = models_of(store).front();
  const ContactView view(store);
  const std::vector<double> share = results::load_table(store, group_of(model) + "/orbits").numbers("share");
  std::vector<std::size_t> order(share.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return share[a] > share[b]; });
  order.resize(std::min(order.size(), kShown));
  std::ranges::sort(order);
  std::vector<PhasePortrait> panels{view.attractor(store, model)};
  for (const std::size_t index : order) panels.push_back(view.orbit(store, model, index));
  return phase_portraits(panels, view.layout(4, PortraitLayout::Axes::kShared));
}

/// S4 Figure 3.10: both attractors, and orbits that both have, one above the other.
Figure comparison(const StoreReader& store) {
  constexpr std::size_t kShown = 3;
  const results::Table matched = results::load_table(store, group_of("comparison") + "/matched");
  const std::vector<double> share = results::load_table(store, group_of("full") + "/orbits").numbers("share");
  std::vector<std::size_t> rows(matched.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  const auto index = [&](const char* model, std::size_t row) {
    return static_cast<std::size_t>(matched.numbers(model)[row]) - 1;
  };
  std::ranges::stable_sort(
      rows, [&](std::size_t a, std::size_t b) { return share[index("full", a)] > share[index("full", b)]; });
  rows.resize(std::min(rows.size(), kShown));
  std::ranges::sort(rows);
  const ContactView view(store);
  std::vector<PhasePortrait> panels;
  for (const char* model : {"full", "reduced"}) {
    panels.push_back(view.attractor(store, model));
    for (const std::size_t row : rows) panels.push_back(view.orbit(store, model, index(model, row)));
  }
  return phase_portraits(panels, view.layout(static_cast<int>(rows.size()) + 1, PortraitLayout::Axes::kPerColumn));
}

/// Orbits of one model as points over their periods.
struct OrbitPoints {
  Eigen::VectorXd period, exponent, share;

  OrbitPoints(const StoreReader& store, const std::string& model) {
    const results::Table orbits = results::load_table(store, group_of(model) + "/orbits");
    period = to_vector(orbits.numbers("period"));
    exponent = to_vector(orbits.numbers("leading_modulus")).array().log() / period.array();
    share = 100.0 * to_vector(orbits.numbers("share"));
  }
};

/// Every orbit of every model: growth rate and share against period; orbits that match are joined.
Figure orbit_spectrum(const StoreReader& store) {
  const std::vector<std::string> models = models_of(store);
  std::vector<OrbitPoints> points;
  for (const std::string& model : models) points.emplace_back(store, model);
  const auto panel = [&](const std::string& title, Eigen::VectorXd OrbitPoints::*value) {
    Panel out{.title = title, .series = {}};
    if (store.has(group_of("comparison"))) {
      const results::Table matched = results::load_table(store, group_of("comparison") + "/matched");
      for (std::size_t row = 0; row < matched.rows(); ++row) {
        const auto f = static_cast<Eigen::Index>(matched.numbers("full")[row]) - 1;
        const auto r = static_cast<Eigen::Index>(matched.numbers("reduced")[row]) - 1;
        out.series.push_back({.title = row == 0 ? "the same orbit" : "",
                              .x = to_vector({points[0].period(f), points[1].period(r)}),
                              .y = to_vector({(points[0].*value)(f), (points[1].*value)(r)}),
                              .look = Series::Look::kLine,
                              .colour = kLnmColour});
      }
    }
    for (std::size_t k = 0; k < points.size(); ++k) {
      out.series.push_back(
          {models[k] + " model", points[k].period, points[k].*value, Series::Look::kPoints, model_colour(models[k])});
    }
    return out;
  };
  const std::string unit = store.entry(group_of(models.front()) + "/orbits/period").meaning.units;
  return panel_grid(
      {panel("growth rate ln |multiplier| / T", &OrbitPoints::exponent),
       panel("share of the attractor near the orbit [%]", &OrbitPoints::share)},
      {.columns = 1, .panel_height = 330, .x_label = axis_label("period T", unit), .y_label = {}, .shared_y = false});
}

}  // namespace

std::vector<FileFigure> skeleton_figures_of(const StoreReader& store) {
  std::vector<FileFigure> out{{"orbits", "the attractor and its orbits", orbit_portraits},
                              {"spectrum", "growth rates and shares against period", orbit_spectrum}};
  if (store.has(group_of("comparison"))) {
    out.insert(out.begin(), {"comparison", "both attractors and orbits that both have", comparison});
  }
  return out;
}

}  // namespace slipmode::figures
