#include <slipmode/studies/natural_modes.hpp>

#include <slipmode/core/decompositions.hpp>
#include <slipmode/core/errors.hpp>
#include <slipmode/friction/engaged.hpp>
#include <slipmode/friction/places.hpp>
#include <slipmode/results/provenance.hpp>
#include <slipmode/results/units.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <string>
#include <utility>

namespace slipmode::studies {
namespace {

constexpr Eigen::Index kLowest = 20;

/// Directions of contacts, one per column.
Eigen::MatrixXd directions_of(const std::vector<friction::Contact>& contacts, Eigen::Index size) {
  Eigen::MatrixXd w(size, std::ssize(contacts));
  for (Eigen::Index c = 0; c < w.cols(); ++c) w.col(c) = contacts[static_cast<std::size_t>(c)].direction;
  return w;
}

/// Without the directions that follow from others: where contacts close a ring, those of all but one hold the last.
Eigen::MatrixXd independent(const Eigen::MatrixXd& directions) {
  if (directions.cols() < 2) return directions;
  constexpr double kFollows = 1e-10;  // of a direction of length 1
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(directions.colwise().normalized());
  qr.setThreshold(kFollows);
  Eigen::ArrayXi kept = qr.colsPermutation().indices().head(qr.rank()).array();
  std::ranges::sort(kept);
  return directions(Eigen::all, kept);
}

}  // namespace

fem::Modes sticking_modes(const dynamics::HybridSystem& system, Eigen::Index count) {
  std::vector<friction::Contact> held;
  for (const std::vector<std::size_t>& place : friction::by_place(system.contacts())) {
    const auto holds = [&](std::size_t c) {
      const friction::LawKind kind = friction::kind(system.contacts()[c].law);
      return friction::sticks(kind) || kind == friction::LawKind::kBristle;
    };
    if (std::ranges::any_of(place, holds)) held.push_back(system.contacts()[place.front()]);
  }
  const Eigen::MatrixXd directions = independent(directions_of(held, system.size()));
  const Eigen::Index free = system.size() - directions.cols();
  if (held.empty() || free <= 0) return {};
  return fem::constrained_modes(system.structure(), directions, std::min(count, free));
}

ModeSets natural_modes(const scene::Scene& scene, const dynamics::HybridSystem& system, Eigen::Index count) {
  if (count < 0 || count > system.size()) {
    throw InvalidInput(fmt::format("count = {}: expected 1..{} (the degrees of freedom), or 0 for the lowest {}", count,
                                   system.size(), kLowest));
  }
  if (count == 0) count = std::min(system.size(), kLowest);
  const Eigen::MatrixXd w = directions_of(system.contacts(), system.size());
  ModeSets sets{.slipping = fem::natural_modes(system.structure(), count),
                .sticking = sticking_modes(system, count),
                .compliant = {},
                .theory = {}};
  Eigen::VectorXd stiffness(w.cols());
  std::ranges::transform(system.contacts(), stiffness.begin(),
                         [](const friction::Contact& contact) { return friction::engaged_stiffness(contact.law); });
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
      writer.write(group + "/shapes", modes.shapes, {"kg^-1/2", "mass-normalised shapes, dof x mode"});
    };
    add("modes/slipping", sets->slipping, "natural modes with every contact slipping");
    if (sets->sticking.omega.size() > 0)
      add("modes/sticking", sets->sticking, "natural modes with every contact stuck that can be");
    if (sets->compliant.omega.size() > 0)
      add("modes/compliant", sets->compliant, "natural modes with every contact held by its spring or stop");
  };
  return {.kind = results::FileKind::kModes, .unit_system = scene.units, .write = write};
}

}  // namespace slipmode::studies
