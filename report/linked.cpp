#include "report/internal/linked.hpp"

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/scene/shaken.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/motions.hpp>
#include "report/internal/structure.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>

namespace slipmode::report {
namespace {

using results::StoreReader;
using studies::Motion;
using studies::MotionsOf;
using studies::MotionsRequest;

constexpr std::size_t kMostSpeeds = 43, kMostRecorded = 22, kMostModels = 5;

/// Some of the values, ends included, that have their places in the order of all.
std::set<std::size_t> spread(std::size_t count, std::size_t most) {
  std::set<std::size_t> kept;
  for (std::size_t k = 0; k < std::min(count, most); ++k) kept.insert(count <= most ? k : k * (count - 1) / (most - 1));
  return kept;
}

std::size_t nearest(const std::vector<double>& values, double value) {
  const auto distance = [value](double one) { return std::abs(one - value); };
  return static_cast<std::size_t>(std::ranges::min_element(values, {}, distance) - values.begin());
}

/// Of the basis compared first, numbers of modes with which there is a reduced model: the chosen one, and others.
std::vector<Eigen::Index> modes_of(const StoreReader& validation) {
  const results::Table shares = results::load_table(validation, "validation/shares");
  std::vector<Eigen::Index> made;
  for (std::size_t i = 0; i < shares.rows(); ++i) {
    const bool first = shares.texts("basis")[i] == shares.texts("basis").front();
    if (first && shares.texts("failure")[i].empty())
      made.push_back(static_cast<Eigen::Index>(shares.numbers("modes")[i]));
  }
  std::ranges::sort(made);
  std::set<Eigen::Index> kept;
  for (const std::size_t k : spread(made.size(), kMostModels)) kept.insert(made[k]);
  const auto chosen = static_cast<Eigen::Index>(validation.integer("validation/chosen_modes"));
  if (std::ranges::find(made, chosen) != made.end()) kept.insert(chosen);
  return {kept.begin(), kept.end()};
}

MotionsRequest request_of(const scene::Scene& scene, const StoreReader& validation) {
  const std::vector<double> swept = results::load_table(validation, "sweep/full/values").numbers("parameter");
  std::set<std::size_t> shown = spread(swept.size(), kMostSpeeds), recorded = spread(swept.size(), kMostRecorded);
  std::vector<double> own = scene.validation.orbits;
  own.push_back(scene::drive_parameter(scene));
  for (const double speed : own) recorded.insert(nearest(swept, speed));
  shown.insert(recorded.begin(), recorded.end());
  MotionsRequest request;
  for (const std::size_t k : shown) {
    request.speeds.push_back(swept[k]);
    request.recorded.push_back(recorded.contains(k));
  }
  request.modes = modes_of(validation);
  return request;
}

Json motion_json(const Motion& motion) {
  return {{"interval", motion.interval},
          {"q", list_json(motion.q.row(0), Grain::kCoarse)},
          {"v", list_json(motion.v.row(0), Grain::kCoarse)},
          {"force", list_json(motion.lambda.row(0), Grain::kCoarse)},
          {"modes", contact_modes_json(motion.events, motion.modes, 0.0)},
          {"shape", shapes_json(motion.shape)},
          {"hz", list_json(motion.spectrum.frequency_hz, Grain::kCoarse)},
          {"amplitude", list_json(motion.spectrum.amplitude, Grain::kCoarse, true)}};
}

Json model_json(const MotionsOf& model, const MotionsRequest& request, const std::string& basis) {
  constexpr std::size_t kMostStates = 250;
  std::vector<double> parameter, displacement;
  Json motions = Json::array(), said = Json::array();
  std::size_t next = 0;
  for (std::size_t k = 0; k < model.points.size(); ++k) {
    const diagnostics::SweepPoint& point = model.points[k];
    std::vector<double> states;
    for (const diagnostics::SlipState& slip : point.settled.slips) {
      if (slip.contact == 0 && states.size() < kMostStates) states.push_back(slip.displacement);
    }
    std::ranges::sort(states);
    parameter.insert(parameter.end(), states.size(), point.parameter);
    displacement.insert(displacement.end(), states.begin(), states.end());
    if (!request.recorded[k]) continue;
    const std::optional<Motion>& motion = model.motions[next++];
    motions.push_back(motion ? motion_json(*motion) : Json(nullptr));
    said.push_back(point.ok() ? results::motion_text(point.settled.period) : "failed: " + point.failure);
  }
  return {
      {"modes", model.modes},
      {"title", model.modes == 0 ? std::string("full model") : fmt::format("{} {}s", model.modes, basis)},
      {"slips", {{"x", list_json(to_vector(parameter))}, {"y", list_json(to_vector(displacement), Grain::kCoarse)}}},
      {"said", std::move(said)},
      {"motions", std::move(motions)}};
}

}  // namespace

Json linked_motions(const StoreReader& validation, const StoreReader& bases, const studies::RunOptions& run) {
  const scene::Scene scene = scene::with_own_times(results::load_scene_of(validation));
  if (!validation.has("sweep/full/values") || scene.force || is_shaken(scene) || scene.size() > kMostDrawnDofs)
    return nullptr;
  if (!has_sticking_law(scene)) return nullptr;  // motions are found by their slips
  const DrawnStructure structure = drawn_structure(scene);
  const pod::NamedBasis basis = studies::load_bases(scene, scene::build_system(scene), bases).front();
  MotionsRequest request = request_of(scene, validation);
  if (request.modes.empty()) return nullptr;
  request.readings = structure.readings;
  const std::vector<MotionsOf> found = studies::motions(scene, basis, request, run);
  const results::Units units = results::Units::of(scene.units);
  const std::string place = scene::to_string(scene.contacts.front().at);
  const auto label = [&](const char* what, const std::string& unit) {
    return figures::axis_label(fmt::format("{}_{{{}}}", what, place), unit);
  };
  Json speeds = Json::array(), models = Json::array();
  for (std::size_t k = 0; k < request.speeds.size(); ++k) {
    if (request.recorded[k]) speeds.push_back(number_json(request.speeds[k]));
  }
  for (const MotionsOf& model : found) models.push_back(model_json(model, request, basis.name));
  return {{"speeds", std::move(speeds)},
          {"all_speeds", request.speeds.size()},
          {"own_speed", number_json(scene::drive_parameter(scene))},
          {"chosen", validation.integer("validation/chosen_modes")},
          {"basis", basis.name},
          {"structure", structure.about},
          {"samples_per_shape", request.samples_per_shape},
          {"periods", request.periods},
          {"spectrum_periods", request.spectrum_periods},
          {"labels",
           {{"speed", figures::axis_label(validation.text("sweep/full/label"), units.velocity)},
            {"slip", label("slip-state displacement x", units.length)},
            {"time", figures::axis_label("time", units.time)},
            {"q", label("displacement x", units.length)},
            {"v", label("velocity v", units.velocity)},
            {"force", label("contact force λ", units.force)},
            {"hz", figures::axis_label("frequency", units.frequency)},
            {"amplitude", label("amplitude of the velocity v", units.velocity)}}},
          {"models", std::move(models)}};
}

}  // namespace slipmode::report
