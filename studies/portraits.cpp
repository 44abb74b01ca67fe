#include <slipmode/studies/portraits.hpp>

#include <slipmode/core/errors.hpp>
#include <slipmode/results/sweep_store.hpp>
#include <slipmode/rom/reduce.hpp>

#include <fmt/format.h>
#include <algorithm>

namespace slipmode::studies {
namespace {

using diagnostics::Model;
using results::Portrait;
using results::PortraitSet;

/// Contact 0 of a run from `start`; a run that fails gives an empty portrait rather than no figure at all.
Portrait run_portrait(const dynamics::HybridSystem& system, const dynamics::State& start, double horizon,
                      std::string title, std::string role) {
  constexpr double kHorizons = 5.0, kSamples = 1000.0;
  Portrait portrait{.title = std::move(title), .role = std::move(role), .displacement = {}, .velocity = {}};
  try {
    const auto run = dynamics::simulate(system, dynamics::handed_on(system, start),
                                        {.duration = kHorizons * horizon,
                                         .sample = horizon / kSamples,
                                         .keep_events = false,
                                         .output = dynamics::SimulateOptions::Output::kContacts});
    portrait.displacement = run.contact_q.row(0);
    portrait.velocity = run.contact_v.row(0);
  } catch (const NumericalFailure&) {
    portrait.title += " (failed)";
  }
  return portrait;
}

/// Contact 0 of the full structure along a lifted record, the orbit closed.
Portrait orbit_portrait(const dynamics::HybridSystem& full, const Model& model, double speed,
                        const diagnostics::Orbit& orbit, std::string title, std::string role) {
  constexpr Eigen::Index kSamples = 1500;
  const diagnostics::Record record = diagnostics::sample_orbit(model, speed, orbit.states.front(), orbit.T, kSamples);
  const auto& contact = full.contacts().front();
  Portrait portrait{.title = std::move(title), .role = std::move(role), .displacement = {}, .velocity = {}};
  portrait.displacement.resize(kSamples + 1);
  portrait.velocity.resize(kSamples + 1);
  portrait.displacement.head(kSamples) = (record.q.transpose() * contact.direction).array() + contact.offset;
  portrait.velocity.head(kSamples) = record.v.transpose() * contact.direction;
  portrait.displacement[kSamples] = portrait.displacement[0];
  portrait.velocity[kSamples] = portrait.velocity[0];
  return portrait;
}

}  // namespace

results::PortraitSet level_portraits(const dynamics::HybridSystem& full, const pod::NamedBasis& candidate,
                                     const diagnostics::ValidationReport& report, double horizon) {
  constexpr std::size_t kMostPanels = 8;
  constexpr Eigen::Index kFewest = 3;  // one and two modes leave the frame (S4 section 3.4.2)
  const dynamics::HybridSystem at_speed = full.with_drive(friction::Belt::constant(report.speed));
  PortraitSet set{.columns = 4, .portraits = {}};
  set.portraits.push_back(run_portrait(at_speed, report.full.end, horizon,
                                       fmt::format("full, {}", results::motion_text(report.full.period)), "full"));
  std::vector<const diagnostics::ShareRow*> levels;
  for (const auto& row : report.candidates.front().shares) {
    const bool shown = row.modes >= std::min(kFewest, report.chosen) && row.modes < full.size();
    if (shown && row.attractor) levels.push_back(&row);
  }
  std::sort(levels.begin(), levels.end(), [](const auto* a, const auto* b) { return a->modes > b->modes; });
  if (levels.size() >= kMostPanels) levels.erase(levels.begin(), levels.end() - (kMostPanels - 1));
  for (const diagnostics::ShareRow* row : levels) {
    set.portraits.push_back(run_portrait(
        rom::reduce(at_speed, candidate.basis.truncated(row->modes)), row->attractor->end, horizon,
        fmt::format("{} {}s, {}", row->modes, candidate.name, results::motion_text(row->attractor->period)),
        candidate.name));
  }
  return set;
}

results::PortraitSet orbit_portraits(const dynamics::HybridSystem& full, const pod::NamedBasis& candidate,
                                     const diagnostics::ValidationReport& report) {
  const Model full_model = diagnostics::belt_model(full);
  const Model reduced_model = diagnostics::reduced_belt_model(full, candidate.basis.truncated(report.chosen));
  std::vector<Portrait> above, below;
  for (const auto& row : report.candidates.front().orbits) {
    if (row.modes != report.chosen || !row.comparison) continue;
    const auto& orbits = *row.comparison;
    above.push_back(orbit_portrait(full, full_model, row.speed, orbits.full,
                                   fmt::format("full, V = {:g}, period {}", row.speed, orbits.full.period), "full"));
    below.push_back(orbit_portrait(
        full, reduced_model, row.speed, orbits.reduced,
        fmt::format("{} {}s, period {}", report.chosen, candidate.name, orbits.reduced.period), candidate.name));
  }
  PortraitSet set{.columns = static_cast<int>(above.size()), .portraits = std::move(above)};
  set.portraits.insert(set.portraits.end(), below.begin(), below.end());
  return set;
}

}  // namespace slipmode::studies
