#include "report/internal/linked.hpp"

#include <slipmode/core/to_vector.hpp>
#include <slipmode/figures/style.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/scene/driven.hpp>
#include <slipmode/scene/own_times.hpp>
#include <slipmode/studies/bases.hpp>
#include <slipmode/studies/motions.hpp>
#include "report/internal/answers.hpp"
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

constexpr std::size_t kMostValues = 43, kMostRecorded = 22, kMostModels = 5;

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

/// What a comparison under a drive holds, and how the page speaks of it.
struct Compared {
  const char *full, *models;     ///< the full model's sweep, and the table of reduced ones
  const char* word;              ///< of a value of the drive
  const char* settled;           ///< how its models did
  const char *periods, *begins;  ///< of what a motion's length is counted in, and where it begins
};
constexpr Compared kBelt{"sweep/full",
                         "validation/shares",
                         "speed",
                         "by itself, following its own motion from speed to speed",
                         "the slowest natural periods",
                         "with a slip"};
constexpr Compared kDriven{"shaken_validation/full",
                           "shaken_validation/agreement",
                           "frequency",
                           "by itself, from the scene's start",
                           "the drive's periods",
                           "where the shaker's velocity passes zero upward"};

/// The reduced model shown first: on a belt the basis compared first and the chosen number, under a shaker or a force
/// the model that the first screen names.
std::optional<NamedModel> shown_first(const StoreReader& validation, const results::Table& models, bool driven) {
  if (driven) return told_of_driven(validation);
  return NamedModel{models.texts("basis").front(),
                    static_cast<Eigen::Index>(validation.integer("validation/chosen_modes"))};
}

/// Of that basis, numbers of modes with which there is a reduced model: the first shown, and others.
std::vector<Eigen::Index> modes_of(const results::Table& models, const NamedModel& first) {
  std::vector<Eigen::Index> made;
  for (std::size_t i = 0; i < models.rows(); ++i)
    if (models.texts("basis")[i] == first.basis && models.texts("failure")[i].empty())
      made.push_back(static_cast<Eigen::Index>(models.numbers("modes")[i]));
  std::ranges::sort(made);
  std::set<Eigen::Index> kept;
  for (const std::size_t k : spread(made.size(), kMostModels)) kept.insert(made[k]);
  if (std::ranges::find(made, first.modes) != made.end()) kept.insert(first.modes);
  return {kept.begin(), kept.end()};
}

/// Values of the drive: of those swept, some.
MotionsRequest request_of(const scene::Scene& scene, const std::vector<double>& swept) {
  std::set<std::size_t> shown = spread(swept.size(), kMostValues), recorded = spread(swept.size(), kMostRecorded);
  std::vector<double> own;
  if (!is_driven(scene)) own = scene.validation.orbits;
  own.push_back(scene::drive_parameter(scene));
  for (const double value : own) recorded.insert(nearest(swept, value));
  shown.insert(recorded.begin(), recorded.end());
  MotionsRequest request;
  for (const std::size_t k : shown) {
    request.values.push_back(swept[k]);
    request.recorded.push_back(recorded.contains(k));
  }
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

/// @param vectors  what a reduced model's modes are called
Json model_json(const MotionsOf& model, const MotionsRequest& request, const std::string& vectors) {
  constexpr std::size_t kMostStates = 250;
  std::vector<double> parameter, displacement;
  Json motions = Json::array(), said = Json::array();
  std::size_t next = 0;
  for (std::size_t k = 0; k < model.points.size(); ++k) {
    const studies::MotionPoint& point = model.points[k];
    std::vector<double> states = point.states;
    states.resize(std::min(states.size(), kMostStates));
    std::ranges::sort(states);
    parameter.insert(parameter.end(), states.size(), point.value);
    displacement.insert(displacement.end(), states.begin(), states.end());
    if (!request.recorded[k]) continue;
    const std::optional<Motion>& motion = model.motions[next++];
    motions.push_back(motion ? motion_json(*motion) : Json(nullptr));
    said.push_back(point.said);
  }
  return {
      {"modes", model.modes},
      {"title", model.modes == 0 ? std::string("full model") : fmt::format("{} {}", model.modes, vectors)},
      {"slips", {{"x", list_json(to_vector(parameter))}, {"y", list_json(to_vector(displacement), Grain::kCoarse)}}},
      {"said", std::move(said)},
      {"motions", std::move(motions)}};
}

}  // namespace

Json linked_motions(const StoreReader& validation, const StoreReader& bases, const studies::RunOptions& run) {
  const scene::Scene scene = scene::with_own_times(results::load_scene_of(validation));
  const bool driven = is_driven(scene);
  const Compared& own = driven ? kDriven : kBelt;
  if (!validation.has(std::string(own.full) + "/values") || scene.size() > kMostDrawnDofs) return nullptr;
  if (!driven && !has_sticking_law(scene)) return nullptr;  // motions are found by their slips
  const results::Table models_made = results::load_table(validation, own.models);
  const std::optional<NamedModel> first = shown_first(validation, models_made, driven);
  if (!first) return nullptr;
  const std::vector<pod::NamedBasis> all = studies::load_bases(scene, scene::build_system(scene), bases);
  const auto basis_found = std::ranges::find(all, first->basis, &pod::NamedBasis::name);
  if (basis_found == all.end()) return nullptr;
  const pod::NamedBasis& basis = *basis_found;
  const DrawnStructure structure = drawn_structure(scene);
  MotionsRequest request =
      request_of(scene, results::load_table(validation, std::string(own.full) + "/values").numbers("parameter"));
  request.modes = modes_of(models_made, *first);
  if (request.modes.empty()) return nullptr;
  request.readings = structure.readings;
  const std::vector<MotionsOf> found = studies::motions(scene, basis, request, run);
  const results::Units units = results::Units::of(scene.units);
  const std::string place = scene::to_string(scene.contacts.front().at);
  const auto label = [&](const char* what, const std::string& unit) {
    return figures::axis_label(fmt::format("{}_{{{}}}", what, place), unit);
  };
  const std::string vectors = is_shaken(scene) ? "modes of " + basis.name : basis.name + "s";
  Json speeds = Json::array(), models = Json::array();
  for (std::size_t k = 0; k < request.values.size(); ++k) {
    if (request.recorded[k]) speeds.push_back(number_json(request.values[k]));
  }
  for (const MotionsOf& model : found) models.push_back(model_json(model, request, vectors));
  return {{"speeds", std::move(speeds)},
          {"all_speeds", request.values.size()},
          {"own_speed", number_json(scene::drive_parameter(scene))},
          {"chosen", first->modes},
          {"word", own.word},
          {"settled", own.settled},
          {"counted", own.periods},
          {"begins", scene.force ? "at a whole turn of the force" : own.begins},
          {"vectors", vectors},
          {"structure", structure.about},
          {"samples_per_shape", request.samples_per_shape},
          {"periods", request.periods},
          {"spectrum_periods", request.spectrum_periods},
          {"labels",
           {{"speed", figures::axis_label(validation.text(std::string(own.full) + "/label"),
                                          results::sweep_axis(scene, drive_key(scene)).units)},
            {"slip", driven ? figures::axis_label(scene::reading_name(scene), scene::reading_unit(scene))
                            : label("slip-state displacement x", units.length)},
            {"time", figures::axis_label("time", units.time)},
            {"q", label("displacement x", units.length)},
            {"v", label("velocity v", units.velocity)},
            {"force", label("contact force λ", units.force)},
            {"hz", figures::axis_label("frequency", units.frequency)},
            {"amplitude", label("amplitude of the velocity v", units.velocity)}}},
          {"models", std::move(models)}};
}

}  // namespace slipmode::report
