#include "report/internal/animation.hpp"

#include <slipmode/figures/style.hpp>
#include <slipmode/results/file_kind.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/records.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/scene.hpp>
#include "report/internal/structure.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <numbers>

namespace slipmode::report {
namespace {

using results::StoreReader;

constexpr Eigen::Index kMostModes = 12, kMostSamples = 1200;

/// Of a motion; times count from its first sample shown.
Json moving_trajectory(const StoreReader& store, const scene::Scene& scene, const DrawnStructure& structure) {
  const dynamics::Trajectory run = results::load_trajectory(store);
  if (run.q.rows() != scene.size() || run.times.size() < 2) return nullptr;
  const Eigen::Index count = std::min(kMostSamples, run.times.size()), first = run.times.size() - count;
  const results::Units units = results::Units::of(scene.units);
  const std::string place = scene::to_string(scene.contacts.front().at);
  return {{"interval", (run.times[run.times.size() - 1] - run.times[first]) / static_cast<double>(count - 1)},
          {"start", number_json(run.times[first])},
          {"shape", shapes_json(structure.readings * run.q.rightCols(count))},
          {"modes", contact_modes_json(run.events, run.final_state.modes, run.times[first])},
          {"q", list_json(run.contact_q.row(0).tail(count))},
          {"force", list_json(run.lambda.row(0).tail(count))},
          {"labels",
           {{"time", figures::axis_label("time", units.time)},
            {"q", figures::axis_label(fmt::format("displacement x_{{{}}}", place), units.length)},
            {"force", figures::axis_label(fmt::format("contact force λ_{{{}}}", place), units.force)}}}};
}

Json still_modes(const Eigen::MatrixXd& vectors, const DrawnStructure& structure, const std::string& noun,
                 const std::function<std::string(Eigen::Index)>& note) {
  Json shapes = Json::array();
  for (Eigen::Index k = 0; k < std::min(kMostModes, vectors.cols()); ++k)
    shapes.push_back({{"title", fmt::format("{} {}{}", noun, k + 1, note(k))},
                      {"shape", list_json(structure.readings * vectors.col(k))}});
  return {{"shapes", std::move(shapes)}};
}

Json moving_modes(const StoreReader& store, const scene::Scene& scene, const DrawnStructure& structure) {
  const results::Units units = results::Units::of(scene.units);
  const bool pod = store.has("pod/basis/vectors");
  const Eigen::MatrixXd vectors = store.matrix(pod ? "pod/basis/vectors" : "modes/slipping/shapes");
  if (vectors.rows() != scene.size()) return nullptr;
  if (pod) {
    const Eigen::VectorXd shares = store.vector("pod/shares");
    return still_modes(vectors, structure, "POM", [&](Eigen::Index k) {
      return k < shares.size() ? fmt::format(": {:.3g} % of the energy", 100.0 * shares[k]) : std::string();
    });
  }
  const Eigen::VectorXd omega = store.vector("modes/slipping/omega", vectors.cols());
  return still_modes(vectors, structure, "mode", [&](Eigen::Index k) {
    return units.frequency == "Hz" ? fmt::format(": {:.5g} Hz", omega[k] / (2.0 * std::numbers::pi))
                                   : fmt::format(": ω = {:.5g}", omega[k]);
  });
}

}  // namespace

Json animation_json(const StoreReader& store) {
  const bool moves = store.has("trajectory/q"),
             modes = store.has("pod/basis/vectors") || store.has("modes/slipping/shapes");
  if (!store.has("provenance") || (!moves && !modes)) return nullptr;
  const scene::Scene scene = results::load_scene_of(store);
  if (scene.size() > kMostDrawnDofs) return nullptr;
  const DrawnStructure structure = drawn_structure(scene);
  Json out = moves ? moving_trajectory(store, scene, structure) : moving_modes(store, scene, structure);
  if (!out.is_null()) out["structure"] = structure.about;
  return out;
}

}  // namespace slipmode::report
