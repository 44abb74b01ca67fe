#include <slipmode/figures/trade_figures.hpp>

#include <slipmode/figures/pareto.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/trade_store.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace slipmode::figures {
namespace {

using trade::Measure;

/// What a figure shows of one measure, from a study or from its file.
struct Fronts {
  std::vector<std::string> names, axes;
  std::vector<double> time;                 // [s]
  std::vector<trade::Values> error, noise;  // [%]
  std::string title;
};

/// "POM" of "6 POM": reduced models are told apart by their bases.
std::string group_of(const std::string& name, const std::string& axis) {
  if (axis == "scene") return "as it stands";
  if (axis == "modes") return name.substr(name.find(' ') + 1);
  return axis;
}

Figure front_of(const Fronts& fronts, Measure measure) {
  std::vector<trade::Offer> offers;
  std::vector<ParetoPoint> points;
  for (std::size_t i = 0; i < fronts.names.size(); ++i) {
    offers.push_back({.cost = fronts.time[i],
                      .error = trade::at(fronts.error[i], measure),
                      .noise = trade::at(fronts.noise[i], measure)});
    points.push_back({.name = fronts.names[i],
                      .group = group_of(fronts.names[i], fronts.axes[i]),
                      .cost = 1e3 * offers.back().cost,
                      .error = offers.back().error,
                      .resolved = offers.back().resolved()});
  }
  for (const std::size_t i : trade::pareto_front(offers)) points[i].on_front = true;
  const bool shared = measure != Measure::kDx && measure != Measure::kDe;  // one scatter for all
  const auto scatter = std::ranges::find_if(offers, &trade::Offer::known);
  return pareto_diagram(points, {.title = fmt::format("{}: {}", fronts.title, trade::describe(measure)),
                                 .cost = axis_label("processor time of a run", "ms"),
                                 .error = axis_label(trade::to_string(measure), "%"),
                                 .noise = shared && scatter != offers.end() ? scatter->noise : 0.0});
}

bool has_values(const Fronts& fronts, Measure measure) {
  return std::ranges::any_of(fronts.error,
                             [&](const auto& values) { return std::isfinite(trade::at(values, measure)); });
}

Fronts fronts_of(const trade::Study& study, const scene::Scene& scene) {
  Fronts fronts{.names = {}, .axes = {}, .time = {}, .error = {}, .noise = {}, .title = scene.name()};
  for (const trade::Row& row : study.rows) {
    fronts.names.push_back(row.variant.name);
    fronts.axes.emplace_back(trade::to_string(row.variant.axis));
    fronts.time.push_back(row.cost.cpu);
    fronts.error.push_back(row.error);
    fronts.noise.push_back(row.noise);
  }
  return fronts;
}

/// The first row is the reference, which is no choice.
Fronts fronts_of(const results::StoreReader& store) {
  const results::Table table = results::load_table(store, std::string(results::kTradeGroup) + "/candidates");
  Fronts fronts{.names = table.texts("name"),
                .axes = table.texts("axis"),
                .time = table.numbers("time"),
                .error = std::vector<trade::Values>(table.rows()),
                .noise = std::vector<trade::Values>(table.rows()),
                .title = results::load_scene_of(store).name()};
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const std::string name(trade::to_string(static_cast<Measure>(m)));
    for (std::size_t i = 0; i < table.rows(); ++i) {
      fronts.error[i][m] = table.numbers(name)[i];
      fronts.noise[i][m] = table.numbers(name + "_noise")[i];
    }
  }
  const auto drop_first = [](auto& list) { list.erase(list.begin()); };
  drop_first(fronts.names);
  drop_first(fronts.axes);
  drop_first(fronts.time);
  drop_first(fronts.error);
  drop_first(fronts.noise);
  return fronts;
}

}  // namespace

std::vector<std::string> save_trade_figures(const trade::Study& study, const scene::Scene& scene,
                                            const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const Fronts fronts = fronts_of(study, scene);
  std::vector<std::string> files;
  for (std::size_t m = 0; m < trade::kMeasures; ++m) {
    const auto measure = static_cast<Measure>(m);
    if (!has_values(fronts, measure)) continue;
    const std::string name = fmt::format("pareto_{}", trade::to_string(measure));
    save(front_of(fronts, measure), {folder / (name + ".svg"), folder / (name + ".png")});
    files.push_back(name + ".svg");
    files.push_back(name + ".png");
  }
  return files;
}

std::vector<FileFigure> trade_figures_of(const results::StoreReader& store) {
  std::vector<FileFigure> out;
  const Fronts fronts = fronts_of(store);
  for (const Measure measure :
       {Measure::kDe, Measure::kDx, Measure::kPoints, Measure::kSpread, Measure::kEnergy, Measure::kStick}) {
    if (!has_values(fronts, measure)) continue;
    out.push_back({fmt::format("pareto_{}", trade::to_string(measure)),
                   fmt::format("time against {}", trade::describe(measure)),
                   [measure](const results::StoreReader& file) { return front_of(fronts_of(file), measure); }});
  }
  return out;
}

}  // namespace slipmode::figures
