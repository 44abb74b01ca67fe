#include <slipmode/studies/natural_modes.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/units.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <utility>

namespace slipmode::studies {
namespace {

constexpr Eigen::Index kLowest = 20;

/// Directions of all contacts, one per column.
Eigen::MatrixXd contact_directions(const dynamics::HybridSystem& system) {
  Eigen::MatrixXd w(system.size(), static_cast<Eigen::Index>(system.contacts().size()));
  for (Eigen::Index c = 0; c < w.cols(); ++c) w.col(c) = system.contacts()[c].direction;
  return w;
}

/// Stiffness that holds a stuck contact, or one at its stop; 0 for a law without a spring.
double contact_stiffness(const friction::Law& law) {
  const friction::Clearance* clearance = friction::clearance(law);
  return clearance != nullptr ? clearance->stops().back().stiffness : friction::spring_stiffness(law);
}

}  // namespace

ModeSets natural_modes(const scene::Scene& scene, const dynamics::HybridSystem& system, Eigen::Index count) {
  if (count < 0 || count > system.size()) {
    throw InvalidInput(fmt::format("count = {}: expected 1..{} (the degrees of freedom), or 0 for the lowest {}", count,
                                   system.size(), kLowest));
  }
  if (count == 0) count = std::min(system.size(), kLowest);
  const Eigen::MatrixXd w = contact_directions(system);
  const Eigen::Index free = system.size() - w.cols();
  ModeSets sets{
      .slipping = fem::natural_modes(system.structure(), count), .sticking = {}, .compliant = {}, .theory = {}};
  if (can_stick(system) && free > 0 && w.cols() > 0) {
    sets.sticking = fem::constrained_modes(system.structure(), w, std::min(count, free));
  }
  Eigen::VectorXd stiffness(w.cols());
  std::ranges::transform(system.contacts(), stiffness.begin(),
                         [](const friction::Contact& contact) { return contact_stiffness(contact.law); });
  if (w.cols() > 0 && (stiffness.array() > 0.0).all()) {
    sets.compliant = fem::compliant_modes(system.structure(), w, stiffness, count);
  }
  if (scene.beam() != nullptr) sets.theory = fem::theory_effects(*scene.beam(), count);
  return sets;
}

results::Content content_of(const scene::Scene& scene, std::shared_ptr<const ModeSets> sets) {
  const auto write = [scene, sets = std::move(sets)](results::StoreWriter& writer) {
    const results::Units units = results::Units::of(scene.units);
    results::save(writer, results::provenance_of(scene, "slipmode modes"));
    const auto add = [&](const std::string& group, const fem::Modes& modes, const std::string& what) {
      writer.describe_group(group, what);
      writer.write(group + "/omega", modes.omega, {units.angular, "circular frequencies, ascending"});
      writer.write(group + "/shapes", modes.shapes, {"1", "mass-normalised shapes, dof x mode"});
    };
    add("modes/slipping", sets->slipping, "natural modes with every contact slipping");
    if (sets->sticking.omega.size() > 0)
      add("modes/sticking", sets->sticking, "natural modes with every contact stuck");
    if (sets->compliant.omega.size() > 0)
      add("modes/compliant", sets->compliant, "natural modes with every contact held by its spring or stop");
  };
  return {.kind = results::FileKind::kModes, .unit_system = scene.units, .write = write};
}

}  // namespace slipmode::studies
