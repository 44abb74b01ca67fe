#include <slipmode/figures/balance_figures.hpp>

#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/balance_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/units.hpp>

#include <numbers>

namespace slipmode::figures {
namespace {

Figure balance_portrait(const results::StoreReader& store) {
  constexpr Eigen::Index kPoints = 2001;
  const scene::Scene scene = results::load_scene_of(store);
  const results::Units units = results::Units::of(scene.units);
  const results::StoredBalance balance = results::load_balance(store);
  const bool certified = store.has(results::kTrajectoryGroup);
  const dynamics::Trajectory run = certified ? results::load_trajectory(store) : dynamics::Trajectory{};
  std::vector<Panel> panels;
  for (std::size_t c = 0; c < balance.displacement.size(); ++c) {
    const orbits::Harmonics& own = balance.displacement[c];
    orbits::Harmonics rate = own;  // dy/dt
    for (Eigen::Index k = 0; k <= own.order(); ++k) {
      rate.cosine[k] = balance.omega * static_cast<double>(k) * own.sine[k];
      rate.sine[k] = -balance.omega * static_cast<double>(k) * own.cosine[k];
    }
    Eigen::VectorXd y(kPoints), v(kPoints);
    for (Eigen::Index i = 0; i < kPoints; ++i) {
      const double theta = 2.0 * std::numbers::pi * static_cast<double>(i) / (kPoints - 1);
      y[i] = orbits::value_of(own, theta);
      v[i] = orbits::value_of(rate, theta);
    }
    Panel panel{.title = scene.contacts[c].name, .series = {}};
    if (certified)
      panel.series.push_back({c == 0 ? "exact orbit" : "", run.contact_q.row(static_cast<Eigen::Index>(c)),
                              run.contact_v.row(static_cast<Eigen::Index>(c)), Series::Look::kLine, kFullColour});
    panel.series.push_back({c == 0 ? "balance" : "", y, v, Series::Look::kDashed, kLnmColour});
    panel.x_label = axis_label("displacement at " + scene::to_string(scene.contacts[c].at), units.length);
    panels.push_back(std::move(panel));
  }
  return panel_grid(panels, {.columns = panels.size() > 1 ? 2 : 1,
                             .panel_height = 560,
                             .y_label = axis_label("velocity", units.velocity),
                             .shared_x = false,
                             .shared_y = false,
                             .legend = kLegendAbove});
}

Figure error_over_order(const results::StoreReader& store) {
  const results::StoredBalance balance = results::load_balance(store);
  const Panel panel{.title = "",
                    .series = {{"", to_vector(balance.trials.numbers("harmonics")),
                                to_vector(balance.trials.numbers("error")), Series::Look::kMarkedLine, kFullColour}}};
  return panel_grid({panel}, {.columns = 1,
                              .panel_height = 560,
                              .x_label = "harmonics",
                              .y_label = "true error, share of the half range",
                              .log_y = true});
}

}  // namespace

std::vector<FileFigure> balance_figures_of(const results::StoreReader& store) {
  std::vector<FileFigure> all = {{"portrait", "the balance over the exact orbit behind it", balance_portrait}};
  if (results::load_balance(store).trials.rows() > 1)
    all.push_back({"error", "true error against the number of harmonics", error_over_order});
  return all;
}

}  // namespace slipmode::figures
