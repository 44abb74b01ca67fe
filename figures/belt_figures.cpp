#include <slipmode/figures/belt_figures.hpp>

#include <slipmode/figures/bifurcation.hpp>
#include <slipmode/figures/deviation.hpp>
#include <slipmode/figures/energy_shares.hpp>
#include <slipmode/figures/mode_shapes.hpp>
#include <slipmode/figures/panels.hpp>
#include <slipmode/figures/phase_portraits.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/figures/time_history.hpp>
#include <slipmode/results/portrait_store.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/rom/candidates.hpp>
#include <slipmode/rom/reduce.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/solver_options.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <map>

namespace slipmode::figures {
namespace {

using results::StoreReader;

std::string_view colour_of(const std::string& role) {
  if (role == "full") return kFullColour;
  return role == "LNM" ? kLnmColour : kPomColour;
}

/// "x_{10}": the displacement of one of the scene's contacts as the figures call it.
std::string contact_symbol(const scene::Scene& scene, const std::string& letter, std::size_t contact = 0) {
  return fmt::format("{}_{{{}}}", letter, scene::to_string(scene.contacts[contact].at));
}

/// The slip states of a sweep, of the full model and of the reduced one where there is one.
std::vector<std::pair<std::string, results::Table>> slips_of(const StoreReader& store) {
  std::vector<std::pair<std::string, results::Table>> slips;
  for (const std::string group : {"sweep/full", "sweep/reduced"})
    if (store.has(group)) slips.emplace_back(group, results::load_table(store, group + "/slips"));
  return slips;
}

/// The contact that slips most often, the first of several.
std::size_t most_slipping(const std::vector<std::pair<std::string, results::Table>>& slips, std::size_t contacts) {
  std::vector<std::ptrdiff_t> counts(contacts, 0);
  for (const auto& [group, table] : slips)
    for (std::size_t c = 0; c < contacts; ++c)
      counts[c] += std::ranges::count(table.numbers("contact"), static_cast<double>(c));
  return static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin());
}

Figure bifurcation(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  std::vector<BifurcationPanel> panels;
  std::string label, unit;
  const auto slips = slips_of(store);
  const std::size_t shown = most_slipping(slips, scene.contacts.size());
  for (const auto& [group, table] : slips) {
    const auto& contact = table.numbers("contact");
    const auto& parameter = table.numbers("parameter");
    const auto& displacement = table.numbers("displacement");
    std::vector<double> x, y;
    for (std::size_t i = 0; i < contact.size(); ++i) {
      if (contact[i] != static_cast<double>(shown)) continue;
      x.push_back(parameter[i]);
      y.push_back(displacement[i]);
    }
    panels.push_back({.title = store.text(group + "/title"),
                      .parameter = to_vector(x),
                      .value = to_vector(y),
                      .colour = group == "sweep/full" ? kFullColour : kPomColour,
                      .swept = to_vector(results::load_table(store, group + "/values").numbers("parameter"))});
    label = store.text(group + "/label");
    unit = store.entry(group + "/values/parameter").meaning.units;
  }
  return bifurcation_diagram(panels, {.parameter = label,
                                      .parameter_unit = unit,
                                      .value = "slip-state displacement " + contact_symbol(scene, "x", shown),
                                      .value_unit = results::Units::of(scene.units).length,
                                      .none = "no contact slips from rest on its counterpart here"});
}

PortraitLayout portrait_layout(const scene::Scene& scene, int columns, PortraitLayout::Axes axes) {
  const results::Units units = results::Units::of(scene.units);
  return {.columns = columns,
          .displacement = "displacement " + contact_symbol(scene, "x"),
          .displacement_unit = units.length,
          .velocity = "velocity " + contact_symbol(scene, "v"),
          .velocity_unit = units.velocity,
          .axes = axes};
}

Figure portraits(const StoreReader& store, const std::string& group, PortraitLayout::Axes axes) {
  const results::PortraitSet set = results::load_portraits(store, group);
  std::vector<PhasePortrait> panels;
  for (const results::Portrait& portrait : set.portraits) {
    panels.push_back({portrait.title, portrait.displacement, portrait.velocity, colour_of(portrait.role)});
  }
  return phase_portraits(panels, portrait_layout(results::load_scene_of(store), set.columns, axes));
}

/// Curves of one motion: rows of a table that belong to it, by basis.
DeviationCase deviation_case(const results::Table& table, const std::string& title,
                             const std::vector<std::size_t>& rows) {
  std::map<std::string, std::vector<std::size_t>> by_basis;
  for (const std::size_t row : rows) by_basis[table.texts("basis")[row]].push_back(row);
  DeviationCase motion{.title = title, .curves = {}};
  for (const auto& [basis, of_basis] : by_basis) {
    const auto pick = [&, &of_basis = of_basis](const std::string& column) {
      Eigen::VectorXd values(static_cast<Eigen::Index>(of_basis.size()));
      for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = table.numbers(column)[of_basis[i]];
      return values;
    };
    motion.curves.push_back({basis, pick("modes"), pick("dX"), pick("dE"), colour_of(basis)});
  }
  std::stable_sort(motion.curves.begin(), motion.curves.end(),
                   [](const auto& a, const auto& b) { return a.name == "POM" && b.name != "POM"; });
  return motion;
}

std::string with_unit(double value, const std::string& unit) {
  return unit == "1" ? fmt::format("{:g}", value) : fmt::format("{:g} {}", value, unit);
}

/// False when there was no orbit to compare at any number of modes.
bool has_values(const DeviationCase& motion) {
  return std::any_of(motion.curves.begin(), motion.curves.end(),
                     [](const auto& curve) { return curve.delta_x.array().isFinite().any(); });
}

Figure deviations(const StoreReader& store) {
  const scene::Scene scene = scene::with_own_times(results::load_scene_of(store));
  const results::Units units = results::Units::of(scene.units);
  const results::Table shares = results::load_table(store, "validation/shares");
  const results::Table orbits = results::load_table(store, "validation/orbits");
  std::vector<DeviationCase> cases;
  std::vector<std::size_t> all(shares.rows());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  cases.push_back(deviation_case(
      shares,
      fmt::format("V = {}, up to t = {}", with_unit(store.number("validation/full/speed"), units.velocity),
                  with_unit(scene.validation.horizon, units.time)),
      all));
  std::map<double, std::vector<std::size_t>, std::greater<>> by_speed;
  for (std::size_t i = 0; i < orbits.rows(); ++i) by_speed[orbits.numbers("speed")[i]].push_back(i);
  for (const auto& [speed, rows] : by_speed) {
    DeviationCase orbit =
        deviation_case(orbits, fmt::format("V = {}, one period", with_unit(speed, units.velocity)), rows);
    if (has_values(orbit)) cases.push_back(std::move(orbit));
  }
  constexpr std::size_t kMostColumns = 4;
  if (cases.size() > kMostColumns) cases.resize(kMostColumns);
  return deviation(cases);
}

/// The LNMs of the scene a file was made from, beside which POMs are drawn.
Eigen::MatrixXd lnms(const scene::Scene& scene, Eigen::Index count) {
  return rom::lnm_basis(scene::build_system(scene).structure(), count).vectors;
}

Figure shapes(const StoreReader& store) {
  const pod::PodResult result = results::load_pod(store);
  return mode_shapes({.poms = result.basis.vectors,
                      .lnms = lnms(results::load_scene_of(store), result.basis.modes()),
                      .shares = result.shares});
}

Figure reduced_shapes(const StoreReader& store) {
  const pod::Basis basis = results::load_basis(store, std::string(results::kReducedGroup) + "/basis");
  const bool compare = basis.kind != pod::BasisKind::kLnm;
  return mode_shapes({.poms = basis.vectors,
                      .lnms = compare ? lnms(results::load_scene_of(store), basis.modes()) : Eigen::MatrixXd(),
                      .shares = basis.energy});
}

Figure energy(const StoreReader& store) {
  const scene::Scene scene = results::load_scene_of(store);
  const pod::PodResult result = results::load_pod(store);
  const pod::NamedBasis lnm = rom::pom_and_lnm(scene::build_system(scene).structure(), result)[1];
  return energy_shares(
      {.pom = result.shares, .lnm_captured = lnm.captured, .threshold = scene.reduction.choice.energy});
}

std::vector<std::pair<double, double>> stick_intervals(const dynamics::Trajectory& trajectory) {
  std::vector<std::pair<double, double>> intervals;
  const double begin = trajectory.times[0], end = trajectory.times[trajectory.times.size() - 1];
  double since = begin;
  bool stuck = false, known = false;
  for (const auto& event : trajectory.events) {
    if (event.contact != 0) continue;
    if (!known) stuck = event.before == dynamics::ContactMode::kStick;
    known = true;
    if (stuck) intervals.emplace_back(since, event.time);
    stuck = event.after == dynamics::ContactMode::kStick;
    since = event.time;
  }
  if (stuck) intervals.emplace_back(since, end);
  return intervals;
}

/// The last stretch of a trajectory: long ones would be black.
Figure history(const StoreReader& store) {
  constexpr Eigen::Index kShown = 1000;
  const scene::Scene scene = results::load_scene_of(store);
  const results::Units units = results::Units::of(scene.units);
  const dynamics::Trajectory trajectory = results::load_trajectory(store);
  const Eigen::Index shown = std::min(kShown, trajectory.times.size());
  std::vector<std::pair<double, double>> stick;
  const double begin = trajectory.times[trajectory.times.size() - shown];
  for (const auto& interval : stick_intervals(trajectory)) {
    if (interval.second > begin) stick.push_back(interval);
  }
  return time_history({.contact = scene.contacts.front().name,
                       .time = trajectory.times.tail(shown),
                       .displacement = trajectory.contact_q.row(0).tail(shown),
                       .velocity = trajectory.contact_v.row(0).tail(shown),
                       .force = trajectory.lambda.row(0).tail(shown),
                       .stick = stick,
                       .time_unit = units.time,
                       .displacement_unit = units.length,
                       .velocity_unit = units.velocity,
                       .force_unit = units.force});
}

Figure trajectory_portrait(const StoreReader& store) {
  constexpr Eigen::Index kShown = 5000;
  const scene::Scene scene = results::load_scene_of(store);
  const dynamics::Trajectory trajectory = results::load_trajectory(store);
  const Eigen::Index shown = std::min(kShown, trajectory.times.size());
  return phase_portraits(
      {{scene.name(), trajectory.contact_q.row(0).tail(shown), trajectory.contact_v.row(0).tail(shown), kFullColour}},
      portrait_layout(scene, 1, PortraitLayout::Axes::kShared));
}

FileFigure bifurcation_figure() { return {"bifurcation", "slip states against the swept key", bifurcation}; }

}  // namespace

FileFigure history_figure() { return {"history", "displacement, velocity and force of the first contact", history}; }

std::vector<FileFigure> trajectory_figures_of(const StoreReader&) {
  return {history_figure(), {"portrait", "phase portrait of the first contact", trajectory_portrait}};
}

std::vector<FileFigure> belt_pod_figures_of(const StoreReader&) {
  return {{"shapes", "proper orthogonal modes beside linear natural modes", shapes},
          {"energy", "energy shares", energy}};
}

std::vector<FileFigure> belt_reduced_figures_of(const StoreReader&) {
  return {{"shapes", "basis of the reduced model", reduced_shapes}};
}

std::vector<FileFigure> belt_sweep_figures_of(const StoreReader&) { return {bifurcation_figure()}; }

std::vector<FileFigure> belt_validation_figures_of(const StoreReader& store) {
  std::vector<FileFigure> out{{"deviation", "deviations against the number of modes", deviations}};
  const auto add_if = [&](const std::string& group, FileFigure figure) {
    if (store.has(group)) out.push_back(std::move(figure));
  };
  add_if("sweep", bifurcation_figure());
  add_if("portraits/levels", {"levels", "phase portraits, fewer and fewer modes", [](const StoreReader& file) {
                                return portraits(file, "portraits/levels", PortraitLayout::Axes::kShared);
                              }});
  add_if("portraits/orbits", {"orbits", "periodic orbits, full above reduced", [](const StoreReader& file) {
                                return portraits(file, "portraits/orbits", PortraitLayout::Axes::kPerColumn);
                              }});
  return out;
}

}  // namespace slipmode::figures
