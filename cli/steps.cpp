#include "cli/steps.hpp"

#include <slipmode/results/records.hpp>
#include <slipmode/results/table.hpp>
#include <slipmode/results/units.hpp>
#include <slipmode/rom/reduce.hpp>
#include "cli/shaken_bases.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slipmode::cli {
diagnostics::Model scene_model(const scene::Scene& scene, const dynamics::HybridSystem& system) {
  if (scene.drive.is_constant()) return diagnostics::belt_model(system);
  if (scene.drive.shaker() != nullptr) {
    return {
        .system = [scene, system](double frequency) { return system.with_drive(scene::drive_at(scene, frequency)); }};
  }
  return {.system = [system](double) { return system; }};
}

void refuse_force(const scene::Scene& scene, const std::string& verb) {
  if (!scene.force) return;
  throw InvalidInput(fmt::format(
      "{}: drive.kind = \"force\": {} compares motions by their slips or by a shaker's cycles; valid: a belt "
      "or a shaker, or 'slipmode orbit find', 'orbit continue', 'orbit map' for this scene",
      scene.source.path, verb));
}

bool can_stick(const dynamics::HybridSystem& system) {
  return std::ranges::none_of(system.contacts(), [](const friction::Contact& contact) {
    return std::holds_alternative<friction::Clearance>(contact.law);
  });
}

namespace {

/// One run after the other, in order.
void append(diagnostics::EnsembleRun& all, diagnostics::EnsembleRun part) {
  const Eigen::Index before = all.ensemble.snapshots.cols();
  Eigen::MatrixXd joined(part.ensemble.snapshots.rows(), before + part.ensemble.snapshots.cols());
  if (before > 0) joined.leftCols(before) = all.ensemble.snapshots;
  joined.rightCols(part.ensemble.snapshots.cols()) = part.ensemble.snapshots;
  all.ensemble.snapshots = std::move(joined);
  for (const Eigen::Index begin : part.ensemble.run_begin) all.ensemble.run_begin.push_back(before + begin);
  for (auto& member : part.members) all.members.push_back(std::move(member));
}

diagnostics::EnsembleRun run_at(const scene::Scene& scene, const dynamics::HybridSystem& system,
                                const std::vector<double>& parameters, const scene::TimeSpec& time,
                                ParallelOptions parallel) {
  return diagnostics::run_ensemble(scene_model(scene, system), parameters, scene::ensemble_states(scene, system),
                                   {.duration = time.duration,
                                    .transient = time.transient,
                                    .sample = time.sample,
                                    .flow = scene.flow,
                                    .parallel = std::move(parallel)});
}

}  // namespace

diagnostics::EnsembleRun run_scene_ensemble(const Session& session, const scene::Scene& scene,
                                            const dynamics::HybridSystem& system) {
  ProgressLine line("ensemble", session.progress_mode());
  const bool shaken = scene.drive.shaker() != nullptr;
  std::vector<double> parameters = shaken ? scene.ensemble.frequencies : scene.ensemble.speeds;
  if (parameters.empty()) parameters.push_back(scene::drive_parameter(scene));
  if (!shaken) return run_at(scene, system, parameters, scene.time, session.parallel(line));
  diagnostics::EnsembleRun all;  // a time in cycles is another one at each frequency
  for (const double frequency : parameters) {
    append(all, run_at(scene, system, {frequency}, scene::time_at(scene, frequency), session.parallel(line)));
  }
  return all;
}

double worst_audit(const diagnostics::EnsembleRun& run) {
  double worst = 0.0;
  for (const auto& member : run.members) {
    if (member.failure.empty()) worst = std::max(worst, std::abs(member.audit.residual()));
  }
  return worst;
}

void store_ensemble(const std::filesystem::path& path, const scene::Scene& scene, const diagnostics::EnsembleRun& run) {
  const results::Units units = results::Units::of(scene.units);
  results::StoreWriter writer(path, scene.units);
  results::Provenance provenance = results::provenance_of(scene, "slipmode simulate");
  results::Table members{.description = "runs of the ensemble", .columns = {}};
  std::vector<double> parameter, start, columns, events, residual;
  std::vector<std::string> failure;
  for (const auto& member : run.members) {
    const bool worse = !provenance.audit || std::abs(member.audit.residual()) > std::abs(provenance.audit->residual());
    if (member.failure.empty() && worse) provenance.audit = member.audit;
    parameter.push_back(member.parameter);
    start.push_back(static_cast<double>(member.start));
    columns.push_back(static_cast<double>(member.columns));
    events.push_back(static_cast<double>(member.statistics.events));
    residual.push_back(member.failure.empty() ? member.audit.residual() : std::numeric_limits<double>::quiet_NaN());
    failure.push_back(member.failure);
  }
  const bool shaken = scene.drive.shaker() != nullptr;
  const results::Column driven = shaken ? results::Column{"frequency", {units.frequency, "shaker frequency"}, parameter}
                                 : scene.force
                                     ? results::Column{"omega", {units.angular, "frequency of the force"}, parameter}
                                     : results::Column{"speed", {units.velocity, "belt speed"}, parameter};
  members.columns = {driven,
                     {"start", {"", "number of the initial state"}, start},
                     {"snapshots", {"", "snapshots it gave"}, columns},
                     {"events", {"", "events located"}, events},
                     {"audit_residual", {"1", "energy balance relative to the energy exchanged"}, residual},
                     {"failure", {"", "why it failed; empty: it did not"}, failure}};
  results::save(writer, provenance);
  results::save(writer, results::kEnsembleGroup, run.ensemble);
  results::save(writer, "members", members);
  if (scene.sensors) store_sensors(writer, scene, run.ensemble.snapshots);
  writer.commit();
}

pod::Ensemble load_snapshots(const results::StoreReader& store) {
  if (store.has(results::kEnsembleGroup)) return results::load_ensemble(store);
  if (store.has(results::kTrajectoryGroup)) {
    return {.snapshots = results::load_trajectory(store).q, .run_begin = {0}};
  }
  store.fail("ensemble", "the file holds neither an ensemble nor a trajectory; make one with 'slipmode simulate'");
}

Eigen::VectorXd cumulative(const Eigen::VectorXd& shares) {
  Eigen::VectorXd sum = shares;
  for (Eigen::Index i = 1; i < sum.size(); ++i) sum[i] += sum[i - 1];
  return sum;
}

Eigen::Index chosen_modes(const pod::ModeChoice& choice, const Eigen::VectorXd& shares, Eigen::Index available,
                          const std::string& source) {
  if (choice.modes > available) {
    throw InvalidInput(fmt::format("modes = {}: {} holds only {}; valid: 1 to {}, set by --modes or reduction.modes",
                                   choice.modes, source, available, available));
  }
  if (choice.modes > 0) return choice.modes;
  const Eigen::VectorXd sum = cumulative(shares);
  for (Eigen::Index i = 0; i < std::min(available, sum.size()); ++i) {
    if (sum[i] >= choice.energy) return i + 1;
  }
  return available;
}

BasisSource load_basis_source(const std::string& source, const fem::Structure& structure) {
  const Eigen::Index n = structure.size();
  if (source == "lnm") return {.basis = rom::lnm_basis(structure, n), .shares = {}};
  const results::StoreReader store(source);
  if (store.has(results::kPodGroup)) {
    const pod::PodResult result = results::load_pod(store, results::kPodGroup, n);
    return {.basis = result.basis, .shares = result.shares};
  }
  const std::string reduced_basis = std::string(results::kReducedGroup) + "/basis";
  const std::string group = store.has(reduced_basis) ? reduced_basis : std::string(results::kBasisGroup);
  if (!store.has(group)) {
    store.fail(group, "the file holds no basis; make one with 'slipmode pod', or say 'lnm' for linear natural modes");
  }
  const pod::Basis basis = results::load_basis(store, group, n);
  return {.basis = basis, .shares = basis.energy};
}

}  // namespace slipmode::cli
